#pragma once
/// \file Lines of a given width on a surface, as vertex buffers for a graphics card.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace cloth_sim {

/// Two crossed ribbons along each of some edges of a surface: one along it, one upright. Buffers
/// are kept from frame to frame.
class Ribbons {
 public:
  /// \param edges  vertex numbers, two an edge.
  void setEdges(std::vector<std::uint32_t> edges);

  /// Computes the corners of the ribbons.
  /// \param surface  x y z of every vertex [m].
  /// \param normals  unit normal of every vertex.
  /// \param width    of the ribbons [m], >= 0.
  void update(const std::vector<float>& surface, const std::vector<Eigen::Vector3f>& normals,
              double width);

  /// Vertex numbers, two an edge.
  const std::vector<std::uint32_t>& edges() const { return edges_; }
  /// x y z of eight corners an edge [m]; empty before the first `update`.
  const std::vector<float>& positions() const { return positions_; }
  /// Corner numbers, three a triangle; the triangles are seen from both sides.
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }

 private:
  std::vector<std::uint32_t> edges_;
  std::vector<float> positions_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace cloth_sim
