#include "edge_changes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "cloth_sim/mesh/face_edges.h"
#include "support/simd.h"
#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Edges in a run, at most: threads share the runs.
constexpr std::int32_t kMostInRun = 256;

/// Square of the smaller singular value of a matrix with two columns [m^2].
double leastStretchSquared(const Vec2& first, const Vec2& second) {
  const double sum = first.squaredNorm() + second.squaredNorm();
  const double area = first.x() * second.y() - first.y() * second.x();
  const double root = std::sqrt(std::max(0.0, sum * sum - 4.0 * area * area));
  return sum > 0.0 ? 2.0 * area * area / (sum + root) : 0.0;
}

/// The corner at which the edges of a face are farthest from parallel, and the square of their
/// smaller singular value [m^2].
std::pair<VertexId, double> bestCorner(const TriangleMesh& mesh, const Face& face) {
  std::pair<VertexId, double> best{kNone, -1.0};
  for (int k = 0; k < 3; ++k) {
    const Vec2& at = mesh.material(face[k]);
    const double spread = leastStretchSquared(mesh.material(face[(k + 1) % 3]) - at,
                                              mesh.material(face[(k + 2) % 3]) - at);
    if (spread > best.second) best = {face[k], spread};
  }
  return best;
}

/// Returns the first edge in [k, count) that has changed by more than is allowed, or `count`.
/// \param limit  square of what is allowed, by edge [m^2]; less than 0: nothing.
CLOTH_SIM_VECTOR_CLONES
std::int32_t firstBeyond(const ConstAxes& from, const ConstAxes& to, const double* limit,
                         std::int32_t k, std::int32_t count) {
  for (; k + kLanes <= count; k += kLanes) {
    const Lanes x = lanesAt(to.x + k) - lanesAt(from.x + k);
    const Lanes y = lanesAt(to.y + k) - lanesAt(from.y + k);
    const Lanes z = lanesAt(to.z + k) - lanesAt(from.z + k);
    const auto kept = x * x + y * y + z * z <= lanesAt(limit + k);
    if ((kept[0] & kept[1] & kept[2] & kept[3]) == 0) break;
  }
  for (; k < count; ++k) {
    const double x = to.x[k] - from.x[k];
    const double y = to.y[k] - from.y[k];
    const double z = to.z[k] - from.z[k];
    if (!(x * x + y * y + z * z <= limit[k])) return k;  // also for NaN
  }
  return count;
}

}  // namespace

void EdgeChanges::build(const TriangleMesh& mesh) {
  std::vector<VertexId> corners;  // by face
  spread_.clear();
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const auto [corner, spread] = bestCorner(mesh, mesh.face(f));
    corners.push_back(corner);
    spread_.push_back(spread);
  }
  const FaceEdges sorted = sortEdges(mesh.faces(), static_cast<std::size_t>(mesh.vertexCount()));
  ends_.clear();
  facesOf_.clear();
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    for (std::size_t k = sorted.first[v]; k < sorted.first[v + 1]; ++k) {
      const FaceEdges::Edge& edge = sorted.edges[k];
      if (edge.opposite == corners[edge.face]) continue;
      if (!ends_.empty() && ends_.back() == std::array<VertexId, 2>{v, edge.upper}) {
        facesOf_.back()[1] = edge.face;
      } else {
        ends_.push_back({v, edge.upper});
        facesOf_.push_back({edge.face, kNone});
      }
    }
  }
  limit_.resize(ends_.size());
}

void EdgeChanges::follow(const std::vector<std::int32_t>& slots) {
  using Entry = std::tuple<std::int32_t, std::int32_t, std::int32_t>;  // shift, slot, edge
  std::vector<Entry> order;
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    const std::int32_t from = slots[ends_[e][0]];
    order.emplace_back(slots[ends_[e][1]] - from, from, static_cast<std::int32_t>(e));
  }
  std::sort(order.begin(), order.end());
  const auto ends = ends_;
  const auto faces = facesOf_;
  edgesOf_.assign(spread_.size(), {kNone, kNone});
  runs_.clear();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto [shift, from, edge] = order[k];
    ends_[k] = ends[edge];
    facesOf_[k] = faces[edge];
    for (const FaceId f : facesOf_[k]) {
      if (f == kNone) continue;
      edgesOf_[f][edgesOf_[f][0] == kNone ? 0 : 1] = static_cast<std::int32_t>(k);
    }
    const bool isNext = !runs_.empty() && runs_.back().count < kMostInRun &&
                        runs_.back().from + runs_.back().count == from &&
                        runs_.back().to + runs_.back().count == from + shift;
    if (!isNext) runs_.push_back({from, from + shift, static_cast<std::int32_t>(k), 0});
    ++runs_.back().count;
  }
}

void EdgeChanges::allow(const std::vector<GradientBall>& gradients) {
  const auto allowedBy = [&](FaceId f) {
    return 0.5 * gradients[f].radius * gradients[f].radius * spread_[f];
  };
  constexpr std::int32_t kGrain = 4096;
  parallelForEach(ends_.size(), kGrain, [&](std::int32_t e) {
    limit_[e] = allowedBy(facesOf_[e][0]);
    if (facesOf_[e][1] != kNone) limit_[e] = std::min(limit_[e], allowedBy(facesOf_[e][1]));
  });
}

void EdgeChanges::distrust(FaceId f) {
  for (const std::int32_t e : edgesOf_[f]) limit_[e] = -1.0;
}

std::int32_t EdgeChanges::firstChanged(const VectorArray& moved, const Run& run,
                                       std::int32_t k) const {
  return firstBeyond(axesAt(moved, run.from), axesAt(moved, run.to), limit_.data() + run.first, k,
                     run.count);
}

}  // namespace cloth_sim
