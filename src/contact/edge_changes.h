#pragma once
/// \file A quick check that gradients of faces have hardly turned: by how much their edges change.

#include <array>
#include <vector>

#include "linalg/vector_array.h"
#include "material_tree.h"

namespace cloth_sim {

/// Two edges of each face, and how much these may change until its gradient might leave its ball.
///
/// With E and R the two edges of a face in the world and at rest, as columns, the gradient is
/// E R^-1. So its change is at most that of E over the smaller singular value of R (both in the
/// Frobenius norm), and stays below r if neither edge changes by more than r sigma / sqrt(2).
///
/// Edges are sorted into runs whose ends lie in consecutive slots, so that kernels load them
/// without gathers. On a grid there are some hundred edges in a run.
class EdgeChanges {
 public:
  /// Follows the mesh.
  void build(const TriangleMesh& mesh);
  /// Says where the vertices are. \param slots  by vertex.
  void follow(const std::vector<std::int32_t>& slots);
  /// Allows the changes that keep the gradients of all faces in balls around those that they have
  /// now. \param gradients  by face.
  void allow(const std::vector<GradientBall>& gradients);
  /// From now on, the edges of a face count as changed.
  void distrust(FaceId f);

  std::int32_t runCount() const { return static_cast<std::int32_t>(runs_.size()); }
  /// Calls `visit(face)` for the faces at edges that have changed by more than is allowed, and for
  /// some others; for some twice. Ends when that returns false, and returns then false as well.
  /// \param moved              motion of the ends since, by slot [m].
  /// \param firstRun, lastRun  runs in [first, last) are looked at.
  template <typename Visit>
  bool visitChanged(const VectorArray& moved, std::int32_t firstRun, std::int32_t lastRun,
                    const Visit& visit) const {
    for (std::int32_t r = firstRun; r < lastRun; ++r) {
      const Run& run = runs_[r];
      for (std::int32_t k = 0; (k = firstChanged(moved, run, k)) < run.count; ++k) {
        for (const FaceId f : facesOf_[run.first + k]) {
          if (f != kNone && !visit(f)) return false;
        }
      }
    }
    return true;
  }

 private:
  /// Edges from slot `from + k` to slot `to + k`, for k in [0, count).
  struct Run {
    std::int32_t from = 0;
    std::int32_t to = 0;
    std::int32_t first = 0;  ///< edge
    std::int32_t count = 0;
  };

  std::int32_t firstChanged(const VectorArray& moved, const Run& run, std::int32_t k) const;

  std::vector<std::array<VertexId, 2>> ends_;   ///< by edge
  std::vector<std::array<FaceId, 2>> facesOf_;  ///< by edge; kNone for one face
  std::vector<double> limit_;                   ///< square of the allowed change, by edge [m^2]
  std::vector<std::array<std::int32_t, 2>> edgesOf_;  ///< by face
  std::vector<double> spread_;                        ///< sigma^2, by face [m^2]
  std::vector<Run> runs_;
};

}  // namespace cloth_sim
