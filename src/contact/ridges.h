#pragma once
/// \file Edges of the cloth, and where it is folded along them.

#include <array>
#include <cstdint>
#include <vector>

#include "cloth_sim/cloth/model.h"
#include "substep_motion.h"

namespace cloth_sim {

/// Edges along which the cloth is folded. Between two edges, only ridges are locally closest (Chen
/// et al. 2025, Offset Geometric Contact): where the faces beside both edges are flat, vertices and
/// faces are as near to each other, and carry the load.
class Ridges {
 public:
  using EdgeId = std::int32_t;
  struct Edge {
    std::array<VertexId, 2> end{};
    std::array<VertexId, 2> wing{};  ///< opposite corners of the faces beside it; kNone: no face
    FaceId owner = kNone;            ///< its first face
  };

  /// Two faces count as flat if the corner of one is off the plane of the other by no more than
  /// this share of the thickness of their cloth. Where two flat edges cross they are nearer to each
  /// other than the vertices and faces around them by no more than that.
  static constexpr double kFlatShare = 0.0035;

  /// Follows the mesh.
  void build(const TriangleMesh& mesh);
  const Edge& operator[](EdgeId edge) const { return edges_[edge]; }
  /// The edges that `face` is the first face of; kNone in place of others.
  const std::array<EdgeId, 3>& ownedBy(FaceId face) const { return ownedBy_[face]; }
  /// Has the edges followed that a face owns.
  void watch(FaceId face);
  /// Follows no edge any more.
  void clear();
  /// Finds along which edges the cloth may be folded soon.
  /// \param halfThickness  by vertex [m].
  /// \param ahead          for how many times the motion of the substep.
  void follow(const SubstepMotion& motion, const std::vector<double>& halfThickness, double ahead);
  /// Tells whether the cloth may be folded along an edge that is followed: not if both faces beside
  /// it were loaded, and are flat.
  bool isFolded(EdgeId edge) const { return isFolded_[edge] != 0; }
  /// Edges along which it may be, for the first time since they are followed.
  const std::vector<EdgeId>& risen() const { return risen_; }
  bool isRisen(EdgeId edge) const { return past_[edge] == Past::kRisen; }
  /// Tells whether it might be before the last `follow`.
  bool isOldRidge(EdgeId edge) const { return past_[edge] == Past::kRidge; }
  /// Tells whether it may be now, or might have been since the edge is followed.
  bool isRidge(EdgeId edge) const { return isRisen(edge) || isOldRidge(edge); }

 private:
  /// The course of an edge so far.
  enum class Past : std::uint8_t {
    kUnwatched,
    kFlat,   ///< whenever it was looked at
    kRisen,  ///< until the last time, when it might be folded
    kRidge,  ///< until some time before
  };

  bool isLoaded(VertexId v) const { return v != kNone && loadedFor_[v] == count_; }
  bool staysFlat(const Edge& edge, const SubstepMotion& motion, double slack, double ahead) const;

  std::vector<Edge> edges_;                     ///< by their first face
  std::vector<std::array<EdgeId, 3>> ownedBy_;  ///< by face
  std::vector<EdgeId> watched_;
  std::vector<std::uint8_t> isFolded_;    ///< by edge
  std::vector<Past> past_;                ///< by edge
  std::vector<EdgeId> risen_;             ///< edges with the past kRisen
  std::vector<std::uint32_t> loadedFor_;  ///< by vertex: the last time that it was followed
  std::uint32_t count_ = 0;               ///< of the times that it was
};

}  // namespace cloth_sim
