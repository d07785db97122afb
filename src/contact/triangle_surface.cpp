#include "cloth_sim/contact/triangle_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "closest_points.h"
#include "cloth_sim/contact/shape_geometry.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

constexpr double kNoDistance = 1e-12;   ///< below which round-off decides a direction [m]
constexpr double kCancelled = 1e-9;     ///< size of a sum of unit vectors that cancel
constexpr double kPushRoundOff = 1e-13; /**< pushes below it are round-off [m] */

Vec3 areaNormalOf(const std::vector<Vec3>& x, const TriangleSurface::Triangle& t) {
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
}

/// Tells whether a triangle is more than a line, but for round-off.
bool hasArea(const std::vector<Vec3>& x, const TriangleSurface::Triangle& t) {
  const double longest2 =
      std::max({(x[t[1]] - x[t[0]]).squaredNorm(), (x[t[2]] - x[t[1]]).squaredNorm(),
                (x[t[0]] - x[t[2]]).squaredNorm()});
  return areaNormalOf(x, t).norm() > 1e-10 * longest2;
}

double squaredDistanceToBox(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

/// Tells whether a segment comes into a box: each axis of the box limits its part inside.
bool meetsBox(const Vec3& from, const Vec3& path, const Vec3& low, const Vec3& high) {
  double first = 0.0;
  double last = 1.0;
  for (int k = 0; k < 3; ++k) {
    if (path[k] == 0.0) {
      if (from[k] < low[k] || from[k] > high[k]) return false;
      continue;
    }
    const double a = (low[k] - from[k]) / path[k];
    const double b = (high[k] - from[k]) / path[k];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

/// Tells whether the foot of a point is in the triangle. \param p  relative to its first corner.
template <class Flat>
bool isOver(const Flat& flat, const Vec3& p) {
  const double u = flat.gradients[0].dot(p);
  const double v = flat.gradients[1].dot(p);
  return u > 0.0 && v > 0.0 && u + v < 1.0;
}

/// A lower bound of the squared distance from the foot of a point to the triangle [m^2].
/// \param p  relative to its first corner.
template <class Flat>
double leastSquareBeside(const Flat& flat, const Vec3& p) {
  const auto& [g, h] = flat.gradients;
  const double u = std::min(0.0, g.dot(p));
  const double v = std::min(0.0, h.dot(p));
  const double w = std::min(0.0, 1.0 - g.dot(p) - h.dot(p));
  return std::max(
      {u * u / g.squaredNorm(), v * v / h.squaredNorm(), w * w / (g + h).squaredNorm()});
}

/// `push` of a path over a face, as far as it begins within reach of it.
double pushAtFace(double gap, double slope, double rise) {
  const double left = gap < 0.0 ? std::min(0.0, gap + rise) : 0.0;
  return left - (gap + slope);
}

/// Most contacts: whether a path begins within reach of a face, stays over it and is stopped by it.
/// Another triangle that the path meets as early is found once this one has been dealt with.
/// \param isInFront  set if the path begins within reach of the outer side of the face.
template <class Flat>
bool stopsAtFace(const Flat& flat, bool isClosed, const Vec3& from, const Vec3& path, double reach,
                 double rise, bool& isInFront, SurfaceHit& hit) {
  const Vec3 start = from - flat.corner;
  const double before = flat.normal.dot(start);
  const double height = isClosed ? before : std::abs(before);
  if (height > reach + geometry::kEntryTolerance || height < kNoDistance) return false;
  if (!isOver(flat, start)) return false;
  isInFront = true;
  const double side = before > 0.0 ? 1.0 : -1.0;
  const double push = pushAtFace(height - reach, side * flat.normal.dot(path), rise);
  if (!(push > kPushRoundOff) || !isOver(flat, start + path)) return false;
  hit.at = std::min(0.0, height - reach);
  hit.normal = side * flat.normal;
  hit.push = push;
  return true;
}

bool hasVertex(const TriangleSurface::Triangle& triangle, std::int32_t vertex) {
  return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

}  // namespace

TriangleSurface::TriangleSurface(std::vector<Vec3> vertices, const std::vector<Triangle>& triangles)
    : vertices_(std::move(vertices)) {
  takeTriangles(triangles);
  findWhetherClosed();
  if (isClosed_) turnOutwards();
  sortTriangles();
  finish();
}

void TriangleSurface::takeTriangles(const std::vector<Triangle>& triangles) {
  if (triangles.size() > kMostTriangles) {
    throw std::invalid_argument("expected at most " + std::to_string(kMostTriangles) +
                                " triangles (got " + std::to_string(triangles.size()) + ")");
  }
  const auto isFinite = [](const Vec3& x) {
    return x.allFinite() && x.cwiseAbs().maxCoeff() < 1e9;
  };
  if (!std::all_of(vertices_.begin(), vertices_.end(), isFinite)) {
    throw std::invalid_argument("expected finite vertices, nearer than 1e9 m");
  }
  const auto count = static_cast<std::int32_t>(vertices_.size());
  for (const Triangle& triangle : triangles) {
    for (const std::int32_t v : triangle) {
      if (v < 0 || v >= count) throw std::invalid_argument("expected corners that are vertices");
    }
    if (hasArea(vertices_, triangle)) triangles_.push_back(triangle);
  }
  if (triangles_.empty()) {
    throw std::invalid_argument("expected triangles with an area (got " +
                                std::to_string(triangles.size()) + " without)");
  }
}

std::vector<TriangleSurface::Edge> TriangleSurface::sortedEdges() const {
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangles_[t][k];
      const std::int32_t b = triangles_[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), k, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle, a.corner) <
           std::tie(b.low, b.high, b.triangle, b.corner);
  });
  return edges;
}

