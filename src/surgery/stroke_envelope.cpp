#include <algorithm>
#include <cmath>
#include <tuple>

#include "stroke_segments.h"

namespace cloth_sim {
namespace {

/// Difference of stroke parameters that counts as zero.
constexpr double kNoTime = 1e-12;
/// Difference of blade parameters that counts as zero.
constexpr double kNoDistance = 1e-9;

/// An interval of the stroke parameter.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// A segment as a linear function: the blade parameter over the stroke parameter ("time").
struct Span {
  Interval time;
  double bladeLow = 0.0;     ///< blade parameter at time.low
  double bladeHigh = 0.0;    ///< blade parameter at time.high
  std::size_t polyline = 0;  ///< index of its polyline
  std::size_t segment = 0;   ///< index within the polyline

  double length() const { return time.high - time.low; }
  bool isInstant() const { return length() <= kNoTime; }
  double bladeAt(double t) const {
    if (isInstant()) return 0.5 * (bladeLow + bladeHigh);
    const double part = std::clamp((t - time.low) / length(), 0.0, 1.0);
    return (1.0 - part) * bladeLow + part * bladeHigh;
  }
};

/// Returns the spans of all segments, ascending by their start.
std::vector<Span> spansOf(const std::vector<Polyline>& polylines) {
  std::vector<Span> spans;
  for (std::size_t c = 0; c < polylines.size(); ++c) {
    for (std::size_t p = 0; p < polylines[c].segments.size(); ++p) {
      SweptParameters a = polylines[c].segments[p].from.at;
      SweptParameters b = polylines[c].segments[p].to.at;
      if (b.stroke < a.stroke) std::swap(a, b);
      spans.push_back({{a.stroke, b.stroke}, a.blade, b.blade, c, p});
    }
  }
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return std::tie(a.time.low, a.polyline, a.segment) <
           std::tie(b.time.low, b.polyline, b.segment);
  });
  return spans;
}

/// Returns the interval in which `other` is nearer to the heel than `span`. If both coincide, the
/// one that comes first in the list of polylines counts as nearer.
Interval hiddenBy(const Span& other, const Span& span) {
  const double low = std::max(span.time.low, other.time.low);
  const double high = std::min(span.time.high, other.time.high);
  if (!(high - low > kNoTime)) return {};
  const double atLow = span.bladeAt(low) - other.bladeAt(low);
  const double atHigh = span.bladeAt(high) - other.bladeAt(high);
  if (std::max(std::abs(atLow), std::abs(atHigh)) <= kNoDistance) {
    const bool earlier =
        std::tie(other.polyline, other.segment) < std::tie(span.polyline, span.segment);
    return earlier ? Interval{low, high} : Interval{};
  }
  if (atLow <= kNoDistance && atHigh <= kNoDistance) return {};
  if (atLow > kNoDistance && atHigh > kNoDistance) return {low, high};
  const double part = std::clamp(atLow / (atLow - atHigh), 0.0, 1.0);
  const double crossing = (1.0 - part) * low + part * high;
  return atLow > kNoDistance ? Interval{low, crossing} : Interval{crossing, high};
}

/// Returns whether `other` is nearer to the heel than `span`, which the blade reaches all at once.
bool hidesInstant(const Span& other, const Span& span) {
  if (other.isInstant()) return false;
  const double t = 0.5 * (span.time.low + span.time.high);
  return other.time.low <= t && t <= other.time.high &&
         other.bladeAt(t) < std::min(span.bladeLow, span.bladeHigh) - kNoDistance;
}

/// Returns the parts of the time of `span` that none of `hidden` covers.
std::vector<Interval> visible(const Span& span, std::vector<Interval> hidden) {
  std::sort(hidden.begin(), hidden.end(),
            [](const Interval& a, const Interval& b) { return a.low < b.low; });
  std::vector<Interval> left;
  double from = span.time.low;
  for (const Interval& part : hidden) {
    if (part.low - from > kNoTime) left.push_back({from, part.low});
    from = std::max(from, part.high);
  }
  if (span.time.high - from > kNoTime) left.push_back({from, span.time.high});
  return left;
}

/// Selects the visible parts of polylines, as seen from the heel of the blade.
class EnvelopeFilter {
 public:
  explicit EnvelopeFilter(const std::vector<Polyline>& polylines)
      : polylines_(polylines), spans_(spansOf(polylines)), visible_(polylines.size()) {
    for (const Span& span : spans_) longest_ = std::max(longest_, span.length());
    for (std::size_t c = 0; c < polylines.size(); ++c)
      visible_[c].resize(polylines[c].segments.size());
  }

