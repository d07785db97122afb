#pragma once
/// \file What one edit of a mesh did, as a value: consumers follow it, logs print it, tests assert
/// on it.

#include <array>
#include <utility>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// One edit of the list of vertices.
struct VertexEdit {
  enum class Kind : std::uint8_t {
    kCopy,    ///< a new last vertex, equal to from[0]: the surface opened there
    kInsert,  ///< a new last vertex: the weighted sum of up to three others
    kMove,    ///< `id` becomes the weighted sum of up to three vertices, itself perhaps among them
    kRemove,  ///< `id` goes; the last vertex, from[0], takes its place
  };
  Kind kind = Kind::kCopy;
  VertexId id = kNone;
  std::array<VertexId, 3> from{kNone, kNone, kNone};  ///< those that count come first
  std::array<double, 3> weight{1.0, 0.0, 0.0};        ///< sums to one

  bool isNew() const { return kind == Kind::kCopy || kind == Kind::kInsert; }
};

/// The difference between two revisions of a mesh. Applying it to anything that was up to date at
/// `fromRevision` brings that thing to `toRevision`.
struct MeshChanges {
  std::uint64_t fromRevision = 0;
  std::uint64_t toRevision = 0;
  std::vector<VertexEdit> vertices;  ///< in the order of the edits
  /// Where vertices were that moved, in the order of the edits: material coordinates [m].
  std::vector<std::pair<VertexId, Vec2>> movedFrom;
  std::vector<FaceId> changedFaces;   ///< new, or with other vertices than before; ascending
  std::vector<FaceId> reshapedFaces;  ///< new, or with another shape at rest; ascending, unique
  std::vector<FaceId> removedFaces;   ///< in order; the last face took the place of each
  std::vector<VertexId> touched;  ///< vertices whose surrounding faces changed, ascending, unique

  bool empty() const { return fromRevision == toRevision; }
};

}  // namespace cloth_sim