void TriangleSurface::findWhetherClosed() {
  std::size_t open = 0;
  std::size_t flipped = 0;
  forEachEdge([&](const Edge* first, const Edge* last) {
    if (last - first != 2) {
      ++open;
    } else if (first[0].isUp == first[1].isUp) {
      ++flipped;
    }
  });
  isClosed_ = open + flipped == 0;
  // A few bad edges are a mistake; the border of a sheet has about the root of their number.
  if (!isClosed_ && 20 * (open + flipped) * (open + flipped) <= 3 * triangles_.size()) {
    doubt_ = "its surface is nearly closed, but " + std::to_string(open) +
             " edges do not have two triangles, and at " + std::to_string(flipped) +
             " they turn opposite ways: it is taken as an open sheet, without an inside";
  }
}

/// Turns the triangles of a closed surface round if it has a negative volume.
void TriangleSurface::turnOutwards() {
  double volume = 0.0;
  const Vec3& origin = vertices_[triangles_[0][0]];
  for (const Triangle& t : triangles_) {
    volume +=
        (vertices_[t[0]] - origin).dot((vertices_[t[1]] - origin).cross(vertices_[t[2]] - origin));
  }
  if (volume >= 0.0) return;
  for (Triangle& t : triangles_) std::swap(t[1], t[2]);
}

/// Builds the hierarchy, and brings the triangles into the order of its leaves.
void TriangleSurface::sortTriangles() {
  std::vector<BoxedItem> items;
  for (const Triangle& t : triangles_) {
    const auto& [a, b, c] = t;
    const Vec3 low = vertices_[a].cwiseMin(vertices_[b]).cwiseMin(vertices_[c]);
    const Vec3 high = vertices_[a].cwiseMax(vertices_[b]).cwiseMax(vertices_[c]);
    items.push_back({low, high, vertices_[a] + vertices_[b] + vertices_[c]});
  }
  std::vector<std::int32_t> order;
  nodes_ = buildBoxTree(items, order);
  std::vector<Triangle> sorted;
  for (const std::int32_t k : order) sorted.push_back(triangles_[k]);
  triangles_ = std::move(sorted);
}

