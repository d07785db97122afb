#pragma once
/// \file What one edit of a mesh did, as a value: consumers follow it, logs print it, tests assert
/// on it.

#include <array>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A vertex that an edit made. Data on it is the weighted sum of the data on `from`.
struct NewVertex {
  VertexId id = kNone;
  std::array<VertexId, 2> from{kNone, kNone};  ///< second is kNone for a copy
  std::array<double, 2> weight{1.0, 0.0};      ///< sums to one
};

/// The difference between two revisions of a mesh. Applying it to anything that was up to date at
/// `fromRevision` brings that thing to `toRevision`.
struct MeshChanges {
  std::uint64_t fromRevision = 0;
  std::uint64_t toRevision = 0;
  std::vector<NewVertex> newVertices;  ///< in order of their ids
  std::vector<FaceId> changedFaces;    ///< faces whose vertices were renamed, ascending, unique
  std::vector<VertexId> touched;  ///< vertices whose surrounding faces changed, ascending, unique

  bool empty() const { return fromRevision == toRevision; }
};

}  // namespace cloth_sim
