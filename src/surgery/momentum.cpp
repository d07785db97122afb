#include "momentum.h"

#include <Eigen/Dense>
#include <algorithm>

namespace cloth_sim {
namespace {

/// Number of corrections. The second removes what rounding left of the first.
constexpr int kPasses = 2;
/// Moments of inertia below this fraction of the largest count as zero.
constexpr double kFlat = 1e-12;
/// Moments of inertia also count as zero if all particles are nearer to each other than this
/// fraction of their distance from the origin, because rounding errors dominate there.
constexpr double kSamePlace = 1e-12;

/// Inertia of a set of particles as a rigid body.
struct RigidFrame {
  double mass = 0.0;
  Vec3 centre = Vec3::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre [kg m^2]
};

RigidFrame frameOf(const std::vector<VertexId>& vertices, const VertexData<double>& mass,
                   const State& state) {
  RigidFrame frame;
  for (VertexId v : vertices) {
    frame.mass += mass[v];
    frame.centre += mass[v] * state.x[v];
  }
  frame.centre /= frame.mass;
  for (VertexId v : vertices) {
    const Vec3 r = state.x[v] - frame.centre;
    frame.inertia += mass[v] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return frame;
}

/// Returns the angular velocity of a given angular momentum about the centre [rad/s]. Its
/// components along principal axes without inertia are zero.
Vec3 angularVelocity(const RigidFrame& frame, const Vec3& angular) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(frame.inertia);
  const Vec3& moments = axes.eigenvalues();
  const double least = std::max(kFlat * moments[2],
                                frame.mass * kSamePlace * kSamePlace * frame.centre.squaredNorm());
  Vec3 omega = axes.eigenvectors().transpose() * angular;
  for (int k = 0; k < 3; ++k) {
    omega[k] = moments[k] > least ? omega[k] / moments[k] : 0.0;
  }
  return axes.eigenvectors() * omega;
}

}  // namespace

Momentum momentumOf(const std::vector<VertexId>& vertices, const VertexData<double>& mass,
                    const State& state) {
  Momentum sum;
  for (VertexId v : vertices) {
    if (static_cast<std::size_t>(v) >= mass.size()) continue;
    const Vec3 p = mass[v] * state.v[v];
    sum.linear += p;
    sum.angular += state.x[v].cross(p);
  }
  return sum;
}

void restoreMomentum(const Momentum& wanted, const std::vector<VertexId>& vertices,
                     const VertexData<double>& mass, State& state) {
  if (vertices.empty()) return;
  const RigidFrame frame = frameOf(vertices, mass, state);
  for (int pass = 0; pass < kPasses; ++pass) {
    const Momentum now = momentumOf(vertices, mass, state);
    const Vec3 linear = wanted.linear - now.linear;
    const Vec3 angular = wanted.angular - now.angular - frame.centre.cross(linear);
    const Vec3 velocity = linear / frame.mass;
    const Vec3 omega = angularVelocity(frame, angular);
    for (VertexId v : vertices) state.v[v] += velocity + omega.cross(state.x[v] - frame.centre);
  }
}

}  // namespace cloth_sim
