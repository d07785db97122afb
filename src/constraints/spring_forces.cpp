#include "spring_forces.h"

#include <cmath>

#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Force of a spring from a to b on its end a [N]; b gets the opposite.
struct SpringForce {
  double x, y, z;
};

[[gnu::always_inline]] inline SpringForce elasticForce(double dx, double dy, double dz, double rest,
                                                       double stiffness) {
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz + kTinySquare);
  const double f = stiffness * (length - rest) / length;
  return {f * dx, f * dy, f * dz};
}

[[gnu::always_inline]] inline SpringForce dampedForce(double dx, double dy, double dz, double rx,
                                                      double ry, double rz, double rest,
                                                      double stiffness, double damping) {
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz + kTinySquare);
  const double rate = (dx * rx + dy * ry + dz * rz) / length;
  const double f = (stiffness * (length - rest) + damping * rate) / length;
  return {f * dx, f * dy, f * dz};
}

/// Adds the forces of the springs of a contiguous span.
template <bool kDamped>
[[gnu::always_inline]] inline void addSpan(const SpringSchedule::Span& span,
                                           const SpringParameterTable& parameters,
                                           const VectorArray& x, const VectorArray& v,
                                           VectorArray& force) {
  const ConstAxes xa = axesAt(x, span.ends.a);
  const ConstAxes xb = axesAt(x, span.ends.b);
  const ConstAxes va = axesAt(v, span.ends.a);
  const ConstAxes vb = axesAt(v, span.ends.b);
  const Axes fa = axesAt(force, span.ends.a);
  const Axes fb = axesAt(force, span.ends.b);
  const double* const rest = parameters.restLength().data() + span.firstParameters;
  const double* const stiffness = parameters.stiffness().data() + span.firstParameters;
  const double* const damping =
      kDamped ? parameters.damping().data() + span.firstParameters : nullptr;
  const std::int32_t count = span.count;
  CLOTH_SIM_NO_ALIAS_LOOP
  for (std::int32_t k = 0; k < count; ++k) {
    const double dx = xb.x[k] - xa.x[k];
    const double dy = xb.y[k] - xa.y[k];
    const double dz = xb.z[k] - xa.z[k];
    const SpringForce on = kDamped
                               ? dampedForce(dx, dy, dz, vb.x[k] - va.x[k], vb.y[k] - va.y[k],
                                             vb.z[k] - va.z[k], rest[k], stiffness[k], damping[k])
                               : elasticForce(dx, dy, dz, rest[k], stiffness[k]);
    fa.x[k] += on.x;
    fa.y[k] += on.y;
    fa.z[k] += on.z;
    fb.x[k] -= on.x;
    fb.y[k] -= on.y;
    fb.z[k] -= on.z;
  }
}

CLOTH_SIM_VECTOR_CLONES
void addElasticSpan(const SpringSchedule::Span& span, const SpringParameterTable& parameters,
                    const VectorArray& x, const VectorArray& v, VectorArray& force) {
  addSpan<false>(span, parameters, x, v, force);
}

CLOTH_SIM_VECTOR_CLONES
void addDampedSpan(const SpringSchedule::Span& span, const SpringParameterTable& parameters,
                   const VectorArray& x, const VectorArray& v, VectorArray& force) {
  addSpan<true>(span, parameters, x, v, force);
}

}  // namespace

double springPotential(const SpringSchedule& schedule, const VectorArray& x, const VectorArray& v,
                       double tau) {
  double sum = 0.0;
  schedule.forEach([&](const SpringSchedule::Element& spring) {
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    const Vec3 d = x.at(b) - x.at(a);
    const double length = std::sqrt(d.squaredNorm() + kTinySquare);
    const double rate = d.dot(v.at(b) - v.at(a)) / length;
    const double extension = length - spring.parameters.restLength;
    sum += 0.5 * spring.parameters.stiffness * extension * extension +
           0.5 * tau * spring.parameters.damping * rate * rate;
  });
  return sum;
}

void addSpringForce(const SpringSchedule::Element& spring, const VectorArray& x,
                    const VectorArray& v, VectorArray& force) {
  const auto a = static_cast<std::size_t>(spring.a);
  const auto b = static_cast<std::size_t>(spring.b);
  const auto& [rest, stiffness, damping] = spring.parameters;
  const double dx = x.x[b] - x.x[a];
  const double dy = x.y[b] - x.y[a];
  const double dz = x.z[b] - x.z[a];
  const SpringForce on = damping > 0.0 ? dampedForce(dx, dy, dz, v.x[b] - v.x[a], v.y[b] - v.y[a],
                                                     v.z[b] - v.z[a], rest, stiffness, damping)
                                       : elasticForce(dx, dy, dz, rest, stiffness);
  force.x[a] += on.x;
  force.y[a] += on.y;
  force.z[a] += on.z;
  force.x[b] -= on.x;
  force.y[b] -= on.y;
  force.z[b] -= on.z;
}

void addSpringForces(const SpringSchedule& schedule, const VectorArray& x, const VectorArray& v,
                     VectorArray& force) {
  const auto add = schedule.parameters.damped() ? addDampedSpan : addElasticSpan;
  schedule.sweep(
      [&](const SpringSchedule::Span& span) { add(span, schedule.parameters, x, v, force); },
      [&](const SpringSchedule::Element& spring) { addSpringForce(spring, x, v, force); });
}

}  // namespace cloth_sim
