/// \file How a collider stops particles: non-penetration and friction as displacements.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "geometry.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Below this a sticking particle's move along the normal is round-off, and it is put back exactly
/// where it was on the collider: so nothing creeps, however long it lies there.
constexpr double kRestTolerance = 1e-12;  // [m]

/// What is the same for all particles of one collider in one substep.
struct Surface {
  Vec3 position = Vec3::Zero();  ///< of the collider at the end [m]
  Vec3 carry = Vec3::Zero();     ///< how far the collider moved [m]
  double friction = 0.0;
  double keep = 1.0;  ///< share of its tangential displacement that a touching particle keeps
  double rise = 0.0;  ///< how far a particle that began inside may be pushed out [m]
};

/// Where a particle of positive mass ends.
/// \param anchor  where it would be had it moved along with the collider [m].
/// \param end     where it is without contact [m].
[[gnu::always_inline]] inline Vec3 stopAt(const Surface& surface, const geometry::Touch& touch,
                                          const Vec3& anchor, const Vec3& end) {
  const Vec3 moved = end - anchor;
  const double along = touch.normal.dot(moved);
  const double rise = along + touch.push;
  Vec3 slip = moved - along * touch.normal;
  const double stopped = surface.friction * touch.push;
  if (slip.squaredNorm() <= stopped * stopped) {
    return std::abs(rise) <= kRestTolerance ? anchor : Vec3(anchor + rise * touch.normal);
  }
  slip *= surface.keep * (1.0 - stopped / slip.norm());
  return anchor + rise * touch.normal + slip;
}

/// `touch` and `stopAt` in one for the most common contact: with the top of an upright solid, which
/// is level. In about a quarter of their time, with the same result. \return whether the path stays
/// over the top, so that the particle has been dealt with.
bool stopAtTop(const geometry::Top& top, const Surface& surface, const ParticleView& p,
               std::int32_t i, Vec3& moment) {
  const double ax = p.startX[i] + surface.carry.x();
  const double ay = p.startY[i] + surface.carry.y();
  const double az = p.startZ[i] + surface.carry.z();
  const double ex = p.x[i];
  const double ey = p.y[i];
  const double ez = p.z[i];
  const Vec3& centre = surface.position;
  const bool over = az - centre.z() >= top.solid && std::abs(ax - centre.x()) <= top.halfX &&
                    std::abs(ay - centre.y()) <= top.halfY &&
                    std::abs(ex - centre.x()) <= top.halfX &&
                    std::abs(ey - centre.y()) <= top.halfY;
  if (!over) return false;
  const double level = centre.z() + top.level;
  const double after = ez - level;
  if (after >= 0.0) return true;
  const double push = std::min(0.0, az - level + surface.rise) - after;
  const double rise = ez - az + push;
  double slipX = ex - ax;
  double slipY = ey - ay;
  const double slip2 = slipX * slipX + slipY * slipY;
  const double stopped = surface.friction * push;
  const bool sticks = slip2 <= stopped * stopped;
  const double keep = sticks ? 0.0 : surface.keep * (1.0 - stopped / std::sqrt(slip2));
  slipX *= keep;
  slipY *= keep;
  p.x[i] = ax + slipX;
  p.y[i] = ay + slipY;
  p.z[i] = sticks && std::abs(rise) <= kRestTolerance ? az : az + rise;
  moment += p.mass[i] * Vec3(p.x[i] - ex, p.y[i] - ey, p.z[i] - ez);
  return true;
}

/// \return the sum of mass times displacement [kg m].
template <class Geometry>
Vec3 projectOut(const Geometry& solid, const Surface& surface, const VertexId* vertex,
                const VertexId* end, const ParticleView& p) {
  constexpr double kAtOnce = std::numeric_limits<double>::infinity();
  Vec3 moment = Vec3::Zero();
  geometry::Touch touch;
  const std::optional<geometry::Top> top = solid.top();
  for (; vertex != end; ++vertex) {
    const std::int32_t i = p.slotOf ? p.slotOf[*vertex] : *vertex;
    if (top && p.mass[i] != 0.0 && stopAtTop(*top, surface, p, i, moment)) continue;
    const Vec3 anchor = Vec3(p.startX[i], p.startY[i], p.startZ[i]) + surface.carry;
    const bool prescribed = p.mass[i] == 0.0;
    const double rise = prescribed ? kAtOnce : surface.rise;
    for (int side = 0; side < Geometry::kSides; ++side) {
      const Vec3 at(p.x[i], p.y[i], p.z[i]);
      if (!solid.touch(anchor - surface.position, at - surface.position, rise, touch)) break;
      const Vec3 stop =
          prescribed ? Vec3(at + touch.push * touch.normal) : stopAt(surface, touch, anchor, at);
      p.x[i] = stop.x();
      p.y[i] = stop.y();
      p.z[i] = stop.z();
      moment += p.mass[i] * (stop - at);
    }
  }
  return moment;
}

/// The same for all vertices, on several threads where that pays: sums of parts that are the same
/// for any number of them, added up in order.
template <class Geometry>
Vec3 projectAllOut(const Geometry& solid, const Surface& surface,
                   const std::vector<VertexId>& vertices, const ParticleView& p) {
  constexpr std::size_t kPart = 512;
  constexpr std::size_t kMostParts = 256;
  constexpr std::int32_t kGrain = 8;  // so many parts are worth a second thread
  const std::size_t parts = std::min((vertices.size() + kPart - 1) / kPart, kMostParts);
  std::array<Vec3, kMostParts> moments;
  const auto boundary = [&](std::size_t part) {
    return vertices.data() + vertices.size() * part / parts;
  };
  parallelFor(static_cast<std::int32_t>(parts), kGrain, [&](std::int32_t first, std::int32_t last) {
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
      moments[k] = projectOut(solid, surface, boundary(k), boundary(k + 1), p);
    }
  });
  return std::accumulate(moments.data(), moments.data() + parts, Vec3(Vec3::Zero()));
}

}  // namespace

void Collider::project(const std::vector<VertexId>& vertices, const ParticleView& particles,
                       double time, double h, Vec3& impulse, std::size_t cloth) const {
  Surface surface;
  surface.position = poseAt(time).position;
  surface.carry = obstacle_.velocity * h;
  const ContactSkin& skin = skins_[cloth];
  surface.friction = obstacle_.friction.value_or(skin.friction);
  surface.keep = std::exp(-obstacle_.tangentialDecay * h);
  surface.rise = kDepenetrationSpeed * h;
  const Vec3 moment = geometry::visit(*this, skin.margin, [&](const auto& solid) {
    return projectAllOut(solid, surface, vertices, particles);
  });
  impulse -= moment / h;
}

}  // namespace cloth_sim
