/// \file Broad phase: the particles that can touch a collider during a step.

#include <algorithm>
#include <cmath>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

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

void Collider::collectWithin(const MotionBounds& bounds, const State& state, double dt,
                             double reach, std::vector<VertexId>& out) const {
  const Vec3 position = poseAt(state.t).position;
  const Vec3 velocity = obstacle_.velocity;
  const double farthest = reach + dt * (bounds.speed + velocity.norm());
  visitGeometry(obstacle_.shape, obstacle_.pose.orientation, margin(), [&](const auto& solid) {
    if (solid.leastGap(bounds.centre - position, bounds.half) > farthest) return;
    const VertexId count = static_cast<VertexId>(state.x.size());
    for (VertexId v = 0; v < count; ++v) {
      const Vec3 relative = state.x[v] - position;
      if (solid.isBeyond(relative, farthest)) continue;
      const double speed = (state.v[v] - velocity).norm();
      if (solid.gap(relative) <= reach + dt * speed) out.push_back(v);
    }
  });
}

void Collider::collect(const State& state, double dt, double reach,
                       std::vector<VertexId>& out) const {
  if (state.x.size() == 0) return;
  collectWithin(motionBounds(state), state, dt, reach, out);
}

void ColliderSet::detect(const State& state, const MotionBounds& bounds, double dt, double reach,
                         Contacts& out) const {
  out.clear();
  if (colliders_.empty() || state.x.size() == 0) return;
  for (const Collider& collider : colliders_) {
    ContactCandidates& entry = out.add(&collider);
    collider.collectWithin(bounds, state, dt, reach, entry.vertices);
    if (entry.vertices.empty()) out.dropLast();
  }
}

}  // namespace cloth_sim
