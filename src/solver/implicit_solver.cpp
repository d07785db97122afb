#include "implicit_solver.h"

#include <algorithm>
#include <cmath>

#include "constraints/spring_forces.h"
#include "methods.h"

namespace cloth_sim {
namespace {

constexpr double kLinearTolerance = 0.05;  ///< of the residual, per Newton step
constexpr int kLinearIterations = 400;
constexpr int kHalvings = 8;
/// Of the potential: what rounding may add to it.
constexpr double kSlack = 1e-12;

}  // namespace

ImplicitSolver::ImplicitSolver(const Model& model, const SolverParameters& parameters)
    : SubstepSolver(model, static_cast<int>(parameters.at("substeps"))),
      iterations_(static_cast<int>(parameters.at("iterations"))),
      tolerance_(parameters.at("tolerance")) {}

void ImplicitSolver::findWind(const Substep& now) {
  const std::size_t n = particles_.mass.size();
  setZero(n, force_);
  if (now.controls.hasLoads()) addLoads(now.model, now.controls);
  wind_ = force_;
}

void ImplicitSolver::addInternalForces() {
  addSpringForces(schedule_, particles_.x, particles_.v, force_);
  bending_.addForces(particles_.x, particles_.v, force_);
}

void ImplicitSolver::evaluateForces(const Substep& now) {
  findWind(now);
  addInternalForces();
}

void ImplicitSolver::place(double tau, double fraction, const VectorArray& fromX) {
  setSum(fromX, tau, particles_.v, particles_.x);
  placeKinematic(fraction);
}

/// residual = m (v* - v) + tau (f + m (g - drag v)); its root mean square as an acceleration.
double ImplicitSolver::findResidual(const Substep& now, double tau, const VectorArray& fromV) {
  force_ = wind_;
  addInternalForces();
  const std::size_t n = particles_.mass.size();
  residual_.resize(n);
  double square = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double mass = particles_.mass[k];
    const Vec3 v = particles_.v.at(k);
    const Vec3 pull = force_.at(k) + mass * (now.controls.gravity - now.controls.drag * v);
    const Vec3 r = mass > 0.0 ? Vec3(mass * (fromV.at(k) - v) + tau * pull) : Vec3::Zero();
    residual_.set(k, r);
    square += r.squaredNorm() * particles_.inverseMass[k];
    total += mass;
  }
  return total > 0.0 ? std::sqrt(square / total) / tau : 0.0;
}

/// Its gradient by the velocities is the residual, but for the way in which dashpots turn [J].
double ImplicitSolver::potential(const Substep& now, double tau, const VectorArray& fromV) const {
  double sum = 0.0;
  const double drag = 1.0 + tau * now.controls.drag;
  for (std::size_t k = 0; k < particles_.mass.size(); ++k) {
    const double mass = particles_.mass[k];
    if (mass <= 0.0) continue;
    const Vec3 v = particles_.v.at(k);
    const Vec3 aim = mass * (fromV.at(k) + tau * now.controls.gravity) + tau * wind_.at(k);
    sum += 0.5 * drag * mass * v.squaredNorm() - aim.dot(v);
  }
  return sum + springPotential(schedule_, particles_.x, particles_.v, tau) +
         bending_.potential(particles_.x, particles_.v, tau);
}

void ImplicitSolver::search(const Substep& now, double tau, double fraction,
                            const VectorArray& fromX, const VectorArray& fromV) {
  const double start = potential(now, tau, fromV);
  const double allowance = kSlack * std::abs(start);
  before_ = particles_.v;
  double step = 1.0;
  for (int k = 0; k <= kHalvings; ++k, step *= 0.5) {
    setSum(before_, step, change_, particles_.v);
    place(tau, fraction, fromX);
    if (potential(now, tau, fromV) <= start + allowance) return;
  }
}

/// Moves the particles by what is left of the residual: momentum is then kept to round-off.
void ImplicitSolver::balance(double tau, double fraction, const VectorArray& fromX) {
  for (std::size_t k = 0; k < particles_.mass.size(); ++k) {
    const Vec3 change = residual_.at(k) * particles_.inverseMass[k];
    particles_.v.set(k, particles_.v.at(k) + change);
  }
  place(tau, fraction, fromX);
}

void ImplicitSolver::solveStage(const Substep& now, double tau, double fraction,
                                const VectorArray& fromX, const VectorArray& fromV) {
  findWind(now);
  diagonal_ = particles_.mass;
  for (double& m : diagonal_) m *= 1.0 + tau * now.controls.drag;
  place(tau, fraction, fromX);
  for (int k = 0;; ++k) {
    const double residual = findResidual(now, tau, fromV);
    noteIterations(k == 0 ? 0 : 1, residual);
    if (residual <= tolerance_) return balance(tau, fraction, fromX);
    if (k == iterations_ || !std::isfinite(residual)) return;
    matrix_.linearise({schedule_, bending_}, particles_.x, tau * tau, tau, diagonal_);
    matrix_.solve({schedule_, bending_}, residual_, kLinearTolerance, kLinearIterations, change_);
    search(now, tau, fraction, fromX, fromV);
  }
}

std::vector<SolverParameter> implicitParameters() {
  SolverParameter iterations;
  iterations.name = "iterations";
  iterations.defaultValue = 8;
  iterations.minimum = 1;
  iterations.maximum = 1000;
  iterations.integer = true;
  iterations.description = "of Newton's method in a stage, at most";
  SolverParameter tolerance;
  tolerance.name = "tolerance";
  tolerance.defaultValue = 1e-3;
  tolerance.minimum = 0.0;
  tolerance.maximum = 10.0;
  tolerance.unit = "m/s^2";
  tolerance.description = "residual, as a mean acceleration, at which a stage counts as solved";
  return {substepsParameter(4), iterations, tolerance};
}

}  // namespace cloth_sim
