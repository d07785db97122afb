#include "cloth_sim/surgery/stroke.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stroke_segments.h"

namespace cloth_sim {
namespace {

/// Farthest point of a stroke from the origin along an axis [m]: volumes of its points are finite.
constexpr double kFarthest = 1e6;

bool isWithinReach(const Vec3& p) { return p.cwiseAbs().maxCoeff() <= kFarthest; }

}  // namespace

Stroke strokeAlong(const std::vector<Vec3>& path, const Vec3& direction, double reach) {
  const Vec3 arm = reach * direction.normalized();
  Stroke stroke;
  stroke.poses.reserve(path.size());
  for (const Vec3& p : path) stroke.poses.push_back({p - arm, p + arm});
  return stroke;
}

std::string validationError(const Stroke& stroke) {
  const std::vector<Blade>& poses = stroke.poses;
  if (poses.size() < 2) return "the stroke needs at least two poses of the blade";
  const Blade& first = poses.front();
  bool moves = false;
  for (const Blade& pose : poses) {
    if (!pose.heel.allFinite() || !pose.tip.allFinite()) {
      return "the stroke's poses: expected finite numbers";
    }
    if (!isWithinReach(pose.heel) || !isWithinReach(pose.tip)) {
      return "the stroke's poses: expected coordinates of at most 1e6 m";
    }
    if (!((pose.tip - pose.heel).norm() > 0.0)) return "the blade needs a length";
    moves = moves || pose.heel != first.heel || pose.tip != first.tip;
  }
  if (!moves) return "the stroke needs at least two different poses of the blade";
  if (!(stroke.halfWidth >= 0.0) || stroke.halfWidth > kFarthest) {
    return "the stroke's half-width: expected a number from 0 to 1e6 m";
  }
  return "";
}

std::vector<SurfacePath> findPaths(const Stroke& stroke, const TriangleMesh& mesh,
                                   const VertexData<Vec3>& positions) {
  const std::string error = validationError(stroke);
  if (!error.empty()) throw std::invalid_argument(error);
  if (positions.size() != static_cast<std::size_t>(mesh.vertexCount())) {
    throw std::invalid_argument("the cloth needs one position per vertex");
  }
  const SweptSurface surface = makeSweptSurface(stroke);
  std::vector<Polyline> polylines = joinSegments(crossFaces(surface, mesh, positions), mesh);
  if (stroke.firstLayerOnly) polylines = lowerEnvelope(polylines);
  return toPaths(std::move(polylines), surface.tolerance);
}

}  // namespace cloth_sim
