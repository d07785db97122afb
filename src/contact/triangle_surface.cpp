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

constexpr double kCancelled = 1e-9;  ///< size of a sum of unit vectors that cancel

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

bool TriangleSurface::Flat::isOver(const Vec3& p) const {
  const double u = gradients[0].dot(p);
  const double v = gradients[1].dot(p);
  return u > 0.0 && v > 0.0 && u + v < 1.0;
}

double TriangleSurface::Flat::leastSquareBeside(const Vec3& p) const {
  const auto& [g, h] = gradients;
  const double u = std::min(0.0, g.dot(p));
  const double v = std::min(0.0, h.dot(p));
  const double w = std::min(0.0, 1.0 - g.dot(p) - h.dot(p));
  return std::max(
      {u * u / g.squaredNorm(), v * v / h.squaredNorm(), w * w / (g + h).squaredNorm()});
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
      const double least2 = height * height + flats_[t].leastSquareBeside(relative);
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

}  // namespace cloth_sim
