#include "momentum.h"

#include <Eigen/Dense>
#include <algorithm>

namespace cloth_sim {
namespace {

/// Rounding leaves a rest after the first correction; the second one takes it too.
constexpr int kPasses = 2;
/// Moments of inertia this much smaller than the largest count as zero ...
constexpr double kFlat = 1e-12;
/// ... and so do those of particles within this part of their distance from the origin: rounding.
constexpr double kSamePlace = 1e-12;

struct RigidFrame {
  double mass = 0.0;
  Vec3 centre = Vec3::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre
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

/// The rotation that has a given angular momentum; none about axes without inertia.
Vec3 rotationFor(const RigidFrame& frame, const Vec3& angular) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(frame.inertia);
  const Vec3& moments = axes.eigenvalues();
  const double least = std::max(kFlat * moments[2],
                                frame.mass * kSamePlace * kSamePlace * frame.centre.squaredNorm());
  Vec3 rotation = axes.eigenvectors().transpose() * angular;
  for (int k = 0; k < 3; ++k) {
    rotation[k] = moments[k] > least ? rotation[k] / moments[k] : 0.0;
  }
  return axes.eigenvectors() * rotation;
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
    const Vec3 push = linear / frame.mass;
    const Vec3 spin = rotationFor(frame, angular);
    for (VertexId v : vertices) state.v[v] += push + spin.cross(state.x[v] - frame.centre);
  }
}

}  // namespace cloth_sim
