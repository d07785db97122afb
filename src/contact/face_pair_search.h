#pragma once
/// \file The search for pairs of faces near each other, of all cloths.

#include "allowance.h"
#include "face_pair_set.h"

namespace cloth_sim {

/// Boxes around the places that vertices and faces may take until the next search, larger by half
/// of the distance up to which faces are near.
struct SearchBoxes {
  const std::vector<QuickBox>& corners;  ///< by vertex
  const std::vector<QuickBox>& faces;    ///< by face
};

/// Finds the pairs of faces that may come nearer than a margin before the next search, while
/// vertices and gradients are where its allowance lets them be.
class FacePairSearch {
 public:
  /// Follows the mesh. \param margin  half of the distance up to which faces are near [m].
  void build(const Model& model, double margin);
  /// Finds pairs from the start of a motion on.
  /// \param start, end  positions in the motion, by vertex [m].
  /// \return whether there are no more than `most`; if not, some may be missing.
  bool findPairs(const std::vector<Vec3>& start, const std::vector<Vec3>& end, const Reach& reach,
                 std::size_t most);
  /// Adds pairs with faces whose allowances were renewed. Pairs that are known stay.
  void findAround();
  const std::vector<FaceIds>& near() const { return near_; }
  SearchBoxes boxes() const { return {corners_, boxes_}; }
  Allowance& allowance() { return allowance_; }
  const Allowance& allowance() const { return allowance_; }

 private:
  void boxCorner(VertexId v);
  void boxFace(FaceId f);
  void collect(std::size_t most);
  void collectNew();

  std::vector<Face> faces_;
  std::vector<MaterialTree> trees_;  ///< of each large piece, and of the rest of each cloth
  double margin_ = 0.0;
  Allowance allowance_;
  std::vector<QuickBox> corners_;  ///< see SearchBoxes
  std::vector<QuickBox> boxes_;    ///< by face
  std::vector<FaceIds> near_;
  FacePairSet known_;  ///< these; empty until there is a search around a part
};

}  // namespace cloth_sim
