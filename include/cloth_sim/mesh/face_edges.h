#pragma once
/// \file The edges of the faces of a mesh, sorted by their vertices.

#include <array>
#include <cstddef>
#include <vector>

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// The edges of all faces, in the order of their lower vertices, their upper vertices and their
/// faces. An edge of two faces is listed twice, one after the other.
struct FaceEdges {
  struct Edge {
    VertexId upper = kNone;     ///< its end with the higher number
    VertexId opposite = kNone;  ///< the third vertex of the face
    FaceId face = kNone;
  };

  /// (vertices + 1): the edges with the lower vertex v are edges[first[v]] to
  /// edges[first[v + 1] - 1].
  std::vector<std::size_t> first;
  std::vector<Edge> edges;  ///< (3 * faces)
};

/// Sorts the edges of all faces.
/// \param vertices  number of vertices; larger than any number in `faces`.
FaceEdges sortEdges(const std::vector<Face>& faces, std::size_t vertices);

/// Returns the lower and the upper vertex of each edge that has one face only, in that order.
std::vector<std::array<VertexId, 2>> borderEdges(const FaceEdges& sorted);

}  // namespace cloth_sim
