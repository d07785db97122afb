#pragma once
/// \file Pairs of faces that are kept apart: the certificate that no two faces intersect.

#include "cloth_sim/mesh/triangle_mesh.h"
#include "material_tree.h"

namespace cloth_sim {

/// Positions of all vertices at both ends of a substep. Between, each vertex moves on a straight
/// line.
struct SubstepMotion {
  const std::vector<Vec3>& start;  ///< by vertex [m]
  std::vector<Vec3>& end;          ///< by vertex [m]
};

/// What keeping the faces apart has changed.
struct TruncationCount {
  int vertices = 0;   ///< number of vertices whose motion was shortened
  int unproven = 0;   ///< pairs that no plane separates at the start of the substep
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
  void clear() { pairs_.clear(); }
  std::size_t count() const { return pairs_.size(); }

  /// Shortens the motion of vertices so that no pair touches or passes through itself, neither at
  /// the end of the substep nor on the way there.
  /// \param truncated  out: set to 1 for each vertex whose motion was shortened, by vertex.
  TruncationCount keepApart(SubstepMotion motion, std::vector<std::uint8_t>& truncated);

 private:
  /// The corners of a pair; those that both faces share come last, in the same order.
  struct Pair {
    Face a;
    Face b;
    std::int32_t shared = 0;        ///< number of shared corners: 0, 1 or 2
    bool isFixed = false;           ///< motion of its vertices was shortened in this substep
    Vec3 direction = Vec3::Zero();  ///< n, from b to a; 0: not known yet
    double due = 0.0;               ///< value of `travel_` from which n is to be checked again [m]
  };

  static double separationOf(const Pair& pair, const std::vector<Vec3>& x);
  static double hingeGap(const Pair& pair, const std::vector<Vec3>& x);
  static SeparatingDirection bestDirection(const Pair& pair, const std::vector<Vec3>& x);
  static bool hasTruncated(const Pair& pair, const std::vector<std::uint8_t>& truncated);
  void findFailing(bool isFirst, SubstepMotion motion, const std::vector<std::uint8_t>& truncated);
  bool isProven(Pair& pair, SubstepMotion motion) const;
  bool findDirection(Pair& pair, SubstepMotion motion) const;
  void shorten(Pair& pair, SubstepMotion motion, std::vector<std::uint8_t>& truncated,
               TruncationCount& count) const;
  void shortenAtShared(const Pair& pair, double apart, SubstepMotion motion,
                       std::vector<std::uint8_t>& truncated) const;
  void shortenApart(const Pair& pair, SubstepMotion motion,
                    std::vector<std::uint8_t>& truncated) const;

  std::vector<Pair> pairs_;
  std::vector<std::uint8_t> fails_;     ///< scratch: 1 for pairs that are not proven
  std::vector<std::uint32_t> failing_;  ///< scratch: pairs that are not proven
  double least_ = 0.0;   ///< see `assign` [m]
  double travel_ = 0.0;  ///< sum over substeps of how far two vertices may have approached [m]
};

}  // namespace cloth_sim
