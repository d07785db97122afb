#pragma once
/// \file The record of an edit of a mesh. Everything that keeps data about the mesh applies it.

#include <array>
#include <utility>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// One change to the list of vertices.
struct VertexEdit {
  enum class Kind : std::uint8_t {
    kCopy,    ///< appends a copy of from[0]: the surface opened there
    kInsert,  ///< appends the weighted sum of up to three vertices
    kMove,    ///< `id` becomes the weighted sum of up to three vertices, itself possibly included
    kRemove,  ///< removes `id`; the last vertex, from[0], takes its place
  };
  Kind kind = Kind::kCopy;
  VertexId id = kNone;
  std::array<VertexId, 3> from{kNone, kNone, kNone};  ///< kNone behind those that count
  std::array<double, 3> weight{1.0, 0.0, 0.0};        ///< sum to one

  bool isNew() const { return kind == Kind::kCopy || kind == Kind::kInsert; }
};

/// The difference between two revisions of a mesh. Applying it to data of `fromRevision` gives data
/// of `toRevision`.
struct MeshChanges {
  std::uint64_t fromRevision = 0;
  std::uint64_t toRevision = 0;
  std::vector<VertexEdit> vertices;  ///< in the order of the edits
  /// Former material coordinates of moved vertices [m], in the order of the edits.
  std::vector<std::pair<VertexId, Vec2>> movedFrom;
  std::vector<FaceId> changedFaces;   ///< new faces and those with other vertices; ascending
  std::vector<FaceId> reshapedFaces;  ///< new faces and those with another rest shape; ascending
  std::vector<FaceId> removedFaces;   ///< in order; the last face took the place of each
  std::vector<VertexId> touched;      ///< vertices whose incident faces changed; ascending

  bool empty() const { return fromRevision == toRevision; }
};

}  // namespace cloth_sim
