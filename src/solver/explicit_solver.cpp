#include "explicit_solver.h"

#include <algorithm>
#include <cmath>

#include "cloth_sim/cloth/stable_step.h"
#include "constraints/spring_forces.h"
#include "support/vector_clones.h"
#include "linalg/vector_operations.h"
#include "step_count.h"

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

}  // namespace

ExplicitSolver::ExplicitSolver(const Model& model, int substeps)
    : SubstepSolver(model, substeps), stableAtFirst_(stableStep(model)) {}

int ExplicitSolver::substepsFor(const Model& model, int configured) {
  const double now = stableStep(model);
  if (!(now < stableAtFirst_) || !std::isfinite(stableAtFirst_)) return configured;
  return stepCount(configured * stableAtFirst_ / now);
}

void ExplicitSolver::evaluateForces(const Substep& now) {
  setZero(particles_.mass.size(), force_);
  addSpringForces(schedule_, particles_.x, particles_.v, force_);
  bending_.addForces(particles_.x, particles_.v, force_);
  if (now.controls.hasLoads()) addLoads(now.model, now.controls);
}

void ExplicitSolver::kick(const Substep& now) {
  const auto n = static_cast<std::size_t>(particles_.slots);
  const Vec3& g = now.controls.gravity;
  const double* w = particles_.inverseMass.data();
  kickAxis(n, now.h, g.x(), force_.x.data(), w, particles_.v.x.data());
  kickAxis(n, now.h, g.y(), force_.y.data(), w, particles_.v.y.data());
  kickAxis(n, now.h, g.z(), force_.z.data(), w, particles_.v.z.data());
  addForcesToReactions(now.h);
}

void ExplicitSolver::evaluateAccelerations(const Controls& controls, VectorArray& out) const {
  const auto n = static_cast<std::size_t>(particles_.slots);
  out.resize(n);
  const auto axis = [&](double g, const ScalarArray& f, const ScalarArray& v, ScalarArray& a) {
    const double* const w = particles_.inverseMass.data();
    if (controls.drag != 0.0) {
      draggedAccelerationAxis(n, g, controls.drag, f.data(), v.data(), w, a.data());
    } else {
      accelerationAxis(n, g, f.data(), w, a.data());
    }
  };
  axis(controls.gravity.x(), force_.x, particles_.v.x, out.x);
  axis(controls.gravity.y(), force_.y, particles_.v.y, out.y);
  axis(controls.gravity.z(), force_.z, particles_.v.z, out.z);
}

void ExplicitSolver::drift(double h) { addScaled(h, particles_.v, particles_.x); }

void ExplicitSolver::damp(const Controls& controls, double h) {
  if (controls.drag == 0.0) return;
  const double keep = std::exp(-controls.drag * h);
  for (std::size_t k = 0; k < particles_.inverseMass.size(); ++k) {
    if (particles_.inverseMass[k] > 0.0) particles_.v.set(k, keep * particles_.v.at(k));
  }
}

}  // namespace cloth_sim
