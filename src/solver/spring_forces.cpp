#include "spring_forces.h"

#include <cmath>

#include "cloth_sim/solver/vector_clones.h"

namespace cloth_sim {
namespace {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;

/// One spring from a to b: the force that a gets.
struct Pull {
  double x, y, z;
};

[[gnu::always_inline]] inline Pull elasticPull(double dx, double dy, double dz, double rest,
                                               double stiffness) {
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz + kTinySquare);
  const double f = stiffness * (length - rest) / length;
  return {f * dx, f * dy, f * dz};
}

[[gnu::always_inline]] inline Pull dampedPull(double dx, double dy, double dz, double rx, double ry,
                                              double rz, double rest, double stiffness,
                                              double damping) {
  const double length = std::sqrt(dx * dx + dy * dy + dz * dz + kTinySquare);
  const double rate = (dx * rx + dy * ry + dz * rz) / length;
  const double f = (stiffness * (length - rest) + damping * rate) / length;
  return {f * dx, f * dy, f * dz};
}

template <bool kDamped>
[[gnu::always_inline]] inline void pullAll(std::int32_t count, std::int32_t first, std::int32_t a,
                                           std::int32_t b, const SpringSchedule& s,
                                           const PackedVectors& x, const PackedVectors& v,
                                           PackedVectors& force) {
  const double* const ax = x.x.data() + a;
  const double* const ay = x.y.data() + a;
  const double* const az = x.z.data() + a;
  const double* const bx = x.x.data() + b;
  const double* const by = x.y.data() + b;
  const double* const bz = x.z.data() + b;
  const double* const au = v.x.data() + a;
  const double* const av = v.y.data() + a;
  const double* const aw = v.z.data() + a;
  const double* const bu = v.x.data() + b;
  const double* const bv = v.y.data() + b;
  const double* const bw = v.z.data() + b;
  const double* const rest = s.restLength.data() + first;
  const double* const stiffness = s.stiffness.data() + first;
  const double* const damping = kDamped ? s.damping.data() + first : nullptr;
  double* const fax = force.x.data() + a;
  double* const fay = force.y.data() + a;
  double* const faz = force.z.data() + a;
  double* const fbx = force.x.data() + b;
  double* const fby = force.y.data() + b;
  double* const fbz = force.z.data() + b;
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const double dx = bx[k] - ax[k];
    const double dy = by[k] - ay[k];
    const double dz = bz[k] - az[k];
    const Pull pull = kDamped ? dampedPull(dx, dy, dz, bu[k] - au[k], bv[k] - av[k], bw[k] - aw[k],
                                           rest[k], stiffness[k], damping[k])
                              : elasticPull(dx, dy, dz, rest[k], stiffness[k]);
    fax[k] += pull.x;
    fay[k] += pull.y;
    faz[k] += pull.z;
    fbx[k] -= pull.x;
    fby[k] -= pull.y;
    fbz[k] -= pull.z;
  }
}

CLOTH_SIM_VECTOR_CLONES
void pullRun(std::int32_t count, std::int32_t first, std::int32_t a, std::int32_t b,
             const SpringSchedule& s, const PackedVectors& x, const PackedVectors& v,
             PackedVectors& force) {
  pullAll<false>(count, first, a, b, s, x, v, force);
}

CLOTH_SIM_VECTOR_CLONES
void pullDampedRun(std::int32_t count, std::int32_t first, std::int32_t a, std::int32_t b,
                   const SpringSchedule& s, const PackedVectors& x, const PackedVectors& v,
                   PackedVectors& force) {
  pullAll<true>(count, first, a, b, s, x, v, force);
}

}  // namespace

double springPotential(const SpringSchedule& schedule, const PackedVectors& x,
                       const PackedVectors& v, double tau) {
  double sum = 0.0;
  for (std::int32_t p = 0; p < schedule.size(); ++p) {
    const auto a = static_cast<std::size_t>(schedule.endA[p]);
    const auto b = static_cast<std::size_t>(schedule.endB[p]);
    const Vec3 d = x.at(b) - x.at(a);
    const double length = std::sqrt(d.squaredNorm() + kTinySquare);
    const double rate = d.dot(v.at(b) - v.at(a)) / length;
    const double extension = length - schedule.restLength[p];
    sum += 0.5 * schedule.stiffness[p] * extension * extension +
           0.5 * tau * schedule.dampingAt(p) * rate * rate;
  }
  return sum;
}

void addSpringForce(const SpringSchedule& s, std::int32_t p, const PackedVectors& x,
                    const PackedVectors& v, PackedVectors& force) {
  const auto a = static_cast<std::size_t>(s.endA[p]);
  const auto b = static_cast<std::size_t>(s.endB[p]);
  const double dx = x.x[b] - x.x[a];
  const double dy = x.y[b] - x.y[a];
  const double dz = x.z[b] - x.z[a];
  const Pull pull = s.damped
                        ? dampedPull(dx, dy, dz, v.x[b] - v.x[a], v.y[b] - v.y[a], v.z[b] - v.z[a],
                                     s.restLength[p], s.stiffness[p], s.damping[p])
                        : elasticPull(dx, dy, dz, s.restLength[p], s.stiffness[p]);
  force.x[a] += pull.x;
  force.y[a] += pull.y;
  force.z[a] += pull.z;
  force.x[b] -= pull.x;
  force.y[b] -= pull.y;
  force.z[b] -= pull.z;
}

void addSpringForces(const SpringSchedule& schedule, const PackedVectors& x, const PackedVectors& v,
                     PackedVectors& force) {
  schedule.sweep(
      [&](std::int32_t first, std::int32_t count) {
        const auto pull = schedule.damped ? pullDampedRun : pullRun;
        pull(count, first, schedule.endA[first], schedule.endB[first], schedule, x, v, force);
      },
      SpringSchedule::each(
          [&](std::int32_t position) { addSpringForce(schedule, position, x, v, force); }));
}

}  // namespace cloth_sim