  std::vector<Polyline> run() {
    for (const Span& span : spans_) visible_[span.polyline][span.segment] = visibleParts(span);
    for (std::size_t c = 0; c < polylines_.size(); ++c) rebuild(c);
    for (Polyline& polyline : result_) direct(polyline);
    return std::move(result_);
  }

 private:
  /// Returns the times at which a span is visible. A segment along the blade, which it reaches all
  /// at once, is visible only if it is as short as a point.
  std::vector<Interval> visibleParts(const Span& span) const {
    const bool instant = span.isInstant();
    if (instant && std::abs(span.bladeHigh - span.bladeLow) > kNoDistance) return {};
    std::vector<Interval> hidden;
    auto other = std::lower_bound(spans_.begin(), spans_.end(), span.time.low - longest_,
                                  [](const Span& s, double t) { return s.time.low < t; });
    for (; other != spans_.end() && other->time.low <= span.time.high; ++other) {
      if (instant && hidesInstant(*other, span)) return {};
      const Interval part = instant ? Interval{} : hiddenBy(*other, span);
      if (part.high > part.low) hidden.push_back(part);
    }
    return instant ? std::vector<Interval>{span.time} : visible(span, std::move(hidden));
  }

  /// Makes polylines of the visible parts of a polyline.
  void rebuild(std::size_t c) {
    const Polyline& polyline = polylines_[c];
    const std::size_t before = result_.size();
    bool reachesEnd = false;  // whether the last part reaches the end of its segment
    for (std::size_t p = 0; p < polyline.segments.size(); ++p) {
      std::vector<PathSegment> parts = partsOf(polyline.segments[p], visible_[c][p]);
      for (PathSegment& part : parts) {
        const bool joined = reachesEnd && part.from.node == polyline.segments[p].from.node;
        if (!joined) result_.emplace_back();
        reachesEnd = part.to.node == polyline.segments[p].to.node;
        result_.back().segments.push_back(std::move(part));
      }
      if (parts.empty()) reachesEnd = false;
    }
    if (polyline.closed && result_.size() > before) closeRing(polyline, before, reachesEnd);
  }

  /// Joins the last part of a closed polyline to its first part, if they meet.
  void closeRing(const Polyline& polyline, std::size_t first, bool reachesEnd) {
    Polyline& start = result_[first];
    if (!reachesEnd || start.segments.front().from.node != polyline.segments.front().from.node)
      return;
    if (result_.size() == first + 1) {
      start.closed = true;
      return;
    }
    Polyline last = std::move(result_.back());
    result_.pop_back();
    Polyline& head = result_[first];
    head.segments.insert(head.segments.begin(), last.segments.begin(), last.segments.end());
  }

  /// Returns the parts of a segment at the given times, in its direction.
  static std::vector<PathSegment> partsOf(const PathSegment& segment,
                                          const std::vector<Interval>& times) {
    std::vector<PathSegment> parts;
    for (const Interval& time : times) {
      PathSegment part = segment;
      const bool forwards = segment.from.at.stroke <= segment.to.at.stroke;
      moveEnd(segment, forwards ? time.low : time.high, part.from);
      moveEnd(segment, forwards ? time.high : time.low, part.to);
      parts.push_back(part);
    }
    if (!parts.empty() && segment.from.at.stroke > segment.to.at.stroke) {
      std::reverse(parts.begin(), parts.end());
    }
    return parts;
  }

  /// Moves an end of a part to the point of the segment at time `t`, unless it is there already.
  static void moveEnd(const PathSegment& segment, double t, PathSample& end) {
    if (std::abs(end.at.stroke - t) <= kNoTime) return;
    const double part =
        (t - segment.from.at.stroke) / (segment.to.at.stroke - segment.from.at.stroke);
    end.node = {kNone, kNone, kNone};
    end.keep = Keep::kAlways;
    end.material = (1.0 - part) * segment.from.material + part * segment.to.material;
    end.position = (1.0 - part) * segment.from.position + part * segment.to.position;
    end.at.stroke = t;
    end.at.blade = (1.0 - part) * segment.from.at.blade + part * segment.to.at.blade;
  }

  const std::vector<Polyline>& polylines_;
  std::vector<Span> spans_;
  double longest_ = 0.0;                                     ///< duration of the longest span
  std::vector<std::vector<std::vector<Interval>>> visible_;  ///< by polyline and segment
  std::vector<Polyline> result_;
};

}  // namespace

std::vector<Polyline> lowerEnvelope(const std::vector<Polyline>& polylines) {
  return EnvelopeFilter(polylines).run();
}

}  // namespace cloth_sim
