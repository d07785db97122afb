#include "cloth_sim/surgery/refine.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Samples of a path per radius.
constexpr double kSamplesPerRadius = 2.0;

Vec3 nearestOnSegment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 d = b - a;
  const double squared = d.squaredNorm();
  if (squared == 0.0) return a;
  return a + std::clamp(d.dot(p - a) / squared, 0.0, 1.0) * d;
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
  if (r.generations < 0 || r.generations > kMostGenerations) {
    return "generations: expected 0 to " + std::to_string(kMostGenerations);
  }
  if (!std::isfinite(r.minEdge) || r.minEdge < 0.0) {
    return "min_edge: expected a finite number >= 0";
  }
  return "";
}

Vec3 nearestPoint(const std::array<Vec3, 3>& triangle, const Vec3& p) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  const bool inside = squared > 0.0 && (b - a).cross(p - a).dot(normal) >= 0.0 &&
                      (c - b).cross(p - b).dot(normal) >= 0.0 &&
                      (a - c).cross(p - c).dot(normal) >= 0.0;
  if (inside) return p - normal * (normal.dot(p - a) / squared);
  Vec3 best = nearestOnSegment(a, b, p);
  for (const Vec3& other : {nearestOnSegment(b, c, p), nearestOnSegment(c, a, p)}) {
    if ((other - p).squaredNorm() < (best - p).squaredNorm()) best = other;
  }
  return best;
}

Neighbourhood::Neighbourhood(const std::vector<Vec3>& path, double radius) : radius_(radius) {
  const double spacing = radius / kSamplesPerRadius;
  samples_.push_back(path.front());
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Vec3 d = path[k + 1] - path[k];
    const auto pieces = static_cast<int>(std::ceil(d.norm() / spacing));
    for (int piece = 1; piece <= pieces; ++piece) {
      samples_.emplace_back(path[k] + d * (static_cast<double>(piece) / pieces));
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
  // Most triangles that are near are near by their middle.
  const Vec3 middle = (a + b + c) / 3.0;
  const auto beside = from(middle[axis_]);
  if (beside != samples_.end() && (middle - *beside).squaredNorm() <= radius_ * radius_)
    return true;
  for (auto sample = from(low); sample != samples_.end() && (*sample)[axis_] <= high; ++sample) {
    if ((nearestPoint(triangle, *sample) - *sample).squaredNorm() <= radius_ * radius_) return true;
  }
  return false;
}

void refineNear(const Neighbourhood& near, const Refinement& refinement,
                VertexData<Vec3> coordinates, const std::vector<FaceId>& seeds,
                std::int32_t maxVertices, Remesher& remesher) {
  const TriangleMesh& mesh = remesher.mesh();
  const double minEdge = std::max(refinement.minEdge, remesher.limits().minEdge);
  std::deque<FaceId> open(seeds.begin(), seeds.end());
  std::vector<bool> seen(static_cast<std::size_t>(mesh.faceCount()), false);
  for (FaceId f : seeds) seen[f] = true;
  std::size_t edits = remesher.edits().size();  // that the coordinates know
  const auto look = [&](FaceId f) {
    if (!seen[f]) open.push_back(f);
    seen[f] = true;
  };
  while (!open.empty() && mesh.vertexCount() <= maxVertices) {
    const FaceId f = open.front();
    open.pop_front();
    if (!near.reaches(cornersOf(mesh.face(f), coordinates))) continue;
    for (VertexId v : mesh.face(f)) {
      for (FaceId other : mesh.facesAround(v)) look(other);
    }
    const bool fine =
        mesh.generation(f) >= refinement.generations || 0.5 * longestEdge(mesh, f) < minEdge;
    if (fine) continue;
    // Even one that is refused may have halved others on its way.
    const VertexId known = mesh.vertexCount();
    remesher.bisect(f);
    for (; edits < remesher.edits().size(); ++edits) coordinates.apply(remesher.edits()[edits]);
    seen.resize(static_cast<std::size_t>(mesh.faceCount()), false);
    // What a bisection made may have to be halved again.
    for (VertexId v = known; v < mesh.vertexCount(); ++v) {
      for (FaceId part : mesh.facesAround(v)) {
        seen[part] = true;
        open.push_back(part);
      }
    }
  }
}

}  // namespace cloth_sim
