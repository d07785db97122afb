#pragma once
/// \file A set of pairs of faces.

#include <cstddef>
#include <vector>

#include "material_tree.h"

namespace cloth_sim {

/// A set of pairs of faces: chains by the first face, of which few are longer than ten.
class FacePairSet {
 public:
  /// Empties the set. \param faces  number of faces of the mesh.
  void clear(std::size_t faces) {
    latest_.assign(faces, -1);
    links_.clear();
  }
  bool isEmpty() const { return links_.empty(); }
  /// Adds a pair. \return false if it is there already.
  bool insert(const FaceIds& pair) {
    for (std::int32_t k = latest_[pair.first]; k >= 0; k = links_[k].earlier) {
      if (links_[k].second == pair.second) return false;
    }
    links_.push_back({pair.second, latest_[pair.first]});
    latest_[pair.first] = static_cast<std::int32_t>(links_.size()) - 1;
    return true;
  }

 private:
  struct Link {
    FaceId second = kNone;
    std::int32_t earlier = -1;  ///< the link before in the chain; -1: none
  };
  std::vector<std::int32_t> latest_;  ///< by first face: the last link of its chain; -1: none
  std::vector<Link> links_;
};

}  // namespace cloth_sim
