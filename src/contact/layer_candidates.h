#pragma once
/// \file Pairs of parts of the cloth that may come into contact.

#include <array>
#include <vector>

#include "candidate_points.h"
#include "cloth_sim/cloth/model.h"
#include "face_pair_search.h"
#include "ridges.h"

namespace cloth_sim {

/// Faces near each other.
struct NearFaces {
  const std::vector<FaceIds>& pairs;
  const std::vector<FaceId>& faces;  ///< of the pairs, in the order in which they came in
  SearchBoxes boxes;                 ///< that pairs were found with
};

/// Vertices and faces, and edges, that may come nearer than the thickness of the cloth before the
/// next search. Each knows how far its vertices have to move in sum until then, so that the closest
/// points of few are found again. Two edges are listed when the cloth may be folded along one of
/// them for the first time: where layers are flat, most never are.
class LayerCandidates {
 public:
  /// Follows the mesh. \param thickness  by cloth [m].
  void build(const Model& model, const std::vector<double>& thickness);
  void clear();
  /// Lists what can come into contact of pairs of faces near each other.
  /// \param known  number of pairs that have been listed; the others are new.
  /// \param moved  vertices with new boxes, and faces with such corners.
  void extend(const NearFaces& near, std::size_t known, const Renewed& moved);
  /// Follows the motion of a substep; what all vertices have in common does not count. Every few
  /// substeps it first finds the closest points, at the start of the substep, of what may come
  /// nearer than the thickness until the next time, vertices and faces before edges.
  /// \return whether it did.
  bool follow(const SubstepMotion& motion, const NearFaces& near);
  /// The closest points that were found last.
  const std::vector<ClosestPoints>& found() const { return found_; }

 private:
  template <typename IsMissing>
  void listVertices(const FaceIds& ids, const SearchBoxes& boxes, const IsMissing& isMissing);
  template <typename IsMissing>
  void listEdges(const FaceIds& ids, const SearchBoxes& boxes, const IsMissing& isMissing);
  void listMoved(const NearFaces& near, std::size_t known, const Renewed& moved);
  void listNewRidges(const NearFaces& near);
  void findTouching(const SubstepMotion& motion, const NearFaces& near);

  std::vector<Face> corners_;          ///< by face
  std::vector<double> halfThickness_;  ///< by vertex [m]
  std::vector<FaceId> firstFace_;      ///< by vertex
  Ridges ridges_;
  std::size_t watched_ = 0;  ///< faces of pairs whose edges are followed
  CandidateList faces_;
  CandidateList edges_;
  std::vector<std::uint8_t> isMoved_;   ///< scratch: by vertex
  std::vector<std::uint8_t> isMarked_;  ///< scratch: by face
  VectorArray start_;                   ///< scratch: positions, by vertex [m]
  std::vector<double> step_;            ///< how far a vertex moves in the substep, by vertex [m]
  std::vector<double> travel_;          ///< how far it has moved since `clear`, by vertex [m]
  std::vector<double> outlook_;  ///< how far it may have until closest points are found again [m]
  std::vector<ClosestPoints> found_;
  int sinceFound_ = 0;  ///< substeps
};

}  // namespace cloth_sim
