#include "spring_lines.h"

#include <algorithm>
#include <numeric>

namespace cloth_sim {
namespace {

/// A spring continues another one if the angle between them differs from a straight one by less
/// than 25 degrees.
constexpr double kStraight = -0.9;

/// The ends of a spring at one of its vertices, by vertex, in compressed form.
struct Incidence {
  std::vector<std::int32_t> first;    ///< by vertex: index in `springs`; and one more
  std::vector<std::int32_t> springs;  ///< slots of the network

  Incidence(const std::vector<Spring>& all, const std::vector<std::int32_t>& slots,
            std::int32_t vertices)
      : first(static_cast<std::size_t>(vertices) + 1, 0), springs(2 * slots.size()) {
    for (const std::int32_t s : slots) {
      ++first[all[s].a + 1];
      ++first[all[s].b + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::int32_t> next(first.begin(), first.end() - 1);
    for (const std::int32_t s : slots) {
      springs[next[all[s].a]++] = s;
      springs[next[all[s].b]++] = s;
    }
  }
};

/// Finds which spring of a kind continues another one.
class Continuation {
 public:
  Continuation(const TriangleMesh& mesh, const std::vector<Spring>& springs,
               const std::vector<std::int32_t>& slots)
      : mesh_(mesh),
        springs_(springs),
        at_(springs, slots, mesh.vertexCount()),
        next_(springs.size(), {kNone, kNone}) {
    for (VertexId v = 0; v < mesh.vertexCount(); ++v) joinAt(v);
  }

  /// The spring that goes on from `spring` at its end v, or kNone. The relation is mutual.
  std::int32_t next(std::int32_t spring, VertexId v) const {
    return next_[spring][springs_[spring].a == v ? 0 : 1];
  }

 private:
  /// Joins the springs at a vertex of which each is the straightest continuation of the other.
  void joinAt(VertexId v) {
    const std::int32_t* const springs = at_.springs.data() + at_.first[v];
    const auto count = static_cast<std::size_t>(at_.first[v + 1] - at_.first[v]);
    directions_.clear();
    for (std::size_t i = 0; i < count; ++i) directions_.push_back(directionFrom(v, springs[i]));
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = straightest(i);
      if (j != i && straightest(j) == i) {
        next_[springs[i]][springs_[springs[i]].a == v ? 0 : 1] = springs[j];
      }
    }
  }
  /// The straightest continuation of `directions_[i]`; i if there is none.
  std::size_t straightest(std::size_t i) const {
    std::size_t best = i;
    double least = kStraight;
    for (std::size_t j = 0; j < directions_.size(); ++j) {
      const double cosine = directions_[i].dot(directions_[j]);
      if (j == i || cosine >= least) continue;
      least = cosine;
      best = j;
    }
    return best;
  }
  Vec2 directionFrom(VertexId v, std::int32_t spring) const {
    const VertexId other = springs_[spring].a == v ? springs_[spring].b : springs_[spring].a;
    return (mesh_.material(other) - mesh_.material(v)).normalized();
  }

  const TriangleMesh& mesh_;
  const std::vector<Spring>& springs_;
  Incidence at_;
  std::vector<std::array<std::int32_t, 2>> next_;  ///< by spring, at its ends a and b
  std::vector<Vec2> directions_;                   ///< of the springs at a vertex, away from it
};

}  // namespace

void SpringLines::build(const Model& model, const std::vector<std::int32_t>& slotOf) {
  colours_.clear();
  blocks_.clear();
  slots_.clear();
  springs_.clear();
  longest_ = 0;
  all_.assign(model.springs.slots().begin(), model.springs.slots().end());
  for (const SpringKind kind : {SpringKind::kBend, SpringKind::kShear, SpringKind::kStructural}) {
    findLines(model.mesh, kind);
    appendColours(kind, slotOf);
  }
  all_ = {};
}

VertexId SpringLines::otherEnd(std::int32_t spring, VertexId v) const {
  return all_[spring].a == v ? all_[spring].b : all_[spring].a;
}

template <typename Visit>
void SpringLines::forParticles(const Line& line, const Visit& visit) const {
  VertexId v = line.start;
  visit(v);
  for (std::int32_t k = line.first; k < line.first + line.count; ++k) {
    v = otherEnd(lineSprings_[k], v);
    visit(v);
  }
}

/// Finds the lines of one kind: each begins at the end of a chain, or anywhere on a closed one.
void SpringLines::findLines(const TriangleMesh& mesh, SpringKind kind) {
  lines_.clear();
  lineSprings_.clear();
  std::vector<std::int32_t> ofKind;
  for (std::size_t s = 0; s < all_.size(); ++s) {
    if (all_[s].exists() && all_[s].kind == kind) ofKind.push_back(static_cast<std::int32_t>(s));
  }
  const Continuation continuation(mesh, all_, ofKind);
  std::vector<bool> isTaken(all_.size(), false);
  const auto follow = [&](std::int32_t spring, VertexId start) {
    Line line{static_cast<std::int32_t>(lineSprings_.size()), 0, start};
    VertexId v = start;
    while (spring != kNone && !isTaken[spring]) {
      isTaken[spring] = true;
      lineSprings_.push_back(spring);
      ++line.count;
      v = otherEnd(spring, v);
      spring = continuation.next(spring, v);
    }
    lines_.push_back(line);
  };
  for (const std::int32_t s : ofKind) {
    if (isTaken[s]) continue;
    for (const VertexId end : {all_[s].a, all_[s].b}) {
      if (!isTaken[s] && continuation.next(s, end) == kNone) follow(s, end);
    }
  }
  for (const std::int32_t s : ofKind) {
    if (!isTaken[s]) follow(s, all_[s].a);
  }
}

void SpringLines::appendColours(SpringKind kind, const std::vector<std::int32_t>& slotOf) {
  for (std::vector<Line>& lines : coloured(slotOf.size())) appendColour(kind, slotOf, lines);
}

/// Colours the lines found. A line that crosses itself, or lines of every colour, is divided into
/// its springs.
std::vector<std::vector<SpringLines::Line>> SpringLines::coloured(std::size_t vertices) const {
  std::vector<std::uint64_t> usedAt(vertices, 0);
  std::vector<std::int32_t> lastVisit(vertices, kNone);
  std::vector<std::vector<Line>> colours;
  std::vector<std::vector<Line>> alone;  // springs at a vertex with more than 64 of a kind
  std::int32_t visits = 0;
  const auto place = [&](const Line& line) {
    std::uint64_t used = 0;
    bool crossesItself = false;
    forParticles(line, [&](VertexId v) {
      used |= usedAt[v];
      crossesItself |= lastVisit[v] == visits;
      lastVisit[v] = visits;
    });
    ++visits;
    if (crossesItself || ~used == 0) return false;
    std::size_t colour = 0;
    while ((used >> colour & 1U) != 0) ++colour;
    forParticles(line, [&](VertexId v) { usedAt[v] |= std::uint64_t{1} << colour; });
    if (colour == colours.size()) colours.emplace_back();
    colours[colour].push_back(line);
    return true;
  };
  for (const Line& line : lines_) {
    if (place(line)) continue;
    Line single{line.first, 1, line.start};
    for (; single.first < line.first + line.count; ++single.first) {
      if (!place(single)) alone.push_back({single});
      single.start = otherEnd(lineSprings_[single.first], single.start);
    }
  }
  colours.insert(colours.end(), alone.begin(), alone.end());
  return colours;
}

/// Appends the lines of a colour in SIMD blocks of lines of similar lengths.
void SpringLines::appendColour(SpringKind kind, const std::vector<std::int32_t>& slotOf,
                               std::vector<Line>& lines) {
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
    constexpr std::int32_t kSimilar = 16;  // lengths that may stand side by side
    const std::int32_t classA = a.count / kSimilar, classB = b.count / kSimilar;
    return classA != classB ? classA > classB : a.start < b.start;
  });
  Colour colour{static_cast<std::int32_t>(blocks_.size()), 0, 0, kind};
  for (std::size_t k = 0; k < lines.size(); k += kWidth) {
    appendBlock(slotOf, lines.data() + k, std::min<std::size_t>(kWidth, lines.size() - k));
  }
  for (const Line& line : lines) colour.springs += line.count;
  colour.endBlock = static_cast<std::int32_t>(blocks_.size());
  colours_.push_back(colour);
}

