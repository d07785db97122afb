#include <algorithm>
#include <cmath>
#include <tuple>

#include "stroke_segments.h"

namespace cloth_sim {
namespace {

/// Parts of the stroke that count as no time, and of the blade that count as no distance.
constexpr double kNoTime = 1e-12;
constexpr double kNoDistance = 1e-9;

/// A part of a segment, 0 at its start and 1 at its end; or of the stroke.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// A segment over the stroke.
struct Span {
  Interval time;
  double bladeLow = 0.0;  ///< along the blade, at the interval's ends
  double bladeHigh = 0.0;
  std::size_t polyline = 0;
  std::size_t segment = 0;

  double length() const { return time.high - time.low; }
  bool isInstant() const { return length() <= kNoTime; }
  double bladeAt(double t) const {
    if (isInstant()) return 0.5 * (bladeLow + bladeHigh);
    const double part = std::clamp((t - time.low) / length(), 0.0, 1.0);
    return (1.0 - part) * bladeLow + part * bladeHigh;
  }
};

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

/// When `other` is nearer to the heel than `span`. Of two that lie on each other it is the earlier.
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

/// A segment that the blade reaches all at once is seen only if it is no longer than a point, and
/// not behind another one.
bool hidesInstant(const Span& other, const Span& span) {
  if (other.isInstant()) return false;
  const double t = 0.5 * (span.time.low + span.time.high);
  return other.time.low <= t && t <= other.time.high &&
         other.bladeAt(t) < std::min(span.bladeLow, span.bladeHigh) - kNoDistance;
}

/// What of the time of `span` is in none of `hidden`.
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

class LayerFilter {
 public:
  explicit LayerFilter(const std::vector<Polyline>& polylines)
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

  /// The visible parts of a polyline as polylines of their own.
  void rebuild(std::size_t c) {
    const Polyline& polyline = polylines_[c];
    const std::size_t before = result_.size();
    bool goesOn = false;  // the last part reaches the end of its segment
    for (std::size_t p = 0; p < polyline.segments.size(); ++p) {
      std::vector<PathSegment> parts = partsOf(polyline.segments[p], visible_[c][p]);
      for (PathSegment& part : parts) {
        const bool joined = goesOn && part.from.node == polyline.segments[p].from.node;
        if (!joined) result_.emplace_back();
        goesOn = part.to.node == polyline.segments[p].to.node;
        result_.back().segments.push_back(std::move(part));
      }
      if (parts.empty()) goesOn = false;
    }
    if (polyline.closed && result_.size() > before) closeRing(polyline, before, goesOn);
  }

  /// Joins the last part of a ring to the first, if they meet.
  void closeRing(const Polyline& polyline, std::size_t first, bool goesOn) {
    Polyline& start = result_[first];
    if (!goesOn || start.segments.front().from.node != polyline.segments.front().from.node) return;
    if (result_.size() == first + 1) {
      start.closed = true;
      return;
    }
    Polyline last = std::move(result_.back());
    result_.pop_back();
    Polyline& head = result_[first];
    head.segments.insert(head.segments.begin(), last.segments.begin(), last.segments.end());
  }

  static std::vector<PathSegment> partsOf(const PathSegment& segment,
                                          const std::vector<Interval>& times) {
    std::vector<PathSegment> parts;
    for (const Interval& time : times) {
      PathSegment part = segment;
      const bool forwards = segment.from.at.stroke <= segment.to.at.stroke;
      cut(segment, forwards ? time.low : time.high, part.from);
      cut(segment, forwards ? time.high : time.low, part.to);
      parts.push_back(part);
    }
    if (!parts.empty() && segment.from.at.stroke > segment.to.at.stroke) {
      std::reverse(parts.begin(), parts.end());
    }
    return parts;
  }

  /// Moves an end of a part to where the segment is at time `t`, unless it is there already.
  static void cut(const PathSegment& segment, double t, PathSample& end) {
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
  double longest_ = 0.0;
  std::vector<std::vector<std::vector<Interval>>> visible_;  ///< by polyline and segment
  std::vector<Polyline> result_;
};

}  // namespace

std::vector<Polyline> lowerEnvelope(const std::vector<Polyline>& polylines) {
  return LayerFilter(polylines).run();
}

}  // namespace cloth_sim
