#include <algorithm>
#include <cmath>
#include <tuple>

#include "stroke_pieces.h"

namespace cloth_sim {
namespace {

/// Parts of the stroke that count as no time, and of the blade that count as no distance.
constexpr double kNoTime = 1e-12;
constexpr double kNoDistance = 1e-9;

/// A part of a piece, 0 at its start and 1 at its end; or of the stroke.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// A piece over the stroke.
struct Span {
  Interval time;
  double bladeLow = 0.0;  ///< along the blade, at the interval's ends
  double bladeHigh = 0.0;
  std::size_t chain = 0;
  std::size_t piece = 0;

  double length() const { return time.high - time.low; }
  bool isInstant() const { return length() <= kNoTime; }
  double bladeAt(double t) const {
    if (isInstant()) return 0.5 * (bladeLow + bladeHigh);
    const double part = std::clamp((t - time.low) / length(), 0.0, 1.0);
    return (1.0 - part) * bladeLow + part * bladeHigh;
  }
};

std::vector<Span> spansOf(const std::vector<PathChain>& chains) {
  std::vector<Span> spans;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (std::size_t p = 0; p < chains[c].pieces.size(); ++p) {
      StripParameters a = chains[c].pieces[p].from.at;
      StripParameters b = chains[c].pieces[p].to.at;
      if (b.stroke < a.stroke) std::swap(a, b);
      spans.push_back({{a.stroke, b.stroke}, a.blade, b.blade, c, p});
    }
  }
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return std::tie(a.time.low, a.chain, a.piece) < std::tie(b.time.low, b.chain, b.piece);
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
    const bool earlier = std::tie(other.chain, other.piece) < std::tie(span.chain, span.piece);
    return earlier ? Interval{low, high} : Interval{};
  }
  if (atLow <= kNoDistance && atHigh <= kNoDistance) return {};
  if (atLow > kNoDistance && atHigh > kNoDistance) return {low, high};
  const double part = std::clamp(atLow / (atLow - atHigh), 0.0, 1.0);
  const double crossing = (1.0 - part) * low + part * high;
  return atLow > kNoDistance ? Interval{low, crossing} : Interval{crossing, high};
}

/// A piece that the blade reaches all at once is seen only if it is no longer than a point, and
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
  explicit LayerFilter(const std::vector<PathChain>& chains)
      : chains_(chains), spans_(spansOf(chains)), visible_(chains.size()) {
    for (const Span& span : spans_) longest_ = std::max(longest_, span.length());
    for (std::size_t c = 0; c < chains.size(); ++c) visible_[c].resize(chains[c].pieces.size());
  }

  std::vector<PathChain> run() {
    for (const Span& span : spans_) visible_[span.chain][span.piece] = visibleParts(span);
    for (std::size_t c = 0; c < chains_.size(); ++c) rebuild(c);
    for (PathChain& chain : result_) direct(chain);
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

  /// The visible parts of a chain as chains of their own.
  void rebuild(std::size_t c) {
    const PathChain& chain = chains_[c];
    const std::size_t before = result_.size();
    bool goesOn = false;  // the last part reaches the end of its piece
    for (std::size_t p = 0; p < chain.pieces.size(); ++p) {
      std::vector<PathPiece> parts = partsOf(chain.pieces[p], visible_[c][p]);
      for (PathPiece& part : parts) {
        const bool joined = goesOn && part.from.node == chain.pieces[p].from.node;
        if (!joined) result_.emplace_back();
        goesOn = part.to.node == chain.pieces[p].to.node;
        result_.back().pieces.push_back(std::move(part));
      }
      if (parts.empty()) goesOn = false;
    }
    if (chain.closed && result_.size() > before) closeRing(chain, before, goesOn);
  }

  /// Joins the last part of a ring to the first, if they meet.
  void closeRing(const PathChain& chain, std::size_t first, bool goesOn) {
    PathChain& start = result_[first];
    if (!goesOn || start.pieces.front().from.node != chain.pieces.front().from.node) return;
    if (result_.size() == first + 1) {
      start.closed = true;
      return;
    }
    PathChain last = std::move(result_.back());
    result_.pop_back();
    PathChain& head = result_[first];
    head.pieces.insert(head.pieces.begin(), last.pieces.begin(), last.pieces.end());
  }

  static std::vector<PathPiece> partsOf(const PathPiece& piece,
                                        const std::vector<Interval>& times) {
    std::vector<PathPiece> parts;
    for (const Interval& time : times) {
      PathPiece part = piece;
      const bool forwards = piece.from.at.stroke <= piece.to.at.stroke;
      cut(piece, forwards ? time.low : time.high, part.from);
      cut(piece, forwards ? time.high : time.low, part.to);
      parts.push_back(part);
    }
    if (!parts.empty() && piece.from.at.stroke > piece.to.at.stroke) {
      std::reverse(parts.begin(), parts.end());
    }
    return parts;
  }

  /// Moves an end of a part to where the piece is at time `t`, unless it is there already.
  static void cut(const PathPiece& piece, double t, PathSample& end) {
    if (std::abs(end.at.stroke - t) <= kNoTime) return;
    const double part = (t - piece.from.at.stroke) / (piece.to.at.stroke - piece.from.at.stroke);
    end.node = {kNone, kNone, kNone};
    end.need = Need::kAlways;
    end.material = (1.0 - part) * piece.from.material + part * piece.to.material;
    end.position = (1.0 - part) * piece.from.position + part * piece.to.position;
    end.at.stroke = t;
    end.at.blade = (1.0 - part) * piece.from.at.blade + part * piece.to.at.blade;
  }

  const std::vector<PathChain>& chains_;
  std::vector<Span> spans_;
  double longest_ = 0.0;
  std::vector<std::vector<std::vector<Interval>>> visible_;  ///< by chain and piece
  std::vector<PathChain> result_;
};

}  // namespace

std::vector<PathChain> nearestParts(const std::vector<PathChain>& chains) {
  return LayerFilter(chains).run();
}

}  // namespace cloth_sim
