#include <cmath>

#include "implicit_solver.h"
#include "methods.h"

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
class TrBdf2 final : public ImplicitSolver {
 public:
  TrBdf2(const Model& model, const SolverParameters& parameters)
      : ImplicitSolver(model, parameters) {}

 private:
  void substep(const Substep& now) override {
    markStart();
    velocity_ = particles_.v;
    const double tau = kTau * now.h;
    evaluateForces(now);
    addForcesToReactions(kWeight * now.h);
    setTrapezoid(now.controls, tau);
    solveStage(now, tau, now.before + kGamma * (now.fraction - now.before), fromX_, fromV_);
    addForcesToReactions(kWeight * now.h);
    combine(particles_.x, particles_.start, fromX_);
    combine(particles_.v, velocity_, fromV_);
    solveStage(now, tau, now.fraction, fromX_, fromV_);
    addForcesToReactions(kTau * now.h);
    enforceContacts(now);
    enforceContactVelocities(now);
  }

  /// Half of the trapezoidal rule that the start of the substep decides.
  void setTrapezoid(const Controls& controls, double tau) {
    setSum(particles_.start, tau, velocity_, fromX_);
    fromV_.resize(velocity_.x.size());
    for (std::size_t k = 0; k < velocity_.x.size(); ++k) {
      const Vec3 v = velocity_.at(k);
      const Vec3 a =
          force_.at(k) * particles_.inverseMass[k] + controls.gravity - controls.drag * v;
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

  VectorArray velocity_;       ///< at the start of the substep [m/s]
  VectorArray fromX_, fromV_;  ///< what a stage starts from [m], [m/s]
};

}  // namespace

SolverInfo trBdf2Info() {
  SolverInfo info;
  info.name = "tr_bdf2";
  info.title = "TR-BDF2";
  info.reference = "Hosea & Shampine, Applied Numerical Mathematics 20 (1996)";
  info.limitations = "two solves in a substep; contact follows them and is of first order";
  info.order = 2;
  info.parameters = implicitParameters();
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<TrBdf2>(model, p);
  };
  return info;
}

}  // namespace cloth_sim
