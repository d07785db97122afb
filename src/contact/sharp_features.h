#pragma once
/// \file Corners and edges of a surface that are too sharp for tests of particles alone.

#include <array>
#include <cstdint>
#include <vector>

#include "cloth_sim/contact/triangle_surface.h"

namespace cloth_sim {

/// A corner or an edge of a surface.
struct SharpFeature {
  std::array<Vec3, 2> ends;  ///< of an edge, in the axes of the surface [m]; a corner has it twice
  bool isCorner = false;
  /// Sum of the normals of the triangles around it, of a closed surface; 0 of an open one.
  Vec3 outwards = Vec3::Zero();
};

/// The corners and edges of a surface at which it turns by more than `kSharp`, outwards if it is
/// closed, and the border of an open one. Between the particles of a cloth they may show through;
/// where a surface is smoother, the particles alone keep it outside.
class SharpFeatures {
 public:
  static constexpr double kSharp = 0.35;  ///< [rad], 20 degrees

  explicit SharpFeatures(const TriangleSurface& surface);

  bool empty() const { return features_.empty(); }
  const SharpFeature& operator[](std::int32_t k) const { return features_[k]; }

  /// Tells whether the bounding box of a feature may meet a box. \param low, high  corners [m].
  bool areIn(const Vec3& low, const Vec3& high) const;
  /// Lists the features whose bounding box meets a box, in the order of the tree.
  void find(const Vec3& low, const Vec3& high, std::vector<std::int32_t>& out) const;

 private:
  void sort();
  bool meetsBox(std::int32_t feature, const Vec3& low, const Vec3& high) const;

  std::vector<SharpFeature> features_;  ///< in the order of the leaves
  std::vector<BoxNode> nodes_;          ///< over the features; empty without them
};

}  // namespace cloth_sim
