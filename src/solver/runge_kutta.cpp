#include <array>
#include <cmath>

#include "explicit_forces.h"
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
class RungeKutta {
 public:
  void operator()(Substep& now, const ExplicitForces& forces) {
    now.markStart();
    Particles& p = now.particles;
    velocity_ = p.v;
    setZero(p.mass.size(), displacement_);
    setZero(p.mass.size(), change_);
    for (const Stage& stage : kStages) evaluate(stage, now, forces);
    setSum(p.start, now.h, displacement_, p.x);
    setSum(velocity_, now.h, change_, p.v);
    now.placeKinematic();
    now.enforceContacts();
    now.enforceContactVelocities();
  }

 private:
  void evaluate(const Stage& stage, Substep& now, const ExplicitForces& forces) {
    Particles& p = now.particles;
    if (stage.at > 0.0) {
      const double step = stage.at * now.h;
      setSum(p.start, step, p.v, p.x);
      setSum(velocity_, step, acceleration_, p.v);
    }
    now.kinematic.place(now.before + stage.at * (now.fraction - now.before), p);
    forces.evaluate(now);
    forces.findAccelerations(now, acceleration_);
    addScaled(stage.weight, p.v, displacement_);
    addScaled(stage.weight, acceleration_, change_);
    now.kinematic.addForces(stage.weight * now.h, now.force);
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
    return makeExplicitSolver(model, p, RungeKutta());
  };
  return info;
}

}  // namespace cloth_sim