/// Computes what follows from the triangles in their final order.
void TriangleSurface::finish() {
  double edges = 0.0;
  for (const Triangle& t : triangles_) {
    const Vec3 e1 = vertices_[t[1]] - vertices_[t[0]];
    const Vec3 e2 = vertices_[t[2]] - vertices_[t[0]];
    const Vec3 area = e1.cross(e2);
    Flat flat;
    flat.corner = vertices_[t[0]];
    flat.normal = area.normalized();
    flat.gradients = {e2.cross(area) / area.squaredNorm(), area.cross(e1) / area.squaredNorm()};
    edges += e1.norm();
    flats_.push_back(flat);
  }
  pad_ = 0.08 * edges / static_cast<double>(triangles_.size());
  if (isClosed_) findPseudonormals();
  Hash hash;
  for (const Vec3& x : vertices_) hash.add(x.data(), 3 * sizeof(double));
  hash.add(triangles_.data(), triangles_.size() * sizeof(Triangle));
  contentHash_ = hash.value();
}

/// Baerentzen and Aanaes 2005: the sign of the distance is right at edges and vertices with the
/// sum of the two normals, and with the sum of normals weighted by the angles at the vertex.
void TriangleSurface::findPseudonormals() {
  vertexNormals_.assign(vertices_.size(), Vec3::Zero());
  edgeNormals_.resize(triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const std::array<Vec3, 3> x = cornersOf(static_cast<std::int32_t>(t));
    for (int k = 0; k < 3; ++k) {
      vertexNormals_[triangles_[t][k]] +=
          angleAt(x[k], x[(k + 1) % 3], x[(k + 2) % 3]) * flats_[t].normal;
    }
  }
  forEachEdge([this](const Edge* first, const Edge* last) {
    const Vec3 sum = flats_[first[0].triangle].normal + flats_[first[1].triangle].normal;
    for (const Edge* it = first; it != last; ++it) edgeNormals_[it->triangle][it->corner] = sum;
  });
}

std::array<Vec3, 3> TriangleSurface::cornersOf(std::int32_t triangle) const {
  const Triangle& t = triangles_[triangle];
  return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
}

