#include "tip_joint.h"

#include <algorithm>
#include <deque>
#include <set>

#include "cloth_sim/surgery/material_path.h"
#include "nearest_point.h"
#include "tear_line.h"

namespace cloth_sim {
namespace {

/// Distance up to which points count as one, and a point as on an edge [m].
constexpr double kOnePoint = 1e-9;

/// Returns the distance of a point from a face in the material [m].
double distanceToFace(const TriangleMesh& mesh, FaceId f, const Vec2& p) {
  std::array<Vec3, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) corner[k] = inMaterialPlane(mesh.material(mesh.face(f)[k]));
  const Vec3 at = inMaterialPlane(p);
  return (nearestPoint(corner, at) - at).norm();
}

/// Returns whether a point is on the border of its face.
bool isOnBorder(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Face& face = mesh.face(point.face);
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexId v = face[k];
    const VertexId w = face[(k + 1) % 3];
    if (mesh.facesOnEdge(v, w)[1] != kNone) continue;
    if (distanceTo({mesh.material(v), mesh.material(w)}, point.material) <= kOnePoint) return true;
  }
  return false;
}

/// Returns the nearest vertex that is wanted, over faces within `reach` of a point of the cloth
/// [m]; kNone if there is none. Of equally near ones it is the first.
template <typename IsWanted>
VertexId nearestVertex(const TriangleMesh& mesh, const SurfacePoint& point, double reach,
                       const IsWanted& isWanted) {
  VertexId nearest = kNone;
  double least = reach;
  std::set<FaceId> seen{point.face};
  for (std::deque<FaceId> open{point.face}; !open.empty(); open.pop_front()) {
    const Face& face = mesh.face(open.front());
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = face[k];
      const double distance = (mesh.material(v) - point.material).norm();
      const bool isNearer = distance < least || (distance == least && v < nearest) ||
                            (distance <= least && nearest == kNone);
      if (isNearer && isWanted(v)) {
        nearest = v;
        least = distance;
      }
      for (const FaceId other : mesh.facesOnEdge(v, face[(k + 1) % 3])) {
        if (other == kNone || distanceToFace(mesh, other, point.material) > reach) continue;
        if (seen.insert(other).second) open.push_back(other);
      }
    }
  }
  return nearest;
}

/// Returns the tip that the first point of a path joins; without one, the end of the cut that it
/// continues, which is no tip where that cut bent to the border. kNone if there is neither.
VertexId tipAtBegin(const TriangleMesh& mesh, const JoinedTips& tips, const SurfacePath& path) {
  const auto isATip = [&](VertexId v) { return isTip(mesh, v); };
  const auto isKnown = [&](VertexId v) {
    return std::any_of(tips.known.begin(), tips.known.end(), [&](const Vec2& known) {
      return (known - mesh.material(v)).norm() <= kOnePoint;
    });
  };
  const auto isKnownTip = [&](VertexId v) { return isKnown(v) && isTip(mesh, v); };
  const SurfacePoint& begin = path.points.front();
  VertexId tip = kNone;
  if (!tips.known.empty()) tip = nearestVertex(mesh, begin, tips.knownReach, isKnownTip);
  if (tip == kNone) tip = nearestVertex(mesh, begin, tips.reach, isATip);
  if (tip == kNone && !tips.known.empty()) tip = nearestVertex(mesh, begin, tips.reach, isKnown);
  return tip;
}

/// Lets a path begin at a tip instead of its first point, and drops its points that are not farther
/// from the tip than that; all of them if it does not lead on from the tip. A path that begins on
/// the border, at the tip or on a lip behind it, is joined already.
void startAt(VertexId tip, const TriangleMesh& mesh, SurfacePath& path) {
  if (isOnBorder(mesh, path.points.front())) return;
  const Vec2& at = mesh.material(tip);
  std::vector<SurfacePoint>& points = path.points;
  const double off = (points.front().material - at).norm();
  auto kept = std::find_if(points.begin(), points.end(), [&](const SurfacePoint& point) {
    return (point.material - at).norm() > off + kOnePoint;
  });
  if (kept == points.end() &&
      directionAhead(mesh, tip).dot(points.back().material - at) > kOnePoint) {
    --kept;
  }
  points.erase(points.begin(), kept);
  if (!points.empty()) points.insert(points.begin(), {mesh.facesAround(tip).front(), at});
}

void joinTips(const TriangleMesh& mesh, const JoinedTips& tips, SurfacePath& path) {
  if (path.isClosed()) return;
  const VertexId first = tipAtBegin(mesh, tips, path);
  if (first != kNone) startAt(first, mesh, path);
  if (path.points.empty()) return;
  const VertexId last = nearestVertex(mesh, path.points.back(), tips.reach, [&](VertexId v) {
    if (!isTip(mesh, v)) return false;
    return first == kNone || (mesh.material(v) - mesh.material(first)).norm() > tips.reach;
  });
  if (last == kNone) return;
  std::reverse(path.points.begin(), path.points.end());
  startAt(last, mesh, path);
  std::reverse(path.points.begin(), path.points.end());
}

}  // namespace

void joinTips(const TriangleMesh& mesh, const JoinedTips& tips, std::vector<SurfacePath>& paths) {
  for (SurfacePath& path : paths) joinTips(mesh, tips, path);
  const auto isDropped = [](const SurfacePath& path) { return path.points.empty(); };
  paths.erase(std::remove_if(paths.begin(), paths.end(), isDropped), paths.end());
}

}  // namespace cloth_sim
