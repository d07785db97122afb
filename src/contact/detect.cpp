/// \file Broad phase: the particles that can touch a collider during a step.

#include <algorithm>
#include <cmath>

#include "cloth_sim/contact/collider.h"
#include "feature_search.h"

namespace cloth_sim {
namespace {

/// Least distance that cloth may be pulled in one step, beyond its speed times dt, and still be
/// among the pairs with sharp corners and edges [m].
constexpr double kFeatureReach = 0.01;

}  // namespace

MotionBounds motionBounds(const State& state) {
  const std::vector<Vec3>& x = state.x.values();
  const std::vector<Vec3>& v = state.v.values();
  if (x.empty()) return {};
  Vec3 low = x[0];
  Vec3 high = x[0];
  double speed2 = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    low = low.cwiseMin(x[k]);
    high = high.cwiseMax(x[k]);
    speed2 = std::max(speed2, v[k].squaredNorm());
  }
  return {0.5 * (low + high), 0.5 * (high - low), std::sqrt(speed2)};
}

namespace {

/// Tells whether the gap at `point` is at most `limit`. \param near  of the vertex there.
template <class Geometry>
bool isWithin(const Geometry& solid, const Vec3& point, double limit,
              const NearTriangles* /*near*/) {
  return solid.gap(point) <= limit;
}

bool isWithin(const geometry::Mesh& solid, const Vec3& point, double limit,
              const NearTriangles* near) {
  return solid.isWithin(point, limit, *near);
}

}  // namespace

void Collider::collectWithin(const MotionBounds& bounds, const State& state, double dt,
                             double reach, std::vector<VertexId>& out) const {
  const Pose pose = poseAt(state.t);
  const Vec3& position = pose.position;
  const Vec3 velocity = obstacle_.velocity;
  const double turn = obstacle_.angularVelocity.norm() * dt;  // [rad]
  const double moved = dt * (bounds.speed + velocity.norm());
  const double away = (bounds.centre - position).norm() + bounds.half.norm();
  const double farthest = reach + moved + turn * (away + moved);
  const NearTriangles* near = nearTriangles(state.x.size());
  visitGeometry(obstacle_.shape, pose.orientation, margin(), [&](const auto& solid) {
    if (solid.leastGap(bounds.centre - position, bounds.half) > farthest) return;
    const VertexId count = static_cast<VertexId>(state.x.size());
    for (VertexId v = 0; v < count; ++v) {
      const Vec3 relative = state.x[v] - position;
      if (solid.isBeyond(relative, farthest)) continue;
      double path = dt * (state.v[v] - velocity).norm();
      if (turn > 0.0) path += turn * (relative.norm() + path);
      const NearTriangles* own = near != nullptr ? near + v : nullptr;
      if (isWithin(solid, relative, reach + path, own)) out.push_back(v);
    }
  });
}

void Collider::collect(const State& state, double dt, double reach,
                       std::vector<VertexId>& out) const {
  if (state.x.size() == 0) return;
  collectWithin(motionBounds(state), state, dt, reach, out);
}

/// The features are found anew in each step, so they need less reach than particles: what a step
/// misses is found as pierced in the next one.
void Collider::collectFeatures(const TriangleMesh& mesh, const State& state, double dt,
                               double reach, std::vector<FeaturePair>& out) const {
  if (!features_) return;
  const FeatureSearch search{obstacle_.velocity, dt, obstacle_.angularVelocity.norm() * dt,
                             margin() + reach};
  collectPairs(placedFeatures(poseAt(state.t)), mesh, state, search, found_, out);
}

void ColliderSet::detect(const State& state, const MotionBounds& bounds, double dt, double reach,
                         const TriangleMesh& mesh, Contacts& out) const {
  out.clear();
  if (colliders_.empty() || state.x.size() == 0) return;
  for (const Collider& collider : colliders_) {
    ContactCandidates& entry = out.add(&collider);
    collider.collectWithin(bounds, state, dt, reach, entry.vertices);
    collider.collectFeatures(mesh, state, dt, std::max(kFeatureReach, bounds.speed * dt),
                             entry.pairs);
    if (entry.vertices.empty() && entry.pairs.empty()) out.dropLast();
  }
}

void ColliderSet::detect(const State& state, double dt, double reach, Contacts& out) const {
  detect(state, motionBounds(state), dt, reach, TriangleMesh(), out);
}

}  // namespace cloth_sim
