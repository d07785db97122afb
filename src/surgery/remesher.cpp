#include "cloth_sim/surgery/remesher.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Faces with an angle below this are candidates for a flip [rad].
constexpr double kPoorAngle = 0.35;
/// Smallest increase of the smallest angle for which an edge is flipped [rad].
constexpr double kMinGain = 0.02;
/// Passes over the faces that the last pass flipped.
constexpr int kImprovePasses = 4;
/// Distance from a line up to which a point counts as on it [m].
constexpr double kOnBorder = 1e-14;
/// Relative difference up to which edges count as equally long.
constexpr double kSameLength = 1e-9;
/// Number of faces on a longest-edge propagation path from which on bisection gives up.
constexpr int kLongestPath = 64;

/// Returns the distance of p from the line through a and b [m], or from a if they coincide.
double distanceToLine(const Vec2& a, const Vec2& b, const Vec2& p) {
  const double length = (b - a).norm();
  return length > 0.0 ? std::abs(doubleArea(a, b, p)) / length : (p - a).norm();
}

/// Where the point of a segment that is nearest to `at` divides it, inside it.
double partAlong(const Vec2& a, const Vec2& b, const Vec2& at) {
  const Vec2 d = b - a;
  return std::clamp(d.dot(at - a) / d.squaredNorm(), 1e-6, 1.0 - 1e-6);
}

}  // namespace

std::array<double, 3> barycentric(const TriangleMesh& mesh, FaceId f, const Vec2& p) {
  const Face& face = mesh.face(f);
  const Vec2& a = mesh.material(face[0]);
  const Vec2& b = mesh.material(face[1]);
  const Vec2& c = mesh.material(face[2]);
  const double whole = doubleArea(a, b, c);
  const double wa = doubleArea(b, c, p) / whole;
  const double wb = doubleArea(c, a, p) / whole;
  return {wa, wb, 1.0 - wa - wb};
}

Remesher::Remesher(TriangleMesh& mesh, const ShapeLimits& limits, const std::vector<VertexId>& held)
    : editor_(mesh), limits_(limits), held_(held.begin(), held.end()) {}

void Remesher::mark(VertexId a, VertexId b) {
  marks_.insert(edgeKey(a, b));
  marked_.insert({a, b});
}

bool Remesher::isTooShort(const Vec2& a, const Vec2& b) const {
  return (b - a).squaredNorm() < limits_.minEdge * limits_.minEdge;
}

double Remesher::angleIfSplit(VertexId a, VertexId b, const Vec2& wanted) const {
  const Vec2& pa = mesh().material(a);
  const Vec2& pb = mesh().material(b);
  const Vec2 at = limits_.keepsSurface ? Vec2(pa + partAlong(pa, pb, wanted) * (pb - pa)) : wanted;
  if (isTooShort(pa, at) || isTooShort(at, pb)) return -1.0;
  double smallest = M_PI;
  for (FaceId f : mesh().facesOnEdge(a, b)) {
    if (f == kNone) continue;
    const VertexId apex = mesh().oppositeVertex(f, a, b);
    const Vec2& pc = mesh().material(apex);
    if (isTooShort(at, pc)) return -1.0;
    const double sign = doubleArea(pa, pb, pc) > 0.0 ? 1.0 : -1.0;
    const double first = sign > 0.0 ? minAngle(pa, at, pc) : minAngle(at, pa, pc);
    const double second = sign > 0.0 ? minAngle(at, pb, pc) : minAngle(pb, at, pc);
    smallest = std::min({smallest, first, second});
  }
  return allowed(smallest);
}

VertexId Remesher::splitEdge(VertexId a, VertexId b, const Vec2& at) {
  const Vec2 pa = mesh().material(a);
  const Vec2 d = mesh().material(b) - pa;
  const double t = partAlong(pa, pa + d, at);
  const VertexId middle = editor_.splitEdge(a, b, t);
  if (isMarked(a, b)) {
    marks_.erase(edgeKey(a, b));
    mark(a, middle);
    mark(middle, b);
  }
  if (held_.count(a) != 0 && held_.count(b) != 0) hold(middle);
  // The split is on the edge. If the point is beside it, move the vertex there; on the border it
  // stays on the edge.
  const bool inside = mesh().facesAround(middle).size() == 4 && !limits_.keepsSurface;
  if (inside && distanceToLine(pa, pa + d, at) > kOnBorder) moveVertex(middle, at);
  return middle;
}

