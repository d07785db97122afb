#include "newton_stage.h"

#include <algorithm>
#include <cmath>

#include "methods.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

constexpr double kLinearTolerance = 0.05;  ///< of the residual, per Newton step
constexpr int kLinearIterations = 400;
constexpr int kHalvings = 8;
constexpr double kSlack = 1e-12;  ///< by which rounding may raise the potential, relative

CLOTH_SIM_VECTOR_CLONES
void scaleAxis(std::size_t n, const double* diagonal, const double* p, double* q) {
  for (std::size_t k = 0; k < n; ++k) q[k] = diagonal[k] * p[k];
}

CLOTH_SIM_VECTOR_CLONES
void maskAxis(std::size_t n, const double* diagonal, double* q) {
  for (std::size_t k = 0; k < n; ++k) q[k] = diagonal[k] > 0.0 ? q[k] : 0.0;
}

/// Moves particles to where their velocities lead in a stage.
void place(Substep& now, const ImplicitStage& stage) {
  setSum(stage.fromX, stage.tau, now.particles.v, now.particles.x);
  now.kinematic.place(stage.fraction, now.particles);
}

}  // namespace

NewtonStage::NewtonStage(const SolverParameters& parameters)
    : iterations_(static_cast<int>(parameters.at("iterations"))),
      tolerance_(parameters.at("tolerance")) {}

void NewtonStage::begin(const Substep& now) {
  if (!now.isNewModel || now.model.bending.empty()) return;
  bending_.build(now.model, now.particles);
  friction_.build(now.model, now.particles);
  if (now.model.bending.hasFriction()) slipBound_.buildSlip(now.model, now.particles);
}

void NewtonStage::findLoads(Substep& now) {
  setZero(now.particles.mass.size(), now.force);
  if (now.controls.hasLoads()) now.addLoads();
  loads_ = now.force;
}

void NewtonStage::addInternalForces(Substep& now) const {
  const Particles& p = now.particles;
  now.springs.addForces(p.x, p.v, now.force);
  bending_.addForces(p.x, p.v, now.force);
  friction_.addForces(p, now.force);
}

void NewtonStage::evaluateForces(Substep& now) {
  findLoads(now);
  addInternalForces(now);
}

void NewtonStage::solve(Substep& now, const ImplicitStage& stage) {
  findLoads(now);
  diagonal_ = now.particles.mass;
  for (double& m : diagonal_) m *= 1.0 + stage.tau * now.controls.drag;
  place(now, stage);
  for (int k = 0;; ++k) {
    now.residual = findResidual(now, stage);
    if (k > 0) ++now.iterations;
    if (now.residual <= tolerance_) return balance(now, stage);
    if (k == iterations_ || !std::isfinite(now.residual) || now.isStopped()) return;
    linearise(now, stage.tau);
    solveLinear(now);
    search(now, stage);
  }
}

void NewtonStage::advanceBackward(Substep& now, const VectorArray& velocity) {
  solve(now, {now.h, now.fraction, now.particles.start, velocity});
  friction_.slip(now.particles);
  now.kinematic.addForces(now.h, now.force);
  now.enforceContacts();
}

/// residual = m (fromV - v) + tau (f + m (g - drag v)) [N s].
/// \return its root mean square as an acceleration [m/s^2].
double NewtonStage::findResidual(Substep& now, const ImplicitStage& stage) {
  now.force = loads_;
  addInternalForces(now);
  const Particles& p = now.particles;
  const std::size_t n = p.mass.size();
  residual_.resize(n);
  double square = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double mass = p.mass[k];
    const Vec3 v = p.v.at(k);
    const Vec3 force = now.force.at(k) + mass * (now.controls.gravity - now.controls.drag * v);
    const Vec3 r =
        mass > 0.0 ? Vec3(mass * (stage.fromV.at(k) - v) + stage.tau * force) : Vec3::Zero();
    residual_.set(k, r);
    square += r.squaredNorm() * p.inverseMass[k];
    total += mass;
  }
  return total > 0.0 ? std::sqrt(square / total) / stage.tau : 0.0;
}

