#pragma once
/// \file Pairs of faces that are kept apart: the certificate that no two faces intersect.

#include "pair_watch.h"

namespace cloth_sim {

/// A substep whose motion may be shortened.
struct Truncation {
  SubstepMotion motion;
  std::vector<std::uint8_t>& truncated;  ///< by vertex: set to `pass` if its motion is changed
  std::uint8_t pass = 1;                 ///< from 1 on
};

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
  /// Tells whether a direction separates two faces, except for corners that they share.
  static bool areApart(const Face& a, const Face& b, const std::vector<Vec3>& x);
  void clear();
  std::size_t count() const { return watch_.count(); }

  /// Changes the motion of vertices so that no pair touches or passes through itself, neither at
  /// the end of the substep nor on the way there.
  PairOutcome keepApart(Truncation now);
  /// Takes all motion back.
  void stop(const Truncation& now);

 private:
  /// The corners of a pair; those that both faces share come last, in the same order.
  struct Pair {
    Face a;
    Face b;
    std::int32_t shared = 0;        ///< number of shared corners: 0, 1 or 2
    bool isFixed = false;           ///< motion of its vertices was shortened in this substep
    Vec3 direction = Vec3::Zero();  ///< n, from b to a; 0: not known yet
  };

  static Pair pairOf(const Face& a, const Face& b);
  Pair& pairAt(std::size_t k);
  static double separationOf(const Pair& pair, const std::vector<Vec3>& x);
  static Vec3 bestAxis(const Pair& pair, const std::vector<Vec3>& x);
  static double tryDirections(Pair& pair, const SubstepMotion& motion);
  static double tryFromVertex(Pair& pair, const SubstepMotion& motion);
  static double separationWithin(const Pair& pair, const SubstepMotion& motion);
  static SeparatingDirection bestDirection(const Pair& pair, const std::vector<Vec3>& x);
  void listAgain(const Truncation& last);
  void indexPairs();
  void findFailing(const SubstepMotion& motion);
  static double slackOf(Pair& pair, const SubstepMotion& motion);
  static bool staysApart(const Pair& pair, const Vec3& n0, const Vec3& n1, SubstepMotion motion);
  static double rateOf(const Pair& pair);
  static Vec3 endDirection(Pair pair, const Vec3& before, const std::vector<Vec3>& end);
  bool slide(Pair& pair, const Truncation& now) const;
  static double shareOf(const Pair& pair, const std::vector<double>& mass);
  bool shorten(Pair& pair, const Truncation& now) const;
  static void shortenAtShared(const Pair& pair, double apart, const Truncation& now);
  void shortenApart(const Pair& pair, const Truncation& now) const;

  PairWatch watch_;
  std::vector<std::int32_t> placeOf_;   ///< in `pairs_`, by pair; kNone for most
  std::vector<Pair> pairs_;             ///< that were looked at
  std::vector<std::uint32_t> listed_;   ///< scratch: pairs to look at, ascending
  std::vector<std::uint8_t> isListed_;  ///< scratch: by pair, 0 between uses
  /// Numbers of pairs by their faces, ascending; of the first `indexed_` pairs.
  std::vector<std::uint32_t> pairsStart_, pairsOf_;
  std::size_t indexed_ = 0;
  std::vector<double> slack_;           ///< scratch: see `slackOf`, in the order of `listed_` [m]
  std::vector<std::uint32_t> failing_;  ///< scratch: pairs that are not proven, ascending
  double least_ = 0.0;                  ///< see `assign` [m]
};

}  // namespace cloth_sim
