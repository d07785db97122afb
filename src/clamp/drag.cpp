#include "cloth_sim/clamp/drag.h"

#include <algorithm>
#include <limits>

namespace cloth_sim {
namespace {

constexpr double kTimeConstant = 0.05;  ///< of the motion towards the ray [s]
constexpr double kMaxSpeed = 1.5;       ///< [m/s]
constexpr double kTie = 0.01;  ///< differences of distance from the ray that do not count [m]

/// The place of a point relative to a ray.
struct Approach {
  double depth = 0.0;     ///< along the ray [m]
  double distance = 0.0;  ///< from the ray [m]; infinity for points behind its origin
};

Approach approach(const Vec3& point, const Vec3& origin, const Vec3& along) {
  const double depth = (point - origin).dot(along);
  if (depth <= 0.0) return {0.0, std::numeric_limits<double>::infinity()};
  return {depth, (point - origin - depth * along).norm()};
}

}  // namespace

std::string validationError(const Ray& ray) {
  if (!ray.origin.allFinite()) return "the ray's origin is not finite";
  if (!ray.direction.allFinite()) return "the ray's direction is not finite";
  if (ray.direction.isZero(0.0)) return "the ray's direction is zero";
  return "";
}

bool Drag::pick(const Ray& ray, const State& state) {
  if (vertex_ != kNone) return true;
  const Vec3 along = ray.direction.normalized();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& x : state.x) {
    nearest = std::min(nearest, approach(x, ray.origin, along).distance);
  }
  if (!(nearest <= kReach)) return false;
  depth_ = std::numeric_limits<double>::infinity();
  for (VertexId v = 0; v < static_cast<VertexId>(state.x.size()); ++v) {
    const Approach to = approach(state.x[v], ray.origin, along);
    if (to.distance > nearest + kTie || to.depth >= depth_) continue;
    vertex_ = v;
    depth_ = to.depth;
  }
  position_ = state.x[vertex_];
  velocity_.setZero();
  offset_ = position_ - (ray.origin + depth_ * along);
  return true;
}

void Drag::aim(const Ray& ray, double time) {
  goal_ = ray.origin + depth_ * ray.direction.normalized() + offset_;
  aimed_ = time;
}

void Drag::advance(const State& state, double dt) {
  if (vertex_ != kNone && state.t - aimed_ > kPatience) release();
  if (vertex_ == kNone) return;
  const Vec3 from = state.x[vertex_];
  velocity_ = (goal_ - from) / std::max(kTimeConstant, dt);
  const double speed = velocity_.norm();
  if (speed > kMaxSpeed) velocity_ *= kMaxSpeed / speed;
  position_ = from + dt * velocity_;
}

void Drag::appendTargets(std::vector<KinematicTarget>& out) const {
  if (vertex_ != kNone) out.push_back({vertex_, position_, velocity_});
}

void Drag::applyChanges(const MeshChanges& changes) {
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.kind != VertexEdit::Kind::kRemove || vertex_ == kNone) continue;
    if (edit.id == vertex_) {
      release();
    } else if (edit.from[0] == vertex_) {
      vertex_ = edit.id;
    }
  }
}

}  // namespace cloth_sim
