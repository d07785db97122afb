#pragma once
/// \file Pairs of faces that are kept apart: the certificate that no two faces intersect.

#include "cloth_sim/mesh/triangle_mesh.h"
#include "material_tree.h"

namespace cloth_sim {

/// A substep, in which each vertex moves on a straight line.
struct SubstepMotion {
  const std::vector<Vec3>& start;         ///< positions, by vertex [m]
  std::vector<Vec3>& end;                 ///< the same at the end [m]
  const std::vector<double>& mass;        ///< by vertex [kg]; 0: prescribed motion
  const std::vector<VertexId>& vertices;  ///< those of all pairs at least, ascending
};

/// A substep whose motion may be shortened.
struct Truncation {
  SubstepMotion motion;
  std::vector<std::uint8_t>& truncated;  ///< by vertex: set to 1 if its motion was changed
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
  std::size_t count() const { return pairs_.size(); }

  /// Changes the motion of vertices so that no pair touches or passes through itself, neither at
  /// the end of the substep nor on the way there.
  PairOutcome keepApart(const Truncation& now);
  /// Takes all motion back.
  static void stop(const Truncation& now);

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
  static double separationOf(const Pair& pair, const std::vector<Vec3>& x);
  static Vec3 bestAxis(const Pair& pair, const std::vector<Vec3>& x);
  static Vec3 fromVertex(const Pair& pair, const std::vector<Vec3>& x);
  bool separates(std::size_t k, SubstepMotion motion);
  void setDue(std::size_t k, double apart);
  double travelOf(std::size_t k) const {
    return faceTravel_[ids_[k].first] + faceTravel_[ids_[k].second];
  }
  void follow(const SubstepMotion& motion);
  static SeparatingDirection bestDirection(const Pair& pair, const std::vector<Vec3>& x);
  static bool hasTruncated(const Pair& pair, const std::vector<std::uint8_t>& truncated);
  bool mayFail(std::size_t k, const std::vector<std::uint8_t>& truncated) const;
  void proveByBoxes(const SubstepMotion& motion);
  void boxFaces(const SubstepMotion& motion);
  void findFailing(const SubstepMotion& motion);
  void findFailingAgain(const SubstepMotion& motion, const std::vector<std::uint8_t>& truncated);
  void listFailing();
  bool isProven(std::size_t k, SubstepMotion motion);
  static bool staysApart(const Pair& pair, const Vec3& n0, const Vec3& n1, SubstepMotion motion);
  static double rateOf(const Pair& pair);
  static Vec3 endDirection(Pair pair, const Vec3& before, const std::vector<Vec3>& end);
  bool slide(Pair& pair, const Truncation& now) const;
  static double shareOf(const Pair& pair, const std::vector<double>& mass);
  bool shorten(std::size_t k, const Truncation& now);
  static void shortenAtShared(const Pair& pair, double apart, const Truncation& now);
  void shortenApart(const Pair& pair, const Truncation& now) const;

  /// Pairs whose least `due_` is known.
  static constexpr std::size_t kBlock = 128;

  std::vector<Face> faces_;
  std::vector<Pair> pairs_;
  std::vector<FaceIds> ids_;            ///< by pair
  std::vector<FaceId> paired_;          ///< faces of pairs
  std::vector<std::uint8_t> isPaired_;  ///< by face
  std::vector<double> due_;         ///< by pair: `travelOf` from which n is to be checked again [m]
  std::vector<double> blockDue_;    ///< by block: `travel_` up to which no pair of it is due [m]
  std::vector<double> step_;        ///< scratch: motion in the substep, by vertex [m]
  std::vector<double> faceTravel_;  ///< sum over substeps of the farthest motion of a corner [m]
  std::size_t known_ = 0;           ///< pairs that have been looked at
  std::vector<QuickBox> corners_[2];      ///< scratch: by vertex, at the start and at the end
  std::vector<QuickBox> boxes_[2];        ///< scratch: by face, at the start and at the end
  std::vector<std::uint8_t> fails_;       ///< by pair: 1 if it is in `failing_`
  std::vector<std::uint8_t> hasFailing_;  ///< scratch: by block
  std::vector<std::uint32_t> failing_;    ///< pairs that are not proven, ascending
  double least_ = 0.0;                    ///< see `assign` [m]
  double travel_ = 0.0;                   ///< the most that `travelOf` has grown for any pair [m]
};

}  // namespace cloth_sim
