/// \file Narrow phase: projects particles out of a collider, with friction as displacements.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "cloth_sim/contact/collider.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Move along the normal below which a sticking particle returns to exactly the place on the
/// collider that it had [m]. The move is round-off, and without this rule a particle at rest
/// creeps.
constexpr double kRestTolerance = 1e-12;

/// The collider during one substep: the same for all particles.
struct ColliderSubstep {
  Vec3 position = Vec3::Zero();                        ///< of the collider at the end [m]
  Vec3 before = Vec3::Zero();                          ///< its position at the start [m]
  Vec3 carry = Vec3::Zero();                           ///< displacement of the collider [m]
  bool turns = false;                                  ///< whether it turns
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< from the start to the end
  double friction = 0.0;                               ///< Coulomb coefficient [-]
  double keep = 1.0;  ///< fraction of its slip that a particle keeps after the decay [-]
  double rise = 0.0;  ///< limit on the push of a particle that starts inside [m]

  /// Returns where a particle would be if it moved along with the collider.
  Vec3 carried(const Vec3& start) const {
    return turns ? Vec3(position + turn * (start - before)) : Vec3(start + carry);
  }
};

/// Returns the end of a particle of positive mass that the collider stops.
/// \param anchor  place of the particle if it had moved along with the collider [m].
/// \param end     place of the particle without contact [m].
[[gnu::always_inline]] inline Vec3 stopAt(const ColliderSubstep& substep, const SweepHit& hit,
                                          const Vec3& anchor, const Vec3& end) {
  const Vec3 moved = end - anchor;
  const double along = hit.normal.dot(moved);
  const double rise = along + hit.push;
  Vec3 slip = moved - along * hit.normal;
  const double stopped = substep.friction * hit.push;
  if (slip.squaredNorm() <= stopped * stopped) {
    return std::abs(rise) <= kRestTolerance ? anchor : Vec3(anchor + rise * hit.normal);
  }
  slip *= substep.keep * (1.0 - stopped / slip.norm());
  return anchor + rise * hit.normal + slip;
}

/// Moments of displacements of particles: over h, impulses.
struct Moments {
  Vec3 first = Vec3::Zero();    ///< mass times displacement [kg m]
  Vec3 turning = Vec3::Zero();  ///< position times that, as a cross product [kg m^2]

  /// \param at  position of the particle before its displacement `by` [m].
  void add(double mass, const Vec3& at, const Vec3& by) {
    const Vec3 moment = mass * by;
    first += moment;
    turning += at.cross(moment);
  }
  void operator+=(const Moments& other) {
    first += other.first;
    turning += other.turning;
  }
};

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

}  // namespace

void Collider::project(const std::vector<VertexId>& vertices, const ParticleView& particles,
                       double time, double h, ContactImpulse& impulse, std::size_t cloth) const {
  const ContactProperties& properties = properties_[cloth];
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
  const std::size_t known = vertices.empty() ? 0 : static_cast<std::size_t>(vertices.back()) + 1;
  NearTriangles* near = nearTriangles(known);
  const Moments moments = visitGeometry(
      obstacle_.shape, pose.orientation, properties.margin,
      [&](const auto& solid) { return projectAll(solid, substep, vertices, particles, near); });
  impulse.linear -= moments.first / h;
  impulse.angular -= moments.turning / h;
}

}  // namespace cloth_sim
