/// \file Narrow phase: projects particles out of a collider, with friction as displacements.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "cloth_sim/contact/collider.h"
#include "collider_substep.h"
#include "feature_contacts.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Fast path for the most common contact, with a level top: does the work of `sweep` and `stopAt`
/// in a quarter of the time, with the same result.
/// \param moment  sum of mass times displacement [kg m], to which the particle adds its own.
/// \return false, and nothing done, unless the path stays over the top.
bool stopAtTop(const LevelTop& top, const ColliderSubstep& substep, const ParticleView& p,
               std::int32_t i, Moments& moments) {
  const double ax = p.startX[i] + substep.carry.x();
  const double ay = p.startY[i] + substep.carry.y();
  const double az = p.startZ[i] + substep.carry.z();
  const double ex = p.x[i];
  const double ey = p.y[i];
  const double ez = p.z[i];
  const Vec3& centre = substep.position;
  const bool over = az - centre.z() >= top.height && std::abs(ax - centre.x()) <= top.halfX &&
                    std::abs(ay - centre.y()) <= top.halfY &&
                    std::abs(ex - centre.x()) <= top.halfX &&
                    std::abs(ey - centre.y()) <= top.halfY;
  if (!over) return false;
  const double level = centre.z() + top.level;
  const double after = ez - level;
  if (after >= 0.0) return true;
  const double push = std::min(0.0, az - level + substep.rise) - after;
  const double rise = ez - az + push;
  double slipX = ex - ax;
  double slipY = ey - ay;
  const double slip2 = slipX * slipX + slipY * slipY;
  const double stopped = substep.friction * push;
  const bool sticks = slip2 <= stopped * stopped;
  const double keep = sticks ? 0.0 : substep.keep * (1.0 - stopped / std::sqrt(slip2));
  slipX *= keep;
  slipY *= keep;
  p.x[i] = ax + slipX;
  p.y[i] = ay + slipY;
  p.z[i] = sticks && std::abs(rise) <= kRestTolerance ? az : az + rise;
  moments.add(p.mass[i], {ex, ey, ez}, {p.x[i] - ex, p.y[i] - ey, p.z[i] - ez});
  return true;
}

/// The path of one particle, for the sweeps of a solid.
struct ParticlePath {
  Vec3 start;  ///< relative to the solid, in the axes of the world [m]
  Vec3 end;
  double rise;          ///< [m]
  bool isLastSweep;     ///< of the substep
  NearTriangles* near;  ///< of a mesh
};

template <class Geometry>
[[gnu::always_inline]] inline bool sweepPath(const Geometry& solid, const ParticlePath& path,
                                             SweepHit& hit) {
  return solid.sweep(path.start, path.end, path.rise, hit);
}

inline bool sweepPath(const geometry::Mesh& solid, const ParticlePath& path, SweepHit& hit) {
  if (path.isLastSweep) return solid.stop(path.start, path.end, path.rise, hit, *path.near);
  return solid.sweep(path.start, path.end, path.rise, hit, *path.near);
}

/// Tells whether the solid stops a vertex of positive mass.
/// \param near  by vertex, of a mesh.
template <class Geometry>
bool stopsAny(const Geometry& solid, const ColliderSubstep& substep,
              const std::vector<VertexId>& vertices, const ParticleView& p, NearTriangles* near) {
  SweepHit hit;
  return std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) {
    const std::int32_t i = p.slot(v);
    if (p.mass[i] == 0.0) return false;
    const ParticlePath path{substep.carried(p.startAt(i)) - substep.position,
                            p.at(i) - substep.position, substep.rise, false,
                            near != nullptr ? near + v : nullptr};
    return sweepPath(solid, path, hit);
  });
}

/// Projects the vertices of a range. \return the moments of their displacements.
/// \param near  by vertex, of a mesh.
template <class Geometry>
Moments projectRange(const Geometry& solid, const ColliderSubstep& substep, const VertexId* vertex,
                     const VertexId* end, const ParticleView& p, NearTriangles* near) {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  Moments moments;
  SweepHit hit;
  const std::optional<LevelTop> top = solid.levelTop();
  for (; vertex != end; ++vertex) {
    const std::int32_t i = p.slot(*vertex);
    if (top && !substep.turns && p.mass[i] != 0.0 && stopAtTop(*top, substep, p, i, moments))
      continue;
    const Vec3 anchor = substep.carried(p.startAt(i));
    const bool prescribed = p.mass[i] == 0.0;
    const double rise = prescribed ? kNoLimit : substep.rise;
    for (int hits = 0; hits < Geometry::kMaxHits; ++hits) {
      const Vec3 at(p.x[i], p.y[i], p.z[i]);
      if (std::is_same_v<Geometry, geometry::Mesh> && hits > 0 && at == anchor) break;  // it sticks
      const ParticlePath path{anchor - substep.position, at - substep.position, rise,
                              hits == Geometry::kMaxHits - 1,
                              near != nullptr ? near + *vertex : nullptr};
      if (!sweepPath(solid, path, hit)) break;
      const Vec3 stop =
          prescribed ? Vec3(at + hit.push * hit.normal) : stopAt(substep, hit, anchor, at);
      p.x[i] = stop.x();
      p.y[i] = stop.y();
      p.z[i] = stop.z();
      moments.add(p.mass[i], at, stop - at);
    }
  }
  return moments;
}

