#include "position_based.h"

#include <utility>

#include "linalg/vector_operations.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Replaces positions at the start of the substep before by predicted ones, along one axis:
/// start = x + (x - start) + fall. Kinematic particles do not fall.
CLOTH_SIM_VECTOR_CLONES
void predictAxis(std::size_t count, double fall, const double* w, const double* x, double* start) {
  for (std::size_t k = 0; k < count; ++k)
    start[k] = x[k] + ((x[k] - start[k]) + (w[k] > 0.0 ? fall : 0.0));
}

/// Predicts as above, with displacements that drag reduces by the factor `decay`.
CLOTH_SIM_VECTOR_CLONES
void predictAxisWithDrag(std::size_t count, double decay, double fall, const double* w,
                         const double* x, double* start) {
  for (std::size_t k = 0; k < count; ++k)
    start[k] = x[k] + (decay * (x[k] - start[k]) + (w[k] > 0.0 ? fall : 0.0));
}

/// Predicts positions in the slots [first, first + count), in the place of `start`.
void predictPart(Substep& now, double decay, std::size_t first, std::size_t count) {
  const Vec3 fall = now.h * now.h * now.controls.gravity;
  const double* const w = now.particles.inverseMass.data() + first;
  int axis = 0;
  forAxes(
      [&](const auto& x, auto& start) {
        const double* const from = x.data() + first;
        double* const to = start.data() + first;
        if (decay == 1.0) {
          predictAxis(count, fall[axis++], w, from, to);
        } else {
          predictAxisWithDrag(count, decay, fall[axis++], w, from, to);
        }
      },
      now.particles.x, now.particles.start);
}

/// The part of the limit of stability up to which all impulses are given at once. An impulse
/// a = n h^2 k / m of a mode with the stiffness k and the mass m, in every n-th substep and at the
/// predicted position, changes (x, n h v) by a matrix with the determinant 1 - a and the trace
/// 2 - a (n + 1), whose eigenvalues are below one for a < 4 / (n + 2).
constexpr double kStablePart = 0.8;

/// Largest stiffness over inertia of an element, times the square of the time between its impulses,
/// at which that may be more than a substep. The fastest mode of a grid has eleven times the
/// stiffness of an element, so its phase moves by 1.6 radians in that time; impulses are stable
/// below 2.
constexpr double kSoft = 0.25;

void applyLoads(Substep& now, const ScalarArray& inverseMass) {
  Particles& p = now.particles;
  for (std::size_t k = 0; k < inverseMass.size(); ++k) {
    const double scale = now.h * now.h * inverseMass[k];
    p.x.set(k, p.x.at(k) + scale * now.force.at(k));
  }
  now.kinematic.addForces(now.h, now.force);
}

}  // namespace

void beginPrediction(Substep& now) {
  setSum(now.particles.x, -now.h, now.particles.v, now.particles.start);
}

void predictPositions(Substep& now, double decay, const ScalarArray& inverseMass) {
  const std::size_t n = now.particles.mass.size();
  const bool hasLoads = now.controls.hasLoads();
  if (hasLoads) {
    setZero(n, now.force);
    now.addLoads();
  }
  forParts(n, [&](std::size_t first, std::size_t count) { predictPart(now, decay, first, count); });
  std::swap(now.particles.x, now.particles.start);
  if (hasLoads) applyLoads(now, inverseMass);
}

void PlateProjection::build(const Substep& now) {
  if (now.model.bending.empty()) return;
  matrix_.build(now.model, now.particles);
  friction_.build(now.model, now.particles);
  hasElements_ = false;
}

void PlateProjection::setStep(Substep& now, int longest) {
  if (empty()) return;
  if (now.isNewLayout) stiffest_ = matrix_.gershgorinBound(now.particles.inverseMass);
  step_ = {now.h, matrix_.retardation(), 1};
  isAtOnce_ = friction_.empty() && isStable(1);
  if (!isAtOnce_) return setElements(now, longest);
  if (isStable(longest)) step_.interval = longest;
  now.force.resize(now.particles.x.x.size());
}

bool PlateProjection::isStable(int interval) const {
  const double largest = interval * step_.h * (step_.h + step_.retardation) * stiffest_;
  return largest <= kStablePart * 4.0 / (interval + 2.0);
}

void PlateProjection::setElements(const Substep& now, int longest) {
  const ScalarArray& w = now.particles.inverseMass;
  if (!hasElements_) elements_.build(now.model.bending, now.particles);
  hasElements_ = true;
  const double period = longest * step_.h;
  const double stiffest = elements_.stiffest(w) + friction_.stiffest(w);
  if (period * period * stiffest <= kSoft) step_.interval = longest;
  elements_.setStep(step_, w);
  friction_.findHeld(w);
}

void PlateProjection::project(const ScalarArray& inverseInertia, Substep& now) const {
  if (isAtOnce_) {
    displace(inverseInertia, now);
  } else {
    projectElements(inverseInertia, now);
  }
}

void PlateProjection::displace(const ScalarArray& inverseInertia, Substep& now) const {
  Particles& p = now.particles;
  const VectorArray* at = &p.x;
  if (step_.retardation > 0.0) {
    setDifference(p.x, p.start, step_.retardation / step_.h, now.scratch);
    addScaled(1.0, p.x, now.scratch);
    at = &now.scratch;
  }
  for (const std::int32_t held : now.kinematic.slots()) {
    const auto slot = static_cast<std::size_t>(held);
    now.kinematic.addImpulseAt(slot, -step_.interval * step_.h * matrix_.rowProduct(slot, *at));
  }
  const double square = step_.interval * step_.h * step_.h;
  matrix_.displace(square, inverseInertia, *at, p.x, now.force);
  std::swap(p.x, now.force);
}

void PlateProjection::projectElements(const ScalarArray& inverseInertia, Substep& now) const {
  const auto onHeld = [&](std::size_t slot, const Vec3& impulse) {
    now.kinematic.addImpulseAt(slot, impulse / now.h);
  };
  elements_.project(now.particles, inverseInertia, onHeld);
  const double square = step_.interval * now.h * now.h;
  friction_.project(square, inverseInertia, now.particles, onHeld);
}

void findVelocities(Substep& now) {
  Particles& p = now.particles;
  setDifference(p.x, p.start, 1.0 / now.h, p.v);
}

}  // namespace cloth_sim
