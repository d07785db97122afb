#pragma once
/// \file Oriented triangle mesh with material coordinates: connectivity only, no dynamics.

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "cloth_sim/mesh/index_lists.h"
#include "cloth_sim/types.h"

namespace cloth_sim {

using Face = std::array<VertexId, 3>;

/// An oriented 2-manifold with boundary, as triangles plus a vertex -> faces incidence.
///
/// Only `MeshEditor` changes it after construction; every edit raises `revision()`. Edges are not
/// stored: at a vertex degree of about six, looking through the faces around one end is as quick
/// as a map and cannot go stale.
class TriangleMesh {
 public:
  TriangleMesh() = default;

  /// \param material  material coordinates (u, v) per vertex [m]; warp runs along u, weft along v.
  /// \param faces     vertex triples, counter-clockwise in material coordinates.
  /// \throws std::invalid_argument if the result is not a valid oriented manifold.
  TriangleMesh(std::vector<Vec2> material, std::vector<Face> faces);

  std::int32_t vertexCount() const { return static_cast<std::int32_t>(material_.size()); }
  std::int32_t faceCount() const { return static_cast<std::int32_t>(faces_.size()); }
  std::uint64_t revision() const { return revision_; }

  const std::vector<Face>& faces() const { return faces_; }
  const Face& face(FaceId f) const { return faces_[f]; }
  const std::vector<Vec2>& material() const { return material_; }
  const Vec2& material(VertexId v) const { return material_[v]; }

  /// Faces around `v`, ascending by id; to be looked at until the mesh is edited.
  IndexSpan facesAround(VertexId v) const { return incident_[v]; }
  /// The one or two faces with the edge {a, b} (kNone where there is none).
  std::array<FaceId, 2> facesOnEdge(VertexId a, VertexId b) const;
  /// The vertex of `f` that is neither `a` nor `b`.
  VertexId oppositeVertex(FaceId f, VertexId a, VertexId b) const;
  /// Vertices joined to `v` by an edge, ascending by id.
  std::vector<VertexId> neighbours(VertexId v) const;
  /// The same, in `out`.
  void neighbours(VertexId v, std::vector<VertexId>& out) const;
  bool isBoundary(VertexId v) const;
  /// Whether the edge from corner k to the next one of `f` is part of the border that the mesh was
  /// made with. Border edges that are not are where it came apart since.
  bool isOriginalBoundary(FaceId f, int k) const { return ((rim_[f] >> k) & 1U) != 0; }
  /// How many bisections a face is from the original mesh.
  int generation(FaceId f) const { return generation_[f]; }

  /// Rest area of a face, in material coordinates [m^2].
  double restArea(FaceId f) const;
  double totalRestArea() const;

 private:
  friend class MeshEditor;

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(material_, faces_, incident_, rim_, generation_, revision_);
  }

  std::vector<Vec2> material_;
  std::vector<Face> faces_;
  IndexLists incident_;
  std::vector<std::uint8_t> rim_;  ///< by face: bit k for the edge from corner k
  std::vector<std::uint8_t> generation_;
  std::uint64_t revision_ = 0;
};

/// Faces around `v` grouped by connection across edges at `v`: one group per fan, ordered by the
/// smallest face id in it. A manifold vertex has exactly one.
std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v);
/// The same, where edges {v, w} for which `isWall(w)` holds do not connect.
std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v,
                                            const std::function<bool(VertexId)>& isWall);

/// Rest areas around `v`, summed [m^2].
double areaAround(const TriangleMesh& mesh, VertexId v);

/// Connected pieces by shared edges: a piece number per face, and how many there are.
/// They are numbered by their smallest face id.
struct ConnectedComponents {
  std::int32_t count = 0;
  std::vector<std::int32_t> ofFace;
};
ConnectedComponents connectedComponents(const TriangleMesh& mesh);

/// Empty if `mesh` is a valid oriented 2-manifold with boundary whose tables agree and whose faces
/// have positive rest area; otherwise one sentence that names the first error.
std::string validationError(const TriangleMesh& mesh);

}  // namespace cloth_sim
