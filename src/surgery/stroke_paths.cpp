#include <algorithm>
#include <array>
#include <tuple>

#include "nearest_point.h"
#include "stroke_segments.h"

namespace cloth_sim {
namespace {

/// Drops points inside faces that are not needed to stay within a tolerance (Douglas and Peucker
/// 1973).
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
  /// Replaces the segments from `first` to `last` by one, or by more if a point would be too far
  /// off.
  void simplify(std::size_t first, std::size_t last) {
    const Vec3& a = segments_[first].from.position;
    const Vec3& b = segments_[last].to.position;
    double farthest = 0.0;
    std::size_t split = first;
    for (std::size_t k = first; k < last; ++k) {
      if (segments_[k].to.keep == Keep::kNever) continue;
      const Vec3& p = segments_[k].to.position;
      const double distance = (nearestPoint(std::array{a, b}, p) - p).norm();
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
