#include "cloth_sim/ros/looks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace cloth_sim {
namespace {

using Eigen::Vector4f;

constexpr double kLeastRest = 1e-6;     ///< rest length of an edge that may divide [m]
constexpr float kLeastNormal = 1e-30f;  ///< square of a face's normal that may divide [-]

constexpr int kLanes = FaceLooks::kLanes;
using Lanes = FaceLooks::Lanes;

/// A vector in each lane.
struct Lanes3 {
  Lanes x, y, z;

  Lanes3 operator-(const Lanes3& other) const { return {x - other.x, y - other.y, z - other.z}; }
  Lanes3 operator*(const Lanes& factor) const { return {x * factor, y * factor, z * factor}; }
  Lanes3 cross(const Lanes3& other) const {
    return {y * other.z - z * other.y, z * other.x - x * other.z, x * other.y - y * other.x};
  }
  Lanes squaredNorm() const { return x * x + y * y + z * z; }
};

/// The corners of number k of a block of faces, four at a time.
Lanes3 gather(const Face* faces, std::size_t k, const std::vector<Vector4f>& places) {
  Lanes3 out;
  for (int lane = 0; lane < kLanes; lane += 4) {
    Eigen::Matrix4f four;
    for (int j = 0; j < 4; ++j) four.col(j) = places[faces[lane + j][k]];
    four.transposeInPlace();
    out.x.segment<4>(lane) = four.col(0);
    out.y.segment<4>(lane) = four.col(1);
    out.z.segment<4>(lane) = four.col(2);
  }
  return out;
}

Vector4f padded(const Vec3& value) {
  return {static_cast<float>(value.x()), static_cast<float>(value.y()),
          static_cast<float>(value.z()), 0.0f};
}

void addNormals(const Snapshot& snapshot, std::vector<Look>& out) {
  for (const Face& face : snapshot.topology->faces) {
    const Vec3& a = snapshot.positions[face[0]];
    const Vector4f normal =
        padded(snapshot.positions[face[1]] - a).cross3(padded(snapshot.positions[face[2]] - a));
    for (const VertexId v : face) out[v] += normal;
  }
  for (Look& look : out) {
    // In double: the square of a flat cloth's rounding errors is a subnormal float, which is slow.
    const double length = look.cast<double>().norm();
    look = length > 0.0 ? Look(look * static_cast<float>(1.0 / length)) : Look::Unit(2);
  }
}

void addStrains(const Snapshot& snapshot, std::vector<Look>& out) {
  for (Look& look : out) look[3] = 1.0f;  // of squared lengths, for now
  for (const Topology::Link& link : snapshot.topology->links) {
    const double square = (snapshot.positions[link.b] - snapshot.positions[link.a]).squaredNorm();
    const auto stretch = static_cast<float>(square / (link.restLength * link.restLength));
    out[link.a][3] = std::max(out[link.a][3], stretch);
    out[link.b][3] = std::max(out[link.b][3], stretch);
  }
  for (Look& look : out) look[3] = std::sqrt(look[3]) - 1.0f;
}

}  // namespace

void vertexLooks(const Snapshot& snapshot, std::vector<Look>& out) {
  out.assign(snapshot.positions.size(), Look::Zero());
  addNormals(snapshot, out);
  addStrains(snapshot, out);
}

void FaceLooks::setTopology(const std::shared_ptr<const Topology>& topology) {
  if (topology == topology_) return;
  topology_ = topology;
  faces_ = topology->faces;
  while (faces_.size() % kLanes != 0) faces_.push_back(faces_.back());
  inverseRest_.resize(faces_.size() / kLanes);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2& from = topology->material[faces_[f][k]];
      const double rest = (topology->material[faces_[f][(k + 1) % 3]] - from).norm();
      inverseRest_[f / kLanes][k][f % kLanes] =
          static_cast<float>(1.0 / std::max(kLeastRest, rest));
    }
  }
}

void FaceLooks::prepare(const Snapshot& snapshot) {
  setTopology(snapshot.topology);
  places_.resize(snapshot.positions.size());
  for (std::size_t v = 0; v < places_.size(); ++v) {
    places_[v] = padded(snapshot.positions[v] - snapshot.positions.front());
  }
}

/// Edges over their rest lengths: their squares and that of the normal are near 1, not so small
/// that rounding errors of a flat cloth would be subnormal numbers, which are slow.
void FaceLooks::look(Block& block) const {
  const Face* faces = &faces_[block.first];
  const std::array<Lanes, 3>& inverseRest = inverseRest_[block.first / kLanes];
  const Lanes3 a = gather(faces, 0, places_);
  const Lanes3 b = gather(faces, 1, places_);
  const Lanes3 c = gather(faces, 2, places_);
  const Lanes3 ab = (b - a) * inverseRest[0];
  const Lanes3 bc = (c - b) * inverseRest[1];
  const Lanes3 ca = (a - c) * inverseRest[2];
  const Lanes3 normal = ab.cross(bc);
  const Lanes stretch = ab.squaredNorm().max(bc.squaredNorm()).max(ca.squaredNorm());
  const Lanes scale = normal.squaredNorm().max(kLeastNormal).rsqrt();
  block.x = normal.x * scale;
  block.y = normal.y * scale;
  block.z = normal.z * scale;
  block.strain = stretch.max(1.0f).sqrt() - 1.0f;
}

}  // namespace cloth_sim
