#pragma once
/// \file ~topology and ~frame as vertex buffers for a graphics card. Needs no node, no master and
/// no rviz.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/ClothTopology.h"
#include "cloth_sim/cloth/strain.h"
#include "cloth_sim/ros/shading.h"
#include "ribbons.h"

namespace cloth_sim {

struct SurfaceStyle {
  bool strain = true;        ///< colour the front by strain; else by `front`
  double strainRange = 0.2;  ///< strain of the last colour of the map [-], > 0
  std_msgs::ColorRGBA front = makeColour(0.23f, 0.42f, 0.62f);
  std_msgs::ColorRGBA back = makeColour(0.86f, 0.74f, 0.62f);
  double tornWidth = 0.005;    ///< of the ribbons along torn edges [m], >= 0
  double borderWidth = 0.002;  ///< of the ribbons along the borders of cloths [m], >= 0
};

/// Vertices, colours and triangles of both sides of a cloth, and ribbons along its border.
/// Buffers are kept from frame to frame, so that a frame allocates nothing once warm.
class Surface {
 public:
  /// Four bytes: red, green, blue, 255.
  using Packed = std::array<std::uint8_t, 4>;

  /// Takes over the triangles. Clears the positions until the next `setFrame`.
  /// \return the validation error, after which nothing has changed; empty on success.
  std::string setTopology(const ClothTopology& topology);

  /// Tells whether a frame has the revision of the topology, and as many vertices: after a reset
  /// with another number of particles, the revisions begin anew.
  bool fits(const ClothFrame& frame) const {
    return frame.revision == revision_ && frame.positions.size() == 3 * vertexCount_;
  }

  /// Takes over the positions; computes normals, strain (see cloth/strain.h) and colours.
  /// \return the validation error, after which nothing has changed; empty on success.
  std::string setFrame(const ClothFrame& frame, const SurfaceStyle& style);

  std::uint64_t revision() const { return revision_; }
  std::size_t vertexCount() const { return vertexCount_; }
  /// Vertex numbers, three a face, counter-clockwise seen from the front.
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }
  /// x y z of every vertex [m].
  const std::vector<float>& positions() const { return positions_; }
  /// Unit normal of every vertex, to the front of the cloth.
  const std::vector<Eigen::Vector3f>& normals() const { return normals_; }
  /// Strain of every vertex [-], >= 0.
  const std::vector<float>& strain() const { return strain_; }
  const std::vector<Packed>& frontColours() const { return front_; }
  const std::vector<Packed>& backColours() const { return back_; }
  /// Along the edges that tearing and cutting made.
  const Ribbons& torn() const { return torn_; }
  /// Along the rest of the border.
  const Ribbons& border() const { return border_; }
  /// Lowest and highest corner of the box around the positions [m].
  const Eigen::Vector3f& low() const { return low_; }
  const Eigen::Vector3f& high() const { return high_; }

 private:
  void computeBox();
  void paint(const SurfaceStyle& style);

  std::uint64_t revision_ = 0;
  std::size_t vertexCount_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<Face> faces_;              ///< the triangles, as the core has them
  std::vector<StrainLine> strainLines_;  ///< the structural and shear springs
  std::vector<float> positions_;
  std::vector<Vec3> vertices_;  ///< the positions, as the core has them [m]
  std::vector<Eigen::Vector3f> normals_;
  std::vector<float> strain_;
  std::vector<Packed> front_;
  std::vector<Packed> back_;
  Ribbons torn_;
  Ribbons border_;
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f high_ = Eigen::Vector3f::Zero();
};

}  // namespace cloth_sim
