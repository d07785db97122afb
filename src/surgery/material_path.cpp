#include "cloth_sim/surgery/material_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Distances up to this count as zero [m].
constexpr double kTolerance = 1e-9;
/// Segments per bounding box of a PathIndex.
constexpr std::size_t kSegmentsPerBox = 16;

/// Returns the squared distance of p from the segment a-b [m^2].
double squaredDistance(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 d = b - a;
  const double square = d.squaredNorm();
  const double t = square > 0.0 ? std::clamp(d.dot(p - a) / square, 0.0, 1.0) : 0.0;
  return (a + t * d - p).squaredNorm();
}

/// Returns the signed distance of p from the line through a and b [m], positive to the right.
double offLine(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 d = b - a;
  return -cross(d, p - a) / d.norm();
}

/// Returns whether the bounding boxes of two segments meet. Decides whether collinear segments
/// meet.
bool boxesMeet(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  const auto apart = [](double a0, double a1, double p0, double p1) {
    return std::max(a0, a1) < std::min(p0, p1) - kTolerance;
  };
  return !apart(a.x(), b.x(), p.x(), q.x()) && !apart(p.x(), q.x(), a.x(), b.x()) &&
         !apart(a.y(), b.y(), p.y(), q.y()) && !apart(p.y(), q.y(), a.y(), b.y());
}

/// Returns whether p and q lie on both sides of the line through a and b, or on it.
bool straddles(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  const double first = offLine(a, b, p);
  const double second = offLine(a, b, q);
  return std::min(first, second) <= kTolerance && std::max(first, second) >= -kTolerance;
}

/// Returns whether p and q lie strictly on both sides of the line through a and b.
bool straddlesStrictly(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  const double first = offLine(a, b, p);
  const double second = offLine(a, b, q);
  return std::min(first, second) < -kTolerance && std::max(first, second) > kTolerance;
}

bool segmentSeparates(const Vec2& from, const Vec2& to, const Vec2& p, const Vec2& q) {
  return boxesMeet(from, to, p, q) && straddlesStrictly(from, to, p, q) &&
         straddles(p, q, from, to);
}

}  // namespace

VertexData<Vec3> inMaterialPlane(const TriangleMesh& mesh) {
  std::vector<Vec3> points;
  points.reserve(mesh.material().size());
  for (const Vec2& p : mesh.material()) points.push_back(inMaterialPlane(p));
  return VertexData<Vec3>(std::move(points), mesh.revision());
}

double sideOf(const MaterialPath& path, const Vec2& point) {
  // Two segments are equally near beyond a corner. Then the one whose line is farther decides.
  double nearest = std::numeric_limits<double>::infinity();
  double side = 0.0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const double distance = std::sqrt(squaredDistance(path[k], path[k + 1], point));
    const double off = offLine(path[k], path[k + 1], point);
    const bool nearer = distance < nearest - kTolerance;
    const bool asNear = distance < nearest + kTolerance && std::abs(off) > std::abs(side);
    if (nearer || asNear) side = off;
    nearest = std::min(nearest, distance);
  }
  return std::abs(side) <= kTolerance ? 0.0 : side;
}

double distanceTo(const MaterialPath& path, const Vec2& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    nearest = std::min(nearest, squaredDistance(path[k], path[k + 1], point));
  }
  return std::sqrt(nearest);
}

bool separates(const MaterialPath& path, const Vec2& p, const Vec2& q) {
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    if (segmentSeparates(path[k], path[k + 1], p, q)) return true;
  }
  return false;
}

PathIndex::PathIndex(MaterialPath path) : path_(std::move(path)) {
  for (std::size_t first = 0; first + 1 < path_.size(); first += kSegmentsPerBox) {
    Eigen::AlignedBox2d& box = boxes_.emplace_back();
    const std::size_t last = std::min(first + kSegmentsPerBox, path_.size() - 1);
    for (std::size_t k = first; k <= last; ++k) box.extend(path_[k]);
    box.extend((box.min().array() - kTolerance).matrix().eval());
    box.extend((box.max().array() + kTolerance).matrix().eval());
  }
}

bool PathIndex::separates(const Vec2& p, const Vec2& q) const {
  const Eigen::AlignedBox2d own(p.cwiseMin(q), p.cwiseMax(q));
  for (std::size_t box = 0; box < boxes_.size(); ++box) {
    if (!boxes_[box].intersects(own)) continue;
    const std::size_t last = std::min((box + 1) * kSegmentsPerBox, path_.size() - 1);
    for (std::size_t k = box * kSegmentsPerBox; k < last; ++k) {
      if (segmentSeparates(path_[k], path_[k + 1], p, q)) return true;
    }
  }
  return false;
}

bool crosses(const MaterialPath& path, const Vec2& p, const Vec2& q) {
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const bool meets = boxesMeet(path[k], path[k + 1], p, q) &&
                       straddles(path[k], path[k + 1], p, q) &&
                       straddles(p, q, path[k], path[k + 1]);
    if (meets) return true;
  }
  return false;
}

}  // namespace cloth_sim
