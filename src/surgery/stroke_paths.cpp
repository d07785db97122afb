#include <algorithm>
#include <tuple>

#include "stroke_segments.h"

namespace cloth_sim {
namespace {

double distanceToSegment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 d = b - a;
  const double length = d.squaredNorm();
  const double part = length > 0.0 ? std::clamp(d.dot(p - a) / length, 0.0, 1.0) : 0.0;
  return (a + part * d - p).norm();
}

/// Leaves out points inside a face that the path does not keep (Douglas and Peucker, 1973).
class Simplifier {
 public:
  Simplifier(const std::vector<PathSegment>& segments, double tolerance)
      : segments_(segments), tolerance_(tolerance) {}

  std::vector<PathSegment> run() {
    std::size_t first = 0;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      const bool ends = k + 1 == segments_.size() || segments_[k].to.keep == Keep::kAlways ||
                        segments_[k].face != segments_[k + 1].face;
      if (!ends) continue;
      simplify(first, k);
      first = k + 1;
    }
    return std::move(result_);
  }

 private:
  /// One segment instead of those from `first` to `last`, or more if that takes it too far.
  void simplify(std::size_t first, std::size_t last) {
    const Vec3& a = segments_[first].from.position;
    const Vec3& b = segments_[last].to.position;
    double farthest = 0.0;
    std::size_t split = first;
    for (std::size_t k = first; k < last; ++k) {
      if (segments_[k].to.keep == Keep::kNever) continue;
      const double distance = distanceToSegment(a, b, segments_[k].to.position);
      if (distance <= farthest) continue;
      farthest = distance;
      split = k;
    }
    if (farthest <= tolerance_) {
      result_.push_back({segments_[first].from, segments_[last].to, segments_[first].face});
      return;
    }
    simplify(first, split);
    simplify(split + 1, last);
  }

  const std::vector<PathSegment>& segments_;
  const double tolerance_;
  std::vector<PathSegment> result_;
};

SurfacePath toPath(const Polyline& polyline) {
  SurfacePath path;
  path.points.reserve(polyline.segments.size() + 1);
  for (const PathSegment& segment : polyline.segments) {
    path.points.push_back({segment.face, segment.from.material});
  }
  path.points.push_back({polyline.segments.back().face, polyline.segments.back().to.material});
  if (polyline.closed) path.points.back() = path.points.front();
  return path;
}

bool startsEarlier(const Polyline& a, const Polyline& b) {
  const PathSegment& p = a.segments.front();
  const PathSegment& q = b.segments.front();
  return std::tie(p.from.at.stroke, p.from.at.blade, p.face) <
         std::tie(q.from.at.stroke, q.from.at.blade, q.face);
}

}  // namespace

std::vector<SurfacePath> toPaths(std::vector<Polyline> polylines, double tolerance) {
  std::stable_sort(polylines.begin(), polylines.end(), startsEarlier);
  std::vector<SurfacePath> paths;
  paths.reserve(polylines.size());
  for (Polyline& polyline : polylines) {
    polyline.segments = Simplifier(polyline.segments, tolerance).run();
    paths.push_back(toPath(polyline));
  }
  return paths;
}

}  // namespace cloth_sim
