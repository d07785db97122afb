#pragma once
/// \file Oriented triangle meshes with material coordinates.

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "cloth_sim/mesh/index_lists.h"
#include "cloth_sim/types.h"

namespace cloth_sim {

/// The corners of a triangle, counter-clockwise in material coordinates.
using Face = std::array<VertexId, 3>;

/// Tells whether `v` is a corner of a face.
inline bool contains(const Face& face, VertexId v) {
  return face[0] == v || face[1] == v || face[2] == v;
}
/// Tells whether two faces have a common corner.
inline bool haveCommonCorner(const Face& a, const Face& b) {
  return contains(a, b[0]) || contains(a, b[1]) || contains(a, b[2]);
}

/// An oriented 2-manifold with boundary: triangles, and the faces around each vertex.
///
/// Only `MeshEditor` changes a mesh after construction; every finished edit increments
/// `revision()`. Edges are not stored: at about six faces per vertex, a search through the faces
/// around one end is as fast as a map, and there is nothing to keep up to date.
class TriangleMesh {
 public:
  TriangleMesh() = default;

  /// \param material  material coordinates (u, v), (vertexCount,) [m]; warp runs along u, weft
  ///                  along v.
  /// \param faces     corners, (faceCount,), counter-clockwise in material coordinates.
  /// \throws std::invalid_argument if the result is not a valid oriented manifold.
  TriangleMesh(std::vector<Vec2> material, std::vector<Face> faces);

  std::int32_t vertexCount() const { return static_cast<std::int32_t>(material_.size()); }
  std::int32_t faceCount() const { return static_cast<std::int32_t>(faces_.size()); }
  std::uint64_t revision() const { return revision_; }

  const std::vector<Face>& faces() const { return faces_; }
  const Face& face(FaceId f) const { return faces_[f]; }
  const std::vector<Vec2>& material() const { return material_; }
  const Vec2& material(VertexId v) const { return material_[v]; }

  /// Faces around `v`, ascending; valid until the mesh is edited.
  IndexSpan facesAround(VertexId v) const { return incident_[v]; }
  /// The faces on the edge {a, b}: two, or one and kNone on the border; {kNone, kNone} if there is
  /// no such edge.
  std::array<FaceId, 2> facesOnEdge(VertexId a, VertexId b) const;
  /// The corner of `f` that is neither `a` nor `b`.
  VertexId oppositeVertex(FaceId f, VertexId a, VertexId b) const;
  /// Vertices joined to `v` by an edge, ascending.
  std::vector<VertexId> neighbours(VertexId v) const;
  /// Same, written to `out` to reuse its memory.
  void neighbours(VertexId v, std::vector<VertexId>& out) const;
  /// Tells whether `v` is on the border of the mesh.
  bool isBoundary(VertexId v) const;
  /// Tells whether the edge from corner k of `f` to the next corner belongs to the border of the
  /// undamaged mesh. Other border edges are where cuts and tears opened the surface.
  bool isOriginalBoundary(FaceId f, int k) const { return ((boundaryBits_[f] >> k) & 1U) != 0; }
  /// Number of bisections between a face of the original mesh and `f`.
  int generation(FaceId f) const { return generation_[f]; }

  /// Tells whether the tables of faces and vertices have an entry for each, and list each face at
  /// its corners, so that no index leads astray. For meshes that were read from a file.
  bool hasCompleteTables() const;

  /// Rest area of a face, in material coordinates [m^2].
  double restArea(FaceId f) const;
  /// Sum of all rest areas [m^2].
  double totalRestArea() const;

 private:
  friend class MeshEditor;

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(material_, faces_, incident_, boundaryBits_, generation_, revision_);
  }

  void listIncidentFaces();

  std::vector<Vec2> material_;
  std::vector<Face> faces_;
  IndexLists incident_;                     ///< faces around each vertex, ascending
  std::vector<std::uint8_t> boundaryBits_;  ///< by face: bit k is `isOriginalBoundary` of edge k
  std::vector<std::uint8_t> generation_;    ///< by face
  std::uint64_t revision_ = 0;
};

/// Groups the faces around `v` into fans: sets of faces that are connected across edges at `v`. A
/// manifold vertex has exactly one fan.
/// \return ascending faces of each fan; fans are ordered by their smallest face.
std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v);
/// Same, where edges {v, w} with `isCut(w)` do not connect their faces.
std::vector<std::vector<FaceId>> fansAround(const TriangleMesh& mesh, VertexId v,
                                            const std::function<bool(VertexId)>& isCut);

/// Returns the sum of the rest areas of the faces around `v` [m^2].
double areaAround(const TriangleMesh& mesh, VertexId v);

/// The connected components of a mesh, numbered in the order of their smallest faces.
struct ConnectedComponents {
  std::int32_t count = 0;
  std::vector<std::int32_t> ofFace;  ///< number of the component of each face, (faceCount,)
};
ConnectedComponents connectedComponents(const TriangleMesh& mesh);

/// Checks that a mesh is an oriented 2-manifold with boundary, that its tables agree, and that its
/// faces have positive rest area.
/// \return one sentence about the first error; empty if there is none.
std::string validationError(const TriangleMesh& mesh);

}  // namespace cloth_sim