/// Appends up to kWidth lines.
void SpringLines::appendBlock(const std::vector<std::int32_t>& slotOf, const Line* lines,
                              std::size_t count) {
  SimdBlock block;
  block.firstStep = static_cast<std::int32_t>(springs_.size());
  block.firstPlace = static_cast<std::int32_t>(slots_.size());
  for (std::size_t lane = 0; lane < count; ++lane) {
    block.steps = std::max(block.steps, lines[lane].count);
  }
  Slots none;
  none.fill(kNone);
  springs_.resize(springs_.size() + static_cast<std::size_t>(block.steps), none);
  slots_.resize(slots_.size() + static_cast<std::size_t>(block.steps) + 1, none);
  Slots* const at = slots_.data() + block.firstPlace;
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    const Line& line = lines[std::min(lane, count - 1)];
    std::int32_t place = 0;
    forParticles(line, [&](VertexId v) { at[place++][lane] = slotOf[v]; });
    for (; place <= block.steps; ++place) at[place][lane] = at[place - 1][lane];
    if (lane >= count) continue;
    for (std::int32_t s = 0; s < line.count; ++s) {
      springs_[block.firstStep + s][lane] = lineSprings_[line.first + s];
    }
  }
  longest_ = std::max(longest_, block.steps);
  blocks_.push_back(block);
}

}  // namespace cloth_sim
