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

void findVelocities(Substep& now) {
  Particles& p = now.particles;
  setDifference(p.x, p.start, 1.0 / now.h, p.v);
}

}  // namespace cloth_sim