/// Projects all vertices, on several threads where that pays. The ranges do not depend on the
/// number of threads and their sums are added in order, so neither does the result.
/// \return the moments of all displacements.
template <class Geometry>
Moments projectAll(const Geometry& solid, const ColliderSubstep& substep,
                   const std::vector<VertexId>& vertices, const ParticleView& p,
                   NearTriangles* near) {
  constexpr std::size_t kRange = 512;  // vertices
  constexpr std::size_t kMaxRanges = 256;
  constexpr std::int32_t kGrain = 8;  // ranges that pay for a second thread
  const std::size_t ranges = std::min((vertices.size() + kRange - 1) / kRange, kMaxRanges);
  std::array<Moments, kMaxRanges> moments;
  const auto boundary = [&](std::size_t range) {
    return vertices.data() + vertices.size() * range / ranges;
  };
  const auto projectRanges = [&](std::int32_t first, std::int32_t last) {
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
      moments[k] = projectRange(solid, substep, boundary(k), boundary(k + 1), p, near);
    }
  };
  parallelFor(static_cast<std::int32_t>(ranges), kGrain, projectRanges);
  Moments sum;
  for (std::size_t k = 0; k < ranges; ++k) sum += moments[k];
  return sum;
}

/// Number of the vertices up to the last one of an ascending list.
std::size_t countUpTo(const std::vector<VertexId>& vertices) {
  return vertices.empty() ? 0 : static_cast<std::size_t>(vertices.back()) + 1;
}

/// Adds the impulse that displacements of particles in a substep of `h` [s] give the collider.
void takeReaction(const Moments& moments, double h, ContactImpulse& impulse) {
  impulse.linear -= moments.first / h;
  impulse.angular -= moments.turning / h;
}

}  // namespace

ColliderSubstep Collider::substep(double time, double h, std::size_t cloth) const {
  ColliderSubstep substep;
  const Pose pose = poseAt(time);
  substep.position = pose.position;
  substep.carry = obstacle_.velocity * h;
  substep.turns = turns();
  if (substep.turns) {
    const Pose before = poseAt(time - h);
    substep.before = before.position;
    substep.turn = (pose.orientation * before.orientation.conjugate()).toRotationMatrix();
  }
  substep.friction = friction(cloth);
  substep.keep = std::exp(-obstacle_.tangentialDecay * h);
  substep.rise = kDepenetrationSpeed * h;
  return substep;
}

bool Collider::stops(const std::vector<VertexId>& vertices, const ParticleView& particles,
                     double time, double h, std::size_t cloth) const {
  const ColliderSubstep now = substep(time, h, cloth);
  NearTriangles* near = nearTriangles(countUpTo(vertices));
  return visitGeometry(
      obstacle_.shape, poseAt(time).orientation, properties_[cloth].margin,
      [&](const auto& solid) { return stopsAny(solid, now, vertices, particles, near); });
}

void Collider::project(const std::vector<VertexId>& vertices, const ParticleView& particles,
                       double time, double h, ContactImpulse& impulse, std::size_t cloth) const {
  const ColliderSubstep now = substep(time, h, cloth);
  NearTriangles* near = nearTriangles(countUpTo(vertices));
  const Moments moments = visitGeometry(
      obstacle_.shape, poseAt(time).orientation, properties_[cloth].margin,
      [&](const auto& solid) { return projectAll(solid, now, vertices, particles, near); });
  takeReaction(moments, h, impulse);
}

void Collider::projectFeatures(std::vector<FeaturePair>& pairs, const ParticleView& particles,
                               double time, double h, ContactImpulse& impulse,
                               std::size_t cloth) const {
  if (pairs.empty()) return;
  const Moments moments = projectPairs(
      placedFeatures(poseAt(time)), substep(time, h, cloth),
      std::max(properties_[cloth].margin, geometry::Mesh::kLeastReach), particles, pairs);
  takeReaction(moments, h, impulse);
}

void Collider::certifyFeatures(std::vector<FeaturePair>& pairs, const ParticleView& particles,
                               double time, double h, ContactImpulse& impulse) const {
  if (pairs.empty()) return;
  const Moments moments =
      certifyPairs(placedFeatures(poseAt(time)), substep(time, h, 0), particles, pairs);
  takeReaction(moments, h, impulse);
}

}  // namespace cloth_sim
