#pragma once
/// \file Pairs of parts of the cloth that may come into contact, and their closest points.

#include <array>
#include <vector>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/contact/layers.h"
#include "face_pair_search.h"
#include "ridges.h"

namespace cloth_sim {

/// Closest points of a vertex and a face, or of two edges. The weighted sum of the positions of
/// four vertices points from the second part to the first.
struct ClosestPoints {
  std::array<VertexId, 4> v{};     ///< a vertex and the corners of a face, or the ends of two edges
  std::array<double, 4> weight{};  ///< those of each part sum to 1 and -1
  FaceId face = kNone;             ///< kNone for two edges
  double apart = 0.0;              ///< [m]

  bool areEdges() const { return face == kNone; }
  /// Tells whether they are inside the face, or inside both edges.
  bool areInside() const {
    return weight[0] != 0.0 && weight[1] != 0.0 && weight[2] != 0.0 && weight[3] != 0.0;
  }
};

/// A vertex and a face, or two edges (`Ridges::EdgeId`).
using CandidateIds = std::array<std::int32_t, 2>;

/// Vertices and faces, and edges, that may come nearer than the thickness of the cloth before the
/// next search. Each knows how far its vertices have to move in sum until then, so that the closest
/// points of few are found again. Two edges count only if the cloth may be folded along one of
/// them.
class LayerCandidates {
 public:
  /// Follows the mesh. \param thickness  by cloth [m].
  void build(const Model& model, const std::vector<double>& thickness);
  void clear();
  /// Lists what can come into contact of pairs of faces near each other.
  /// \param near   all pairs.
  /// \param known  number of those that have been listed; the others are new.
  /// \param moved  vertices with new boxes, and faces with such corners.
  void extend(const std::vector<FaceIds>& near, std::size_t known, const Renewed& moved,
              const SearchBoxes& boxes);
  bool empty() const { return edges_.ids.empty() && faces_.ids.empty(); }
  /// Follows the motion of a substep; what all vertices have in common does not count. Every few
  /// substeps it first finds the closest points, at the start of the substep, of what may come
  /// nearer than the thickness until the next time, vertices and faces before edges.
  /// \return whether it did.
  bool follow(const SubstepMotion& motion);
  /// The closest points that were found last.
  const std::vector<ClosestPoints>& found() const { return found_; }

 private:
  /// Candidates of a kind.
  struct List {
    std::vector<CandidateIds> ids;
    std::vector<double> due;  ///< sum of `travel_` of the vertices from which they may touch [m]

    void clear();
  };

  void addPair(const FaceIds& ids, bool isKnown, const SearchBoxes& boxes);
  void findClosest(const SubstepMotion& motion);
  template <typename Kind>
  void findDue(List& list, double farthest, const Kind& kind);

  std::vector<Face> corners_;          ///< by face
  std::vector<double> halfThickness_;  ///< by vertex [m]
  std::vector<FaceId> firstFace_;      ///< by vertex
  Ridges ridges_;
  List faces_;
  List edges_;
  std::vector<std::uint8_t> isMoved_;      ///< scratch: by vertex
  std::vector<std::uint8_t> isMovedFace_;  ///< scratch: by face
  VectorArray start_;                      ///< scratch: positions, by vertex [m]
  std::vector<double> step_;               ///< how far a vertex moves in the substep, by vertex [m]
  std::vector<double> travel_;             ///< how far it has moved since `clear`, by vertex [m]
  std::vector<double> outlook_;  ///< how far it may have until closest points are found again [m]
  std::vector<ClosestPoints> found_;
  int sinceFound_ = 0;  ///< substeps
};

}  // namespace cloth_sim
