#include <cmath>

#include "linalg/vector_operations.h"
#include "methods.h"
#include "newton_stage.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

const double kGamma = 2.0 - std::sqrt(2.0);      ///< where the first stage ends
const double kTau = 1.0 - 0.5 * std::sqrt(2.0);  ///< of both stages
const double kBack = 1.0 / (kGamma * (2.0 - kGamma));
const double kWeight = 0.25 * std::sqrt(2.0);  ///< of the forces at the start and in the middle

/// TR-BDF2: the trapezoidal rule over the first part of the substep, then the second backward
/// difference formula over all of it.
///
/// Second order, one step, stable at any step, and damps only what is fast (Bank et al. 1985;
/// Hosea & Shampine 1996, with gamma = 2 - sqrt(2), so that both stages have the same matrix).
///
/// A substep in which an obstacle is in the way is one of backward Euler. The trapezoidal rule
/// begins with the forces at the start, and those of springs that an obstacle has just strained are
/// no smooth continuation of anything: cloth on an obstacle pumped itself up (26 g of cotton on a
/// sphere had 1,250 J with a friction of 10).
class TrBdf2 final : public SubstepMethod {
 public:
  explicit TrBdf2(const SolverParameters& parameters) : newton_(parameters) {}

  void begin(Substep& now) override { newton_.begin(now); }
  void advance(Substep& now) override {
    now.markStart();
    velocity_ = now.particles.v;
    if (now.isFlightBlocked()) return newton_.advanceBackward(now, velocity_);
    if (!now.contacts.empty()) impulses_ = now.kinematic.impulses();
    advanceFreely(now);
    if (now.isBlocked(now.particles.view())) advanceAgain(now);
  }

 private:
  void advanceFreely(Substep& now) {
    const Particles& p = now.particles;
    const double tau = kTau * now.h;
    newton_.evaluateForces(now);
    now.kinematic.addForces(kWeight * now.h, now.force);
    setTrapezoid(now, tau);
    const double middle = now.before + kGamma * (now.fraction - now.before);
    newton_.solve(now, {tau, middle, fromX_, fromV_});
    now.kinematic.addForces(kWeight * now.h, now.force);
    combine(p.x, p.start, fromX_);
    combine(p.v, velocity_, fromV_);
    newton_.solve(now, {tau, now.fraction, fromX_, fromV_});
    now.kinematic.addForces(kTau * now.h, now.force);
  }

  /// Does the substep again from its start, with an obstacle in the way.
  void advanceAgain(Substep& now) {
    copy(now.particles.start, now.particles.x);
    copy(velocity_, now.particles.v);
    now.kinematic.setImpulses(impulses_);
    newton_.advanceBackward(now, velocity_);
  }

  /// Finds the explicit half of the trapezoidal rule.
  void setTrapezoid(const Substep& now, double tau) {
    const Particles& p = now.particles;
    setSum(p.start, tau, velocity_, fromX_);
    fromV_.resize(velocity_.x.size());
    for (std::size_t k = 0; k < velocity_.x.size(); ++k) {
      const Vec3 v = velocity_.at(k);
      const Vec3 a =
          now.force.at(k) * p.inverseMass[k] + now.controls.gravity - now.controls.drag * v;
      fromV_.set(k, v + tau * a);
    }
  }

  /// out = (middle - (1 - gamma)^2 start) / (gamma (2 - gamma)).
  static void combine(const VectorArray& middle, const VectorArray& start, VectorArray& out) {
    const double past = (1.0 - kGamma) * (1.0 - kGamma);
    out.resize(middle.x.size());
    for (std::size_t k = 0; k < middle.x.size(); ++k) {
      out.set(k, kBack * (middle.at(k) - past * start.at(k)));
    }
  }

  NewtonStage newton_;
  VectorArray velocity_;        ///< at the start of the substep [m/s]
  VectorArray fromX_, fromV_;   ///< what a stage starts from [m], [m/s]
  std::vector<Vec3> impulses_;  ///< on kinematic particles, at the start of the substep [N s]
};

}  // namespace

SolverInfo trBdf2Info() {
  SolverInfo info;
  info.name = "tr_bdf2";
  info.title = "TR-BDF2";
  info.reference = "Hosea & Shampine, Applied Numerical Mathematics 20 (1996)";
  info.limitations =
      "two solves in a substep; a substep of backward Euler, of first order, where any cloth "
      "touches";
  info.order = 2;
  info.noLayers = "its stages move cloth after contact";
  info.parameters = implicitParameters();
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<SubstepSolver>(model, substepsOf(p), std::make_unique<TrBdf2>(p));
  };
  return info;
}

}  // namespace cloth_sim
