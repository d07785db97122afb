#include "cloth_sim/surgery/refine.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "mesh/quality.h"
#include "nearest_point.h"

namespace cloth_sim {
namespace {

/// Number of samples of a path per radius of its neighbourhood.
constexpr double kSamplesPerRadius = 2.0;
/// Largest length of a path, in radii: samples take memory.
constexpr double kLongest = 1e6;

double pathLength(const std::vector<Vec3>& path) {
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) length += (path[k + 1] - path[k]).norm();
  return length;
}

std::array<Vec3, 3> cornersOf(const Face& face, const VertexData<Vec3>& coordinates) {
  return {coordinates[face[0]], coordinates[face[1]], coordinates[face[2]]};
}

}  // namespace

std::string validationError(const RefineNear& request) {
  const auto finite = [](const Vec3& p) { return p.allFinite(); };
  if (request.path.empty()) return "the path is empty";
  if (!std::all_of(request.path.begin(), request.path.end(), finite)) {
    return "a point is not finite";
  }
  const Refinement& r = request.refinement;
  if (!std::isfinite(r.radius) || r.radius <= 0.0) return "radius: expected a finite number > 0";
  if (!(pathLength(request.path) <= kLongest * r.radius)) {
    return "the path is longer than a million radii";
  }
  if (r.generations < 0 || r.generations > kMostGenerations) {
    return "generations: expected 0 to " + std::to_string(kMostGenerations);
  }
  if (!std::isfinite(r.minEdge) || r.minEdge < 0.0) {
    return "min_edge: expected a finite number >= 0";
  }
  return "";
}

Neighbourhood::Neighbourhood(const std::vector<Vec3>& path, double radius) : radius_(radius) {
  const double spacing = radius / kSamplesPerRadius;
  samples_.push_back(path.front());
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Vec3 d = path[k + 1] - path[k];
    const auto count = static_cast<int>(std::ceil(d.norm() / spacing));
    for (int sample = 1; sample <= count; ++sample) {
      samples_.emplace_back(path[k] + d * (static_cast<double>(sample) / count));
    }
  }
  Eigen::AlignedBox3d box;
  for (const Vec3& p : samples_) box.extend(p);
  box.sizes().maxCoeff(&axis_);
  const int axis = axis_;
  std::stable_sort(samples_.begin(), samples_.end(),
                   [axis](const Vec3& p, const Vec3& q) { return p[axis] < q[axis]; });
}

bool Neighbourhood::reaches(const std::array<Vec3, 3>& triangle) const {
  const auto& [a, b, c] = triangle;
  const double low = std::min({a[axis_], b[axis_], c[axis_]}) - radius_;
  const double high = std::max({a[axis_], b[axis_], c[axis_]}) + radius_;
  const auto from = [&](double value) {
    return std::lower_bound(samples_.begin(), samples_.end(), value,
                            [&](const Vec3& p, double v) { return p[axis_] < v; });
  };
  // A quick test first: most of the near triangles have their centroid near a sample.
  const Vec3 middle = (a + b + c) / 3.0;
  const auto beside = from(middle[axis_]);
  if (beside != samples_.end() && (middle - *beside).squaredNorm() <= radius_ * radius_)
    return true;
  for (auto sample = from(low); sample != samples_.end() && (*sample)[axis_] <= high; ++sample) {
    if ((nearestPoint(triangle, *sample) - *sample).squaredNorm() <= radius_ * radius_) return true;
  }
  return false;
}

namespace {

/// A breadth-first search over faces near a path, which grows with the mesh while it is refined.
class RefinementFront {
 public:
  RefinementFront(const TriangleMesh& mesh, const std::vector<FaceId>& seeds)
      : mesh_(mesh),
        open_(seeds.begin(), seeds.end()),
        seen_(static_cast<std::size_t>(mesh.faceCount()), false) {
    for (FaceId f : seeds) seen_[f] = true;
  }

  bool empty() const { return open_.empty(); }

  FaceId takeNext() {
    const FaceId f = open_.front();
    open_.pop_front();
    return f;
  }

  /// Appends the faces around the corners of `f` that have not been seen.
  void addNeighbours(FaceId f) {
    for (VertexId v : mesh_.face(f)) {
      for (FaceId other : mesh_.facesAround(v)) {
        if (!seen_[other]) open_.push_back(other);
        seen_[other] = true;
      }
    }
  }

  /// Appends the faces around the vertices from `first` on, also those seen before: what bisections
  /// have created may have to be bisected again.
  void addFacesOfNewVertices(VertexId first) {
    seen_.resize(static_cast<std::size_t>(mesh_.faceCount()), false);
    for (VertexId v = first; v < mesh_.vertexCount(); ++v) {
      for (FaceId f : mesh_.facesAround(v)) {
        seen_[f] = true;
        open_.push_back(f);
      }
    }
  }

 private:
  const TriangleMesh& mesh_;
  std::deque<FaceId> open_;
  std::vector<bool> seen_;  ///< by face
};

}  // namespace

void refineNear(const Neighbourhood& near, const Refinement& refinement,
                VertexData<Vec3> coordinates, const std::vector<FaceId>& seeds,
                std::int32_t maxVertices, Remesher& remesher) {
  const TriangleMesh& mesh = remesher.mesh();
  const double minEdge = std::max(refinement.minEdge, remesher.limits().minEdge);
  RefinementFront front(mesh, seeds);
  std::size_t applied = remesher.edits().size();  // edits that the coordinates have
  while (!front.empty() && mesh.vertexCount() <= maxVertices) {
    const FaceId f = front.takeNext();
    if (!near.reaches(cornersOf(mesh.face(f), coordinates))) continue;
    front.addNeighbours(f);
    const bool isFine =
        mesh.generation(f) >= refinement.generations || 0.5 * longestEdge(mesh, f) < minEdge;
    if (isFine) continue;
    const VertexId firstNew = mesh.vertexCount();
    remesher.bisect(f);  // even if it fails, it may have bisected neighbours
    for (; applied < remesher.edits().size(); ++applied) {
      coordinates.apply(remesher.edits()[applied]);
    }
    front.addFacesOfNewVertices(firstNew);
  }
}

}  // namespace cloth_sim
