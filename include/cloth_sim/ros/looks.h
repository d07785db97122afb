#pragma once
/// \file What a cloth's surface looks like: where it faces and how far it is stretched.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// A unit normal, to the front of the cloth, and strain >= 0 [-]: one register.
using Look = Eigen::Vector4f;

/// Of each particle: the mean normal of the faces around it, by area, and the largest strain of the
/// structural and shear springs at it.
void vertexLooks(const Snapshot& snapshot, std::vector<Look>& out);

/// Of each face: its normal (or 0 if it has no area), and the largest strain of its edges. Less
/// work than `vertexLooks`.
class FaceLooks {
 public:
  /// Faces that are looked at side by side.
  static constexpr int kLanes = 8;
  using Lanes = Eigen::Array<float, kLanes, 1>;
  /// The looks of some of them.
  struct Block {
    Lanes x, y, z;  ///< of the normals
    Lanes strain;
    std::size_t first = 0;  ///< face
    std::size_t count = 0;  ///< faces; lanes from there on say nothing
  };

  /// Tells `take(const Block& block)` of all faces, in order.
  template <typename Take>
  void visit(const Snapshot& snapshot, Take take) {
    prepare(snapshot);
    Block block;
    const std::size_t count = topology_->faces.size();
    for (std::size_t first = 0; first < count; first += kLanes) {
      block.first = first;
      block.count = std::min<std::size_t>(kLanes, count - first);
      look(block);
      take(block);
    }
  }

 private:
  void prepare(const Snapshot& snapshot);
  void setTopology(const std::shared_ptr<const Topology>& topology);
  void look(Block& block) const;

  std::shared_ptr<const Topology> topology_;
  std::vector<Face> faces_;                        ///< the last one again, until blocks are full
  std::vector<std::array<Lanes, 3>> inverseRest_;  ///< by block: 1 / rest length of edges [1/m]
  std::vector<Eigen::Vector4f> places_;            ///< of vertices, from the first one [m]
};

}  // namespace cloth_sim
