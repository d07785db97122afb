#include <array>
#include <cmath>

#include "explicit_solver.h"
#include "linalg/vector_operations.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Where a stage is in the substep, and what it weighs in the sum.
struct Stage {
  double at = 0.0;
  double weight = 0.0;
};

constexpr std::array<Stage, 4> kStages{
    {{0.0, 1.0 / 6.0}, {0.5, 1.0 / 3.0}, {0.5, 1.0 / 3.0}, {1.0, 1.0 / 6.0}}};

/// The classical Runge-Kutta method: four evaluations of the forces in a substep.
///
/// Fourth order on smooth motion; first order where contact or tearing makes it not smooth. Stable
/// for h below 2 sqrt(2) / omega_max, and damps what is fast a little (Hairer, Norsett & Wanner
/// 1993, ch. II.1 and IV.2).
class RungeKutta final : public ExplicitSolver {
 public:
  RungeKutta(const Model& model, int substeps) : ExplicitSolver(model, substeps) {}

 private:
  void substep(const Substep& now) override {
    markStart();
    velocity_ = particles_.v;
    const std::size_t n = particles_.mass.size();
    setZero(n, displacement_);
    setZero(n, change_);
    for (const Stage& stage : kStages) evaluate(stage, now);
    setSum(particles_.start, now.h, displacement_, particles_.x);
    setSum(velocity_, now.h, change_, particles_.v);
    placeKinematic(now.fraction);
    enforceContacts(now);
    enforceContactVelocities(now);
  }

  void evaluate(const Stage& stage, const Substep& now) {
    if (stage.at > 0.0) {
      const double step = stage.at * now.h;
      setSum(particles_.start, step, particles_.v, particles_.x);
      setSum(velocity_, step, acceleration_, particles_.v);
    }
    placeKinematic(now.before + stage.at * (now.fraction - now.before));
    evaluateForces(now);
    evaluateAccelerations(now.controls, acceleration_);
    addScaled(stage.weight, particles_.v, displacement_);
    addScaled(stage.weight, acceleration_, change_);
    addForcesToReactions(stage.weight * now.h);
  }

  VectorArray velocity_;      ///< at the start of the substep [m/s]
  VectorArray acceleration_;  ///< of the last stage [m/s^2]
  VectorArray displacement_;  ///< weighted sum of the stages' velocities [m/s]
  VectorArray change_;        ///< weighted sum of the stages' accelerations [m/s^2]
};

}  // namespace

SolverInfo rungeKuttaInfo() {
  SolverInfo info;
  info.name = "rk4";
  info.title = "Classical Runge-Kutta";
  info.reference = "Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, ch. II.1";
  info.limitations = "diverges for substeps longer than 2.83 / omega_max; four force evaluations";
  info.order = 4;
  info.stabilityLimit = 2.0 * std::sqrt(2.0);
  info.parameters = {substepsParameter(48)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<RungeKutta>(model, static_cast<int>(p.at("substeps")));
  };
  return info;
}

}  // namespace cloth_sim
