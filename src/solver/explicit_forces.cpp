#include "explicit_forces.h"

#include <algorithm>
#include <cmath>

#include "cloth_sim/cloth/stable_step.h"
#include "linalg/vector_operations.h"
#include "methods.h"
#include "step_count.h"
#include "substep_solver.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// v += (h f / m + h g [m > 0]) along one axis.
CLOTH_SIM_VECTOR_CLONES
void kickAxis(std::size_t count, double h, double g, const double* force, const double* inverseMass,
              double* v) {
  for (std::size_t k = 0; k < count; ++k) {
    const double fall = inverseMass[k] > 0.0 ? h * g : 0.0;
    v[k] += h * force[k] * inverseMass[k] + fall;
  }
}

/// a = f / m + g [m > 0] along one axis.
CLOTH_SIM_VECTOR_CLONES
void accelerationAxis(std::size_t count, double g, const double* force, const double* inverseMass,
                      double* a) {
  for (std::size_t k = 0; k < count; ++k) {
    a[k] = force[k] * inverseMass[k] + (inverseMass[k] > 0.0 ? g : 0.0);
  }
}

/// a = f / m + (g - drag v) [m > 0] along one axis.
CLOTH_SIM_VECTOR_CLONES
void draggedAccelerationAxis(std::size_t count, double g, double drag, const double* force,
                             const double* v, const double* inverseMass, double* a) {
  for (std::size_t k = 0; k < count; ++k) {
    const double fall = inverseMass[k] > 0.0 ? g - drag * v[k] : 0.0;
    a[k] = force[k] * inverseMass[k] + fall;
  }
}

/// Holds the forces for a scheme.
class ExplicitMethod final : public SubstepMethod {
 public:
  ExplicitMethod(const Model& model, ExplicitScheme scheme)
      : forces_(model), scheme_(std::move(scheme)) {}

  void begin(Substep& now) override { forces_.begin(now); }
  void advance(Substep& now) override { scheme_(now, forces_); }
  int substepsFor(const Model& model, int configured) override {
    return forces_.substepsFor(model, configured);
  }

 private:
  ExplicitForces forces_;
  ExplicitScheme scheme_;
};

}  // namespace

ExplicitForces::ExplicitForces(const Model& model) : stableAtFirst_(stableStep(model)) {}

void ExplicitForces::begin(const Substep& now) {
  if (now.isNewModel && !now.model.bending.empty()) bending_.build(now.model, now.particles);
}

int ExplicitForces::substepsFor(const Model& model, int configured) const {
  const double stable = stableStep(model);
  if (!(stable < stableAtFirst_) || !std::isfinite(stableAtFirst_)) return configured;
  return stepCount(configured * stableAtFirst_ / stable);
}

void ExplicitForces::evaluate(Substep& now) const {
  const Particles& p = now.particles;
  setZero(p.mass.size(), now.force);
  now.springs.addForces(p.x, p.v, now.force);
  bending_.addForces(p.x, p.v, now.force);
  if (now.controls.hasLoads()) now.addLoads();
}

void ExplicitForces::findAccelerations(const Substep& now, VectorArray& out) const {
  const auto n = static_cast<std::size_t>(now.particles.slots);
  const double drag = now.controls.drag;
  const double* const w = now.particles.inverseMass.data();
  out.resize(n);
  int axis = 0;
  forAxes(
      [&](const auto& f, const auto& v, auto& a) {
        const double g = now.controls.gravity[axis++];
        if (drag != 0.0) {
          draggedAccelerationAxis(n, g, drag, f.data(), v.data(), w, a.data());
        } else {
          accelerationAxis(n, g, f.data(), w, a.data());
        }
      },
      now.force, now.particles.v, out);
}

void ExplicitForces::kick(Substep& now) {
  const auto n = static_cast<std::size_t>(now.particles.slots);
  const double* const w = now.particles.inverseMass.data();
  int axis = 0;
  forAxes([&](const auto& f,
              auto& v) { kickAxis(n, now.h, now.controls.gravity[axis++], f.data(), w, v.data()); },
          now.force, now.particles.v);
  now.kinematic.addForces(now.h, now.force);
}

void ExplicitForces::drift(Substep& now, double duration) {
  addScaled(duration, now.particles.v, now.particles.x);
}

void ExplicitForces::damp(Substep& now, double duration) {
  if (now.controls.drag == 0.0) return;
  const double keep = std::exp(-now.controls.drag * duration);
  Particles& p = now.particles;
  for (std::size_t k = 0; k < p.inverseMass.size(); ++k) {
    if (p.inverseMass[k] > 0.0) p.v.set(k, keep * p.v.at(k));
  }
}

std::unique_ptr<Solver> makeExplicitSolver(const Model& model, const SolverParameters& parameters,
                                           ExplicitScheme scheme) {
  return std::make_unique<SubstepSolver>(
      model, substepsOf(parameters), std::make_unique<ExplicitMethod>(model, std::move(scheme)));
}

}  // namespace cloth_sim