Vec3 TriangleSurface::pseudonormal(const TrianglePoint& at) const {
  for (int k = 0; k < 3; ++k) {
    if (at.weight[(k + 1) % 3] == 0.0 && at.weight[(k + 2) % 3] == 0.0) {
      return vertexNormals_[triangles_[at.triangle][k]];
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (at.weight[(k + 2) % 3] == 0.0) return edgeNormals_[at.triangle][k];
  }
  return flats_[at.triangle].normal;
}

TrianglePoint TriangleSurface::closestOf(std::int32_t triangle, const Vec3& p) const {
  TrianglePoint result;
  const std::array<Vec3, 3> x = cornersOf(triangle);
  result.triangle = triangle;
  result.weight = closestOnTriangle(p, x);
  result.point = x[0] + result.weight[1] * (x[1] - x[0]) + result.weight[2] * (x[2] - x[0]);
  result.distance = (p - result.point).norm();
  return result;
}

TrianglePoint TriangleSurface::closest(const Vec3& p, double within) const {
  TrianglePoint best;
  best.distance = within;
  std::array<std::pair<double, std::int32_t>, kDeepestBox> stack;
  std::size_t size = 0;
  const auto squared = [&](std::int32_t k) {
    return squaredDistanceToBox(p, nodes_[k].low, nodes_[k].high);
  };
  stack[size++] = {squared(0), 0};
  while (size > 0) {
    const auto [distance2, k] = stack[--size];
    if (distance2 > best.distance * best.distance) continue;
    const BoxNode& node = nodes_[k];
    for (std::int32_t t = node.first; t < node.first + node.count; ++t) {
      const Vec3 relative = p - flats_[t].corner;
      const double height = flats_[t].normal.dot(relative);
      const double least2 = height * height + leastSquareBeside(flats_[t], relative);
      // A margin for round-off: what is skipped is farther.
      if (least2 * (1.0 - 1e-9) > best.distance * best.distance) continue;
      const TrianglePoint at = closestOf(t, p);
      if (at.distance < best.distance) best = at;
    }
    if (node.count > 0) continue;
    std::pair<double, std::int32_t> near{squared(k + 1), k + 1};
    std::pair<double, std::int32_t> far{squared(node.right), node.right};
    if (far.first < near.first) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
  return best;
}

double TriangleSurface::distance(const Vec3& p) const {
  const TrianglePoint at = closest(p, std::numeric_limits<double>::infinity());
  const bool isInside = isClosed_ && (p - at.point).dot(pseudonormal(at)) < 0.0;
  return isInside ? -at.distance : at.distance;
}

double TriangleSurface::distance(const Vec3& p, Vec3& normal) const {
  const TrianglePoint at = closest(p, std::numeric_limits<double>::infinity());
  const Vec3 away = p - at.point;
  const bool isInside = isClosed_ && away.dot(pseudonormal(at)) < 0.0;
  const double sign = isInside ? -1.0 : 1.0;
  if (at.distance > kNoDistance) {
    normal = sign / at.distance * away;
  } else {  // where two triangles of a closed surface lie on each other, their normals cancel
    const Vec3 sum = isClosed_ ? pseudonormal(at) : Vec3(Vec3::Zero());
    normal = sum.norm() > kCancelled ? Vec3(sum.normalized()) : flats_[at.triangle].normal;
  }
  return sign * at.distance;
}

bool TriangleSurface::isWithin(const Vec3& p, double limit, const NearTriangles& near) const {
  if (limit >= 0.0) {
    const double limit2 = limit * limit;
    if (near.count > 0 && (p - flats_[near.triangles[0]].corner).squaredNorm() <= limit2) {
      return true;  // as most particles near the surface
    }
    std::array<std::int32_t, kDeepestBox> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const std::int32_t k = stack[--size];
      const BoxNode& node = nodes_[k];
      if (squaredDistanceToBox(p, node.low, node.high) > limit2) continue;
      const Vec3 farthest = (p - node.low).cwiseAbs().cwiseMax((node.high - p).cwiseAbs());
      if (farthest.squaredNorm() <= limit2) return true;
      for (std::int32_t t = node.first; t < node.first + node.count; ++t) {
        if (closestOf(t, p).distance <= limit) return true;
      }
      if (node.count > 0) continue;
      const bool isRightNearer =
          squaredDistanceToBox(p, nodes_[node.right].low, nodes_[node.right].high) <
          squaredDistanceToBox(p, nodes_[k + 1].low, nodes_[k + 1].high);
      stack[size++] = isRightNearer ? k + 1 : node.right;
      stack[size++] = isRightNearer ? node.right : k + 1;
    }
  }
  if (!isClosed_ || (p - low()).minCoeff() < 0.0 || (high() - p).minCoeff() < 0.0) return false;
  return distance(p) <= limit;
}

/// Calls `function` with each triangle that a part of the path may come nearer to than `reach`, and
/// with others.
template <class Function>
void TriangleSurface::visitNear(const Vec3& from, const Vec3& to, double reach,
                                const NearTriangles& near, Function&& function) const {
  if (near.count != kNone) {
    for (std::int32_t k = 0; k < near.count; ++k) function(near.triangles[k]);
    return;
  }
  const Vec3 path = to - from;
  const Vec3 room = Vec3::Constant(reach + 2.0 * geometry::kEntryTolerance);
  visitLeaves(
      nodes_,
      [&](const BoxNode& node) { return meetsBox(from, path, node.low - room, node.high + room); },
      function);
}

/// Lists the triangles around a path, if the list does not have them yet.
void TriangleSurface::fill(const Vec3& from, const Vec3& to, double reach,
                           NearTriangles& near) const {
  const double farthest = std::max((from - near.centre).cwiseAbs().maxCoeff(),
                                   (to - near.centre).cwiseAbs().maxCoeff());
  if (farthest <= near.half) return;
  near.centre = 0.5 * (from + to);
  const double path = 0.5 * (to - from).cwiseAbs().maxCoeff();
  bool fits = false;
  for (const double pad : {pad_, 0.125 * pad_}) {
    near.half = path + pad;
    fits = list(reach, near);
    if (fits) break;
  }
  if (!fits) near.half = -1.0;  // only this path may use it
  if (near.count != 0) {
    if (!isClosed_) return;
    const std::optional<bool> side = sideNearby(from, reach + 0.125 * pad_, near);
    near.isInside = side ? *side : distance(from) < 0.0;
    return;
  }
  const double away = distance(from);
  near.isInside = away < 0.0;
  // The box in the ball that is free of triangles may be larger.
  const double free = 0.577 * (std::abs(away) - reach - 2.0 * geometry::kEntryTolerance);
  if (free <= near.half) return;
  near.centre = from;
  near.half = free;
}

/// Tells whether a point is inside the closed surface, if a triangle is nearer than `within`; the
/// list must have all of those.
std::optional<bool> TriangleSurface::sideNearby(const Vec3& p, double within,
                                                const NearTriangles& near) const {
  TrianglePoint nearest;
  nearest.distance = within;
  visitNear(p, p, within, near, [&](std::int32_t t) {
    const double height = flats_[t].normal.dot(p - flats_[t].corner);
    if (std::abs(height) >= nearest.distance) return;
    const TrianglePoint at = closestOf(t, p);
    if (at.distance < nearest.distance) nearest = at;
  });
  if (nearest.triangle == kNone) return std::nullopt;
  return (p - nearest.point).dot(pseudonormal(nearest)) < 0.0;
}

/// Lists the triangles in reach of the box. \return false, and no list, if there are too many.
bool TriangleSurface::list(double reach, NearTriangles& near) const {
  near.count = 0;
  const Vec3 room = Vec3::Constant(near.half + reach + 2.0 * geometry::kEntryTolerance);
  const Vec3 low = near.centre - room;
  const Vec3 high = near.centre + room;
  const auto overlaps = [&](const Vec3& least, const Vec3& most) {
    return boxesMeet(least, most, low, high);
  };
  const auto isNear = [&](const BoxNode& node) {
    return near.count != kNone && overlaps(node.low, node.high);
  };
  visitLeaves(nodes_, isNear, [&](std::int32_t t) {
    if (near.count == kNone) return;
    const std::array<Vec3, 3> x = cornersOf(t);
    if (!overlaps(x[0].cwiseMin(x[1]).cwiseMin(x[2]), x[0].cwiseMax(x[1]).cwiseMax(x[2]))) return;
    const double side = flats_[t].normal.dot(near.centre - x[0]);
    if (std::abs(side) > flats_[t].normal.cwiseAbs().dot(room)) return;
    const bool isFull = near.count == NearTriangles::kMost;
    if (!isFull) near.triangles[near.count] = t;
    near.count = isFull ? kNone : near.count + 1;
  });
  return near.count != kNone;
}

/// `sweep` of a path that begins inside a closed surface.
bool TriangleSurface::stopsInside(const Vec3& from, const Vec3& to, double reach, double rise,
                                  SurfaceHit& hit) const {
  const double gap = distance(from, hit.normal) - reach;
  const double moved = hit.normal.dot(to - from);
  if (moved >= 0.0 && distance(to) >= reach) return false;  // it leaves without help
  hit.at = gap;
  hit.push = std::min(0.0, gap + rise) - (gap + moved);
  return hit.push > kPushRoundOff;
}

/// Tells whether one triangle stops the path. The distance to a triangle is convex, so Newton's
/// method finds where the path comes within reach, as in `sweepConvex`. \param at  the closest
/// point of the triangle there.
bool TriangleSurface::meets(std::int32_t triangle, const Vec3& from, const Vec3& to, double reach,
                            double rise, SurfaceHit& hit, TrianglePoint& at) const {
  const Flat& flat = flats_[triangle];
  const double before = flat.normal.dot(from - flat.corner);
  const double after = flat.normal.dot(to - flat.corner);
  if ((before > reach && after > reach) || (before < -reach && after < -reach)) return false;
  const Vec3 path = to - from;
  const double limit = reach + path.norm();
  const double beside2 = leastSquareBeside(flat, from - flat.corner);
  if (before * before + beside2 >= limit * limit) return false;  // too far away to get there
  at = closestOf(triangle, from);
  double gap = at.distance - reach;
  if (gap >= 0.0 && gap * gap >= path.squaredNorm()) return false;  // too far away to get there
  const auto normalAt = [&](const Vec3& p) -> Vec3 {
    if (at.distance > kNoDistance) return (p - at.point) / at.distance;
    return isClosed_ || before >= 0.0 ? flat.normal : Vec3(-flat.normal);
  };
  hit.normal = normalAt(from);
  double slope = hit.normal.dot(path);
  if (gap < 0.0) {
    hit.at = gap;
    hit.push = std::min(0.0, gap + rise) - (gap + slope);
    return hit.push > kPushRoundOff;
  }
  hit.at = 0.0;
  for (int i = 0; i < geometry::kMaxEntryIterations && gap > geometry::kEntryTolerance; ++i) {
    if (slope >= 0.0) return false;  // past the nearest point
    hit.at -= gap / slope;
    if (hit.at > 1.0) return false;
    const Vec3 p = from + hit.at * path;
    at = closestOf(triangle, p);
    gap = at.distance - reach;
    hit.normal = normalAt(p);
    slope = hit.normal.dot(path);
  }
  hit.push = -(gap + (1.0 - hit.at) * slope);
  return hit.push > kPushRoundOff;
}

/// Tells whether the closest point `at` to `p` is on an edge or a vertex beyond which another
/// triangle is nearer: then that one stops the particle, and the edge is none on the surface.
bool TriangleSurface::isBesideNearer(const TrianglePoint& at, const Vec3& p, double reach,
                                     const NearTriangles& near) const {
  std::array<std::int32_t, 3> shared{};
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    if (at.weight[k] != 0.0) shared[count++] = triangles_[at.triangle][k];
  }
  if (count == 3) return false;
  bool isBeside = false;
  visitNear(p, p, reach, near, [&](std::int32_t other) {
    if (isBeside || other == at.triangle) return;
    for (int k = 0; k < count; ++k) {
      if (!hasVertex(triangles_[other], shared[k])) return;
    }
    isBeside = closestOf(other, p).distance < at.distance;
  });
  return isBeside;
}