/// Returns whether `v` may move to a point: it is neither held nor on a marked edge and, if it is
/// on the border, the point is on the lines of its border edges.
bool Remesher::mayMove(VertexId v, const Vec2& to) const {
  if (limits_.keepsSurface || held_.count(v) != 0 || marked_.count(v) != 0) return false;
  const std::vector<VertexId> around = mesh().neighbours(v);
  if (around.size() == mesh().facesAround(v).size()) return true;
  const double tolerance = kOnBorder * std::max(1.0, to.cwiseAbs().maxCoeff());
  const auto isStraight = [&](VertexId w) {
    if (mesh().facesOnEdge(v, w)[1] != kNone) return true;
    const Vec2& from = mesh().material(w);
    return distanceToLine(from, mesh().material(v), to) <= tolerance;
  };
  return std::all_of(around.begin(), around.end(), isStraight);
}

double Remesher::angleIfMoved(VertexId v, const Vec2& to) const {
  if (!mayMove(v, to)) return -1.0;
  double smallest = M_PI;
  for (FaceId f : mesh().facesAround(v)) {
    std::array<Vec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId w = mesh().face(f)[k];
      corner[k] = w == v ? to : mesh().material(w);
      if (w != v && isTooShort(to, corner[k])) return -1.0;
    }
    smallest = std::min(smallest, minAngle(corner[0], corner[1], corner[2]));
  }
  return allowed(smallest);
}

void Remesher::moveVertex(VertexId v, const Vec2& to) {
  // Find the face around v that contains the point, or else the nearest one.
  FaceId in = kNone;
  double best = 0.0;
  for (FaceId f : mesh().facesAround(v)) {
    const std::array<double, 3> weight = barycentric(mesh(), f, to);
    const double inside = *std::min_element(weight.begin(), weight.end());
    if (in == kNone || inside > best) {
      in = f;
      best = inside;
    }
  }
  editor_.moveVertex(v, in, barycentric(mesh(), in, to));
}

double Remesher::angleIfSplit(FaceId f, const Vec2& at) const {
  const Face& face = mesh().face(f);
  double smallest = M_PI;
  for (int k = 0; k < 3; ++k) {
    const Vec2& a = mesh().material(face[k]);
    const Vec2& b = mesh().material(face[(k + 1) % 3]);
    if (isTooShort(a, at)) return -1.0;
    smallest = std::min(smallest, minAngle(a, b, at));
  }
  return allowed(smallest);
}

VertexId Remesher::splitFace(FaceId f, const Vec2& at) {
  const Face face = mesh().face(f);
  const VertexId middle = editor_.splitFace(f, barycentric(mesh(), f, at));
  if (held_.count(face[0]) != 0 && held_.count(face[1]) != 0 && held_.count(face[2]) != 0) {
    hold(middle);
  }
  return middle;
}

/// Returns the longest edge of a face. Of equally long ones it is the first in the order of their
/// keys, so that both faces on an edge agree.
EdgeKey Remesher::longestEdge(FaceId f) const {
  const Face& face = mesh().face(f);
  EdgeKey longest{kNone, kNone};
  double squared = 0.0;
  for (int k = 0; k < 3; ++k) {
    const EdgeKey edge = edgeKey(face[k], face[(k + 1) % 3]);
    const double now = (mesh().material(edge[1]) - mesh().material(edge[0])).squaredNorm();
    const bool longer = now > squared * (1.0 + kSameLength);
    const bool asLong = now >= squared * (1.0 - kSameLength) && edge < longest;
    if (longer || asLong) {
      longest = edge;
      squared = now;
    }
  }
  return longest;
}

bool Remesher::bisect(FaceId f) {
  std::vector<FaceId> path{f};  // of faces with longer and longer edges
  while (!path.empty()) {
    if (path.size() > kLongestPath) return false;
    const EdgeKey edge = longestEdge(path.back());
    const auto on = mesh().facesOnEdge(edge[0], edge[1]);
    const FaceId other = on[0] == path.back() ? on[1] : on[0];
    const auto lengthOf = [&](const EdgeKey& e) {
      return (mesh().material(e[1]) - mesh().material(e[0])).norm();
    };
    if (other != kNone && lengthOf(longestEdge(other)) > lengthOf(edge) * (1.0 + kSameLength)) {
      path.push_back(other);
      continue;
    }
    const Vec2 middle = 0.5 * (mesh().material(edge[0]) + mesh().material(edge[1]));
    if (angleIfSplit(edge[0], edge[1], middle) < 0.0) return false;
    const VertexId v = splitEdge(edge[0], edge[1], middle);
    for (FaceId half : mesh().facesAround(v)) editor_.raiseGeneration(half);
    path.pop_back();
  }
  return true;
}

