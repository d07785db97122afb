#include "ribbons.h"

#include <Eigen/Geometry>
#include <array>

namespace cloth_sim {
namespace {

using Eigen::Vector3f;
using Map = Eigen::Map<const Vector3f>;

constexpr std::uint32_t kCorners = 4;  ///< of one ribbon

}  // namespace

void Ribbons::setEdges(std::vector<std::uint32_t> edges) {
  edges_ = std::move(edges);
  positions_.clear();
  triangles_.clear();
  const auto ribbons = static_cast<std::uint32_t>(edges_.size());  // two an edge
  for (std::uint32_t ribbon = 0; ribbon < ribbons; ++ribbon) {
    for (const std::uint32_t corner : {0u, 1u, 2u, 1u, 3u, 2u}) {
      triangles_.push_back(kCorners * ribbon + corner);
    }
  }
}

void Ribbons::update(const std::vector<float>& surface, const std::vector<Vector3f>& normals,
                     double width) {
  const auto half = static_cast<float>(0.5 * width);
  positions_.clear();
  for (std::size_t e = 0; e < edges_.size(); e += 2) {
    const std::array<std::uint32_t, 2> ends{edges_[e], edges_[e + 1]};
    const Map a(&surface[3 * ends[0]]);
    const Map b(&surface[3 * ends[1]]);
    const Vector3f up = (normals[ends[0]] + normals[ends[1]]).normalized();
    const Vector3f aside = (b - a).cross(up).normalized();
    for (const Vector3f& across : {aside, up}) {
      for (const Map& end : {a, b}) {
        for (const float side : {-half, half}) {
          const Vector3f corner = end + side * across;
          positions_.insert(positions_.end(), {corner.x(), corner.y(), corner.z()});
        }
      }
    }
  }
}

}  // namespace cloth_sim
