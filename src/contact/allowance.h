#pragma once
/// \file The motion of vertices and the turn of gradients of faces that are allowed until pairs of
/// faces near each other are searched again.

#include <vector>

#include "cloth_sim/contact/contacts.h"
#include "edge_changes.h"

namespace cloth_sim {

/// Motion and turn that a search allows for.
struct Reach {
  double substeps = 0.0;     ///< at the speed of the present one
  double leastMotion = 0.0;  ///< [m]
  double mostMotion = 0.0;   ///< unless a single substep takes more [m]
  double leastTurn = 0.0;    ///< change of a face's gradient, at least [-]
};

/// A part of the cloth with new allowances.
struct Renewed {
  std::vector<VertexId> vertices;  ///< ascending
  std::vector<FaceId> faces;       ///< around these vertices, and others; ascending
};

/// Boxes for the motion of vertices, and balls for the gradients of faces, that a search allows.
/// Motion that all vertices have in common does not count: it brings nothing together.
class Allowance {
 public:
  /// Follows the mesh.
  void build(const Model& model);
  /// Allows for some substeps like this one, from its start on.
  /// \param start, end  positions at both ends of the substep, by vertex [m].
  void renew(const std::vector<Vec3>& start, const std::vector<Vec3>& end, const Reach& reach);
  /// Says where `isKept` finds the vertices. \param particles  at any time.
  void follow(const ParticleView& particles);
  /// Tells whether `isKept` finds the vertices in `particles`.
  bool isFollowing(const ParticleView& particles) const;
  /// Tells whether vertices and gradients are where they may be at the end of a substep.
  bool isKept(const ParticleView& particles);
  /// After `isKept` has said no: renews it for vertices and faces that are not, if they are few and
  /// slow.
  /// \param few   share of all faces up to which they are, in (0, 1]; five times that in sum.
  /// \param most  motion in the substep up to which they are [m].
  /// \return whether they are.
  bool renewLeft(const ParticleView& particles, double few, double most);

  /// Positions at the last search, by vertex [m].
  const std::vector<Vec3>& origin() const { return origin_; }
  /// Where vertices may be, seen from `origin` and from the mean of all vertices, by vertex [m].
  const std::vector<Box>& motions() const { return motions_; }
  /// Gradients that faces may have, by face.
  const std::vector<GradientBall>& gradients() const { return balls_; }
  /// Vertices and faces that `renewLeft` has renewed.
  const Renewed& renewed() const { return left_; }

 private:
  template <typename PlaceOf>
  Gradient gradient(FaceId f, const PlaceOf& placeOf) const;
  void allowMotion(std::size_t v, const Vec3& offset, const Vec3& motion, const Vec3& common);
  void allowTurn(FaceId f, const Gradient& start, const Gradient& end);
  void listSlots();
  void setSlot(VertexId v);
  bool move(const ParticleView& particles, const Vec3& common, std::int32_t first,
            std::int32_t last);
  bool isTurnKept(FaceId f) const;
  bool findLeft(double few);
  bool findLeftVertices(std::size_t mostFaces);

  Reach reach_;
  std::vector<Face> faces_;
  std::vector<Eigen::Matrix2d> inverseRest_;  ///< see inverseRestOf, by face [1/m]
  std::vector<std::int32_t> aroundStart_;     ///< by vertex
  std::vector<FaceId> facesAround_;           ///< by the vertices that they have as corners
  std::vector<Vec3> origin_;
  std::vector<Box> motions_;
  std::vector<GradientBall> balls_;
  EdgeChanges edges_;
  std::vector<std::int32_t> slots_;          ///< by vertex
  std::vector<VertexId> vertexIn_;           ///< by slot; kNone where a vertex was removed
  VectorArray from_, low_, high_;            ///< origin_ and motions_ by slot [m]
  VectorArray moved_;                        ///< motion since, by slot [m]
  std::vector<std::uint8_t> isSegmentKept_;  ///< 1 if all slots of a segment are where they may be
  bool hasSlots_ = false;                    ///< the arrays by slot fit
  Renewed left_;                             ///< vertices and faces that are not where they may be
  std::int64_t renewed_ = 0;                 ///< faces since all were
};

}  // namespace cloth_sim