/// The incremental potential [J]. Its gradient by the velocities is the negative residual, but for
/// the way in which dashpots turn.
double NewtonStage::potential(const Substep& now, const ImplicitStage& stage) const {
  const Particles& p = now.particles;
  const double drag = 1.0 + stage.tau * now.controls.drag;
  double sum = 0.0;
  for (std::size_t k = 0; k < p.mass.size(); ++k) {
    const double mass = p.mass[k];
    if (mass <= 0.0) continue;
    const Vec3 v = p.v.at(k);
    const Vec3 aim =
        mass * (stage.fromV.at(k) + stage.tau * now.controls.gravity) + stage.tau * loads_.at(k);
    sum += 0.5 * drag * mass * v.squaredNorm() - aim.dot(v);
  }
  return sum + now.springs.potential(p.x, p.v, stage.tau) +
         bending_.potential(p.x, p.v, stage.tau) + friction_.potential(p);
}

/// A = m (1 + tau drag) + tau^2 df/dx + tau df/dv, and the inverses of its diagonal blocks.
void NewtonStage::linearise(Substep& now, double tau) {
  now.springs.linearise(now.particles.x, tau * tau, tau);
  bendFactor_ = tau * tau + tau * bending_.retardation();
  slipFactor_ = tau * tau;
  SymmetricBlocks& blocks = preconditioner_.reset(diagonal_);
  now.springs.addDiagonalBlocks(blocks);
  for (std::size_t k = 0; k < diagonal_.size(); ++k) {
    const double bend = bendFactor_ * bending_.diagonal(k) + slipFactor_ * slipBound_.diagonal(k);
    blocks.add(k, Vec3::Constant(bend), Vec3::Zero());
  }
  preconditioner_.factorise([&](std::size_t slot) { return diagonal_[slot] <= 0.0; });
}

/// q = A p. Rows of particles with prescribed motion count as absent.
void NewtonStage::multiply(const SpringConstraints& springs, const VectorArray& p,
                           VectorArray& q) const {
  const std::size_t n = diagonal_.size();
  q.resize(n);
  forAxes(
      [&](const auto& from, auto& to) { scaleAxis(n, diagonal_.data(), from.data(), to.data()); },
      p, q);
  springs.multiply(p, q);
  bending_.addProduct(bendFactor_, p, q);
  slipBound_.addProduct(slipFactor_, p, q);
  forAxes([&](auto& axis) { maskAxis(n, diagonal_.data(), axis.data()); }, q);
}

/// A change = residual.
void NewtonStage::solveLinear(const Substep& now) {
  solver_.solve([&](const VectorArray& p, VectorArray& q) { multiply(now.springs, p, q); },
                [&](const VectorArray& r, VectorArray& z) { preconditioner_.apply(r, z); },
                [&] { return now.isStopped(); }, residual_, {kLinearTolerance, kLinearIterations},
                change_);
}

/// Takes the whole change of velocities, or the first half, quarter ... that lowers the potential.
void NewtonStage::search(Substep& now, const ImplicitStage& stage) {
  const double start = potential(now, stage);
  const double allowance = kSlack * std::abs(start);
  before_ = now.particles.v;
  double step = 1.0;
  for (int k = 0; k <= kHalvings; ++k, step *= 0.5) {
    setSum(before_, step, change_, now.particles.v);
    place(now, stage);
    if (potential(now, stage) <= start + allowance) return;
  }
}

/// Moves the particles by what is left of the residual: momentum is then kept to round-off.
void NewtonStage::balance(Substep& now, const ImplicitStage& stage) const {
  Particles& p = now.particles;
  for (std::size_t k = 0; k < p.mass.size(); ++k) {
    p.v.set(k, p.v.at(k) + residual_.at(k) * p.inverseMass[k]);
  }
  place(now, stage);
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
