#pragma once
/// \file Pairs of faces that are kept apart: the certificate that no two faces intersect.

#include "impact_zones.h"
#include "pair_watch.h"

namespace cloth_sim {

/// Outcome of keeping the faces of all pairs apart in a substep.
struct PairOutcome {
  bool changed = false;  ///< motion was changed
  int unproven = 0;      ///< pairs that touched or intersected at the start; their vertices stay
};

/// Pairs of faces near each other. For each there is a direction n in which one face is beyond the
/// other. If it is so at both ends of a substep, it is so between: the distance along n changes
/// linearly. Where it is not so at the end, the motion of the vertices is shortened.
///
/// Shortening is what "Divide and Truncate" (arXiv 2604.15513) does with planes between vertices
/// and faces; here one plane serves all six vertices of a pair of triangles, and only pairs that
/// would lose their plane are touched.
class FacePairs {
 public:
  /// Starts with the pairs in `near`.
  /// \param faces  of the mesh.
  /// \param least  distance below which shortened motion does not bring faces nearer [m].
  void assign(const std::vector<FaceIds>& near, const std::vector<Face>& faces, double least);
  /// Adds the pairs in `near` from number `first` on.
  void append(const std::vector<FaceIds>& near, std::size_t first);
  void clear();
  std::size_t count() const { return watch_.count(); }
  /// The faces of pairs, in the order in which they came in.
  const std::vector<FaceId>& faces() const { return watch_.paired(); }

  /// Changes the motion of vertices so that no pair touches or passes through itself, neither at
  /// the end of the substep nor on the way there.
  PairOutcome keepApart(Truncation now);
  /// Takes all motion back.
  void stop(const Truncation& now);

 private:
  FacePair& pairAt(std::size_t k);
  void listAgain(const Truncation& last);
  void indexPairs();
  void findFailing(const SubstepMotion& motion);
  void freePairs();
  bool giveWay(FacePair& pair, int pass, Truncation now);

  PairWatch watch_;
  std::vector<std::int32_t> placeOf_;   ///< in `pairs_`, by pair; kNone for most
  std::vector<FacePair> pairs_;         ///< that were looked at
  std::vector<std::uint32_t> listed_;   ///< scratch: pairs to look at, ascending
  std::vector<std::uint8_t> isListed_;  ///< scratch: by pair, 0 between uses
  /// Numbers of pairs by their faces, ascending; of the first `indexed_` pairs.
  std::vector<std::uint32_t> pairsStart_, pairsOf_;
  std::size_t indexed_ = 0;
  std::vector<double> slack_;           ///< scratch: see `slackOf`, in the order of `listed_` [m]
  std::vector<std::uint32_t> failing_;  ///< scratch: pairs that are not proven, ascending
  ImpactZones zones_;
  double least_ = 0.0;  ///< see `assign` [m]
};

}  // namespace cloth_sim
