#include <algorithm>
#include <cmath>
#include <tuple>

#include "stroke_segments.h"

namespace cloth_sim {
namespace {

/// Distance up to which points count as one, in lengths of the edges of the face.
constexpr double kSamePoint = 1e-12;
/// Change of the stroke parameter that counts as zero.
constexpr double kNoAdvance = 1e-9;

/// An end of a segment: 2 k for the start and 2 k + 1 for the end of segment k.
using EndId = std::int32_t;

PathSegment reversed(const PathSegment& segment) {
  return {segment.to, segment.from, segment.face};
}

/// Returns, for each end of a segment, the end of another segment with the same node; kNone where
/// the path ends.
std::vector<EndId> partnersOf(const std::vector<PathSegment>& segments) {
  std::vector<std::pair<PathNode, EndId>> ends;
  ends.reserve(2 * segments.size());
  for (const PathSegment& segment : segments) {
    ends.emplace_back(segment.from.node, static_cast<EndId>(ends.size()));
    ends.emplace_back(segment.to.node, static_cast<EndId>(ends.size()));
  }
  std::sort(ends.begin(), ends.end());
  std::vector<EndId> partner(ends.size(), kNone);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    if (ends[k].first != ends[k + 1].first) continue;
    partner[ends[k].second] = ends[k + 1].second;
    partner[ends[k + 1].second] = ends[k].second;
    ++k;
  }
  return partner;
}

/// Joins segments end to end: first the open polylines, then the closed ones.
class Joiner {
 public:
  explicit Joiner(const std::vector<PathSegment>& segments)
      : segments_(segments), partner_(partnersOf(segments)), taken_(segments.size(), false) {}

  std::vector<Polyline> run() {
    const auto ends = static_cast<EndId>(partner_.size());
    for (EndId end = 0; end < ends; ++end) {
      if (partner_[end] == kNone) trace(end, false);
    }
    for (EndId end = 0; end < ends; end += 2) trace(end, true);
    return std::move(polylines_);
  }

 private:
  /// Collects the segments from `start` on that have not been taken.
  void trace(EndId start, bool closed) {
    Polyline polyline;
    polyline.closed = closed;
    for (EndId end = start; end != kNone && !taken_[end / 2]; end = partner_[end ^ 1]) {
      taken_[end / 2] = true;
      const PathSegment& segment = segments_[end / 2];
      polyline.segments.push_back(end % 2 == 0 ? segment : reversed(segment));
    }
    if (!polyline.segments.empty()) polylines_.push_back(std::move(polyline));
  }

  const std::vector<PathSegment>& segments_;
  std::vector<EndId> partner_;
  std::vector<bool> taken_;
  std::vector<Polyline> polylines_;
};

/// Returns whether a polyline runs against the direction that `direct` gives it.
bool goesBackwards(const Polyline& polyline) {
  double advance = 0.0;
  double outwards = 0.0;
  for (const PathSegment& segment : polyline.segments) {
    advance += segment.to.at.stroke - segment.from.at.stroke;
    outwards += segment.to.at.blade - segment.from.at.blade;
  }
  return std::abs(advance) > kNoAdvance ? advance < 0.0 : outwards < 0.0;
}

/// Rotates a closed polyline so that it starts where the blade reaches it first.
void rotateToStart(Polyline& polyline) {
  const auto rank = [](const PathSegment& segment) {
    return std::make_tuple(segment.from.keep != Keep::kAlways, segment.from.at.stroke,
                           segment.from.at.blade);
  };
  const auto first = std::min_element(
      polyline.segments.begin(), polyline.segments.end(),
      [&](const PathSegment& a, const PathSegment& b) { return rank(a) < rank(b); });
  std::rotate(polyline.segments.begin(), first, polyline.segments.end());
}

bool hasLength(const PathSegment& segment, const TriangleMesh& mesh) {
  const auto& [a, b, c] = mesh.face(segment.face);
  const double size = std::max((mesh.material(b) - mesh.material(a)).norm(),
                               (mesh.material(c) - mesh.material(a)).norm());
  return (segment.to.material - segment.from.material).norm() > kSamePoint * size;
}

/// Replaces a point by another one at the same position, but keeps its parameters.
void merge(PathSample& sample, const PathSample& at) {
  const SweptParameters own = sample.at;
  sample = at;
  sample.at = own;
}

/// Drops segments without length. Of the points that coincide then, the most important one stays.
void dropEmptySegments(Polyline& polyline, const TriangleMesh& mesh) {
  std::vector<PathSegment> kept;
  kept.reserve(polyline.segments.size());
  for (const PathSegment& segment : polyline.segments) {
    if (hasLength(segment, mesh)) {
      kept.push_back(segment);
    } else if (!kept.empty() && kept.back().to.keep < segment.to.keep) {
      merge(kept.back().to, segment.to);
    }
  }
  for (std::size_t k = 1; k < kept.size(); ++k) merge(kept[k].from, kept[k - 1].to);
  if (polyline.closed && !kept.empty()) merge(kept.front().from, kept.back().to);
  polyline.segments = std::move(kept);
}

}  // namespace

void direct(Polyline& polyline) {
  if (!goesBackwards(polyline)) return;
  std::reverse(polyline.segments.begin(), polyline.segments.end());
  for (PathSegment& segment : polyline.segments) std::swap(segment.from, segment.to);
}

std::vector<Polyline> joinSegments(const std::vector<PathSegment>& segments,
                                   const TriangleMesh& mesh) {
  std::vector<Polyline> polylines = Joiner(segments).run();
  for (Polyline& polyline : polylines) {
    direct(polyline);
    if (polyline.closed) rotateToStart(polyline);
    dropEmptySegments(polyline, mesh);
  }
  polylines.erase(
      std::remove_if(polylines.begin(), polylines.end(),
                     [](const Polyline& polyline) { return polyline.segments.empty(); }),
      polylines.end());
  return polylines;
}

}  // namespace cloth_sim
