#pragma once
/// \file ~topology and ~frame as what a graphics card draws. Needs no node, no master and no rviz.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/ClothTopology.h"
#include "cloth_sim/ros/shading.h"

namespace cloth_sim {

struct SurfaceStyle {
  bool strain = true;        ///< the front is coloured by strain; else `front`
  double strainRange = 0.2;  ///< strain that gets the last colour of the map [-], > 0
  std_msgs::ColorRGBA front = makeColour(0.23f, 0.42f, 0.62f);
  std_msgs::ColorRGBA back = makeColour(0.86f, 0.74f, 0.62f);
  double tornWidth = 0.005;  ///< of the ribbons along torn edges [m], >= 0
};

/// Vertices, colours and triangles of both sides of a cloth, and ribbons along its torn edges.
/// Buffers are kept from frame to frame, so that a frame allocates nothing once warm.
class Surface {
 public:
  /// Four bytes: red, green, blue, 255.
  using Packed = std::array<std::uint8_t, 4>;

  /// Takes over the triangles. What was shown before is gone until the next `setFrame`.
  /// \return empty; or why the message is no surface (then nothing has changed).
  std::string setTopology(const ClothTopology& topology);

  /// Whether positions of this revision are what `setTopology` is waiting for.
  bool fits(const ClothFrame& frame) const { return frame.revision == revision_; }

  /// Takes over the positions; computes normals, strain and colours.
  ///
  /// The strain of a vertex is the largest of the edges of its faces: their length over that in
  /// material coordinates, less one (markers take the second diagonals of cells, too).
  /// \return empty; or why the message is no frame of this surface (then nothing has changed).
  std::string setFrame(const ClothFrame& frame, const SurfaceStyle& style);

  std::uint64_t revision() const { return revision_; }
  std::size_t vertexCount() const { return uv_.size() / 2; }
  /// Vertex numbers, three a face, counter-clockwise seen from the front.
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }
  /// x y z of every vertex [m].
  const std::vector<float>& positions() const { return positions_; }
  const std::vector<Eigen::Vector3f>& normals() const { return normals_; }  ///< unit, or z
  const std::vector<float>& strain() const { return strain_; }              ///< >= 0 [-]
  const std::vector<Packed>& frontColours() const { return front_; }
  const std::vector<Packed>& backColours() const { return back_; }
  /// Two crossed ribbons along each torn edge: x y z of eight vertices.
  const std::vector<float>& tornPositions() const { return tornPositions_; }
  /// Triangles of those, seen from both sides.
  const std::vector<std::uint32_t>& tornTriangles() const { return tornTriangles_; }
  /// Box of the positions [m].
  const Eigen::Vector3f& low() const { return low_; }
  const Eigen::Vector3f& high() const { return high_; }

 private:
  void computeBox();
  void computeNormalsAndStrain();
  void paint(const SurfaceStyle& style);
  void addRibbons(double width);

  std::uint64_t revision_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<float> uv_;
  std::vector<float> inverseRest_;  ///< 1 / squared rest length of each edge of each face [1/m^2]
  std::vector<std::uint32_t> tornEdges_;
  std::vector<float> positions_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<float> strain_;
  std::vector<Packed> front_;
  std::vector<Packed> back_;
  std::vector<float> tornPositions_;
  std::vector<std::uint32_t> tornTriangles_;
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f high_ = Eigen::Vector3f::Zero();
};

}  // namespace cloth_sim