bool TriangleSurface::sweep(const Vec3& from, const Vec3& to, double reach, double rise,
                            NearTriangles& near, SurfaceHit& hit) const {
  fill(from, to, reach, near);
  if (near.count == 0 && !near.isInside) return false;
  bool isInFront = false;
  bool stops = false;
  const Vec3 path = to - from;
  visitNear(from, to, reach, near, [&](std::int32_t t) {
    stops = stops || stopsAtFace(flats_[t], isClosed_, from, path, reach, rise, isInFront, hit);
  });
  if (stops) return true;
  if (isClosed_ && !isInFront) {
    // The sign is that of the closest point; without one that the list must have, it is as before.
    const double left = near.half - (from - near.centre).cwiseAbs().maxCoeff();
    const double within = reach + (near.count == kNone ? pad_ : left);
    near.isInside = sideNearby(from, within, near).value_or(near.isInside);
    if (near.isInside) return stopsInside(from, to, reach, rise, hit);
  }
  hit.at = 2.0;
  SurfaceHit found;
  TrianglePoint at;
  visitNear(from, to, reach, near, [&](std::int32_t t) {
    if (!meets(t, from, to, reach, rise, found, at) || found.at >= hit.at) return;
    const Vec3 p = from + std::max(0.0, found.at) * (to - from);
    if (!isBesideNearer(at, p, reach, near)) hit = found;
  });
  return hit.at <= 1.0;
}

}  // namespace cloth_sim