double Remesher::angleIfFlipped(VertexId a, VertexId b) const {
  const auto [f, g] = mesh().facesOnEdge(a, b);
  if (g == kNone || isMarked(a, b)) return -1.0;
  const VertexId c = mesh().oppositeVertex(f, a, b);
  const VertexId d = mesh().oppositeVertex(g, a, b);
  if (mesh().facesOnEdge(c, d)[0] != kNone) return -1.0;
  const Vec2& pa = mesh().material(a);
  const Vec2& pb = mesh().material(b);
  const Vec2& pc = mesh().material(c);
  const Vec2& pd = mesh().material(d);
  if (isTooShort(pc, pd)) return -1.0;
  // The orientation of the faces decides whether c is to the left of a-b.
  const bool left = doubleArea(pa, pb, pc) > 0.0;
  const double first = left ? minAngle(pa, pd, pc) : minAngle(pa, pc, pd);
  const double second = left ? minAngle(pd, pb, pc) : minAngle(pc, pb, pd);
  return std::min(first, second);
}

/// Flips the edge of a poor face for which the smallest angle increases most, if any.
/// \param flipped  receives the two faces.
bool Remesher::improveFace(FaceId f, std::vector<FaceId>& flipped) {
  if (minAngle(mesh(), f) >= kPoorAngle) return false;
  const Face face = mesh().face(f);
  EdgeKey best{kNone, kNone};
  double gain = kMinGain;
  for (int k = 0; k < 3; ++k) {
    const EdgeKey edge = edgeKey(face[k], face[(k + 1) % 3]);
    const auto on = mesh().facesOnEdge(edge[0], edge[1]);
    if (on[1] == kNone) continue;
    const double now = std::min(minAngle(mesh(), on[0]), minAngle(mesh(), on[1]));
    const double then = angleIfFlipped(edge[0], edge[1]) - now;
    if (then > gain) {
      best = edge;
      gain = then;
    }
  }
  if (best[0] == kNone) return false;
  const auto on = mesh().facesOnEdge(best[0], best[1]);
  flipped.insert(flipped.end(), {on[0], on[1]});
  editor_.flipEdge(best[0], best[1]);
  return true;
}

void Remesher::improveAngles() {
  if (limits_.keepsSurface) return;
  std::vector<FaceId> faces = editor_.reshaped();
  for (int pass = 0; pass < kImprovePasses && !faces.empty(); ++pass) {
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    std::vector<FaceId> flipped;
    for (FaceId f : faces) improveFace(f, flipped);
    faces = std::move(flipped);
  }
}

void Remesher::openMarkedEdges() {
  // Openings copy vertices; marks refer to the originals.
  std::map<VertexId, VertexId> originals;
  const auto originalOf = [&originals](VertexId v) {
    const auto found = originals.find(v);
    return found == originals.end() ? v : found->second;
  };
  std::vector<VertexId> open(marked_.begin(), marked_.end());
  for (std::size_t k = 0; k < open.size(); ++k) {
    const VertexId v = open[k];
    const auto isCut = [&](VertexId w) { return isMarked(originalOf(v), originalOf(w)); };
    // An opening may separate more faces than asked for, so find the fans again after each.
    auto fans = fansAround(mesh(), v, isCut);
    while (fans.size() > 1) {
      std::size_t known = edits().size();
      editor_.splitVertex(v, fans[1]);
      for (; known < edits().size(); ++known) {
        const VertexEdit& copy = edits()[known];
        originals[copy.id] = originalOf(copy.from[0]);
        if (marked_.count(originals[copy.id]) != 0) open.push_back(copy.id);
      }
      fans = fansAround(mesh(), v, isCut);
    }
  }
  marks_.clear();
  marked_.clear();
}

}  // namespace cloth_sim
