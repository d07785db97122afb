#include "spring_lines.h"

#include <algorithm>
#include <numeric>

namespace cloth_sim {
namespace {

/// A spring continues another one if the angle between them differs from a straight one by less
/// than 25 degrees.
constexpr double kStraight = -0.9;

using Ends = std::array<VertexId, 2>;  ///< a and b of a spring

/// The springs at each vertex, in compressed form.
struct Incidence {
  std::vector<std::int32_t> first;    ///< by vertex: index in `springs`; and one more
  std::vector<std::int32_t> springs;  ///< slots of the network

  Incidence(const std::vector<Ends>& ends, const std::vector<std::int32_t>& slots,
            std::int32_t vertices)
      : first(static_cast<std::size_t>(vertices) + 1, 0), springs(2 * slots.size()) {
    for (const std::int32_t s : slots) {
      for (const VertexId v : ends[s]) ++first[v + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::int32_t> next(first.begin(), first.end() - 1);
    for (const std::int32_t s : slots) {
      for (const VertexId v : ends[s]) springs[next[v]++] = s;
    }
  }
};

/// Finds which spring of a kind continues another one.
class Continuation {
 public:
  Continuation(const TriangleMesh& mesh, const std::vector<Ends>& ends,
               const std::vector<std::int32_t>& slots)
      : ends_(ends),
        at_(ends, slots, mesh.vertexCount()),
        next_(ends.size(), {kNone, kNone}),
        direction_(ends.size()) {
    const std::vector<Vec2>& material = mesh.material();
    for (const std::int32_t s : slots) {
      direction_[s] = (material[ends[s][1]] - material[ends[s][0]]).normalized();
    }
    for (VertexId v = 0; v < mesh.vertexCount(); ++v) joinAt(v);
  }

  /// The spring that goes on from `spring` at its end v, or kNone. The relation is mutual.
  std::int32_t next(std::int32_t spring, VertexId v) const {
    return next_[spring][ends_[spring][0] == v ? 0 : 1];
  }

 private:
  /// Joins the springs at a vertex of which each is the straightest continuation of the other.
  void joinAt(VertexId v) {
    const std::int32_t* const springs = at_.springs.data() + at_.first[v];
    const auto count = static_cast<std::size_t>(at_.first[v + 1] - at_.first[v]);
    away_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2& direction = direction_[springs[i]];
      away_.push_back(ends_[springs[i]][0] == v ? direction : Vec2(-direction));
    }
    straightest_.clear();
    for (std::size_t i = 0; i < count; ++i) straightest_.push_back(straightest(i));
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = straightest_[i];
      if (j != i && straightest_[j] == i) {
        next_[springs[i]][ends_[springs[i]][0] == v ? 0 : 1] = springs[j];
      }
    }
  }
  /// The straightest continuation of `away_[i]`; i if there is none.
  std::size_t straightest(std::size_t i) const {
    std::size_t best = i;
    double least = kStraight;
    for (std::size_t j = 0; j < away_.size(); ++j) {
      const double cosine = away_[i].dot(away_[j]);
      if (j == i || cosine >= least) continue;
      least = cosine;
      best = j;
    }
    return best;
  }

  const std::vector<Ends>& ends_;
  Incidence at_;
  std::vector<std::array<std::int32_t, 2>> next_;  ///< by spring, at its ends a and b
  std::vector<Vec2> direction_;                    ///< by spring, from a to b
  std::vector<Vec2> away_;                         ///< of the springs at a vertex, away from it
  std::vector<std::size_t> straightest_;           ///< continuation of each of these
};

}  // namespace

void SpringLines::build(const Model& model, const std::vector<std::int32_t>& slotOf) {
  colours_.clear();
  blocks_.clear();
  slots_.clear();
  springs_.clear();
  longest_ = 0;
  listSprings(model.springs);
  for (int kind = kSpringKinds - 1; kind >= 0; --kind) {  // structural springs last
    findLines(model.mesh, ofKind_[static_cast<std::size_t>(kind)]);
    appendColours(static_cast<SpringKind>(kind), slotOf);
  }
}

void SpringLines::listSprings(const SpringNetwork& springs) {
  ends_.clear();
  for (std::vector<std::int32_t>& slots : ofKind_) slots.clear();
  for (const Spring spring : springs.slots()) {
    const auto slot = static_cast<std::int32_t>(ends_.size());
    ends_.push_back({spring.a, spring.b});
    if (spring.exists()) ofKind_[static_cast<std::size_t>(spring.kind)].push_back(slot);
  }
}

VertexId SpringLines::otherEnd(std::int32_t spring, VertexId v) const {
  return ends_[spring][0] == v ? ends_[spring][1] : ends_[spring][0];
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
void SpringLines::findLines(const TriangleMesh& mesh, const std::vector<std::int32_t>& ofKind) {
  lines_.clear();
  lineSprings_.clear();
  const Continuation continuation(mesh, ends_, ofKind);
  std::vector<bool> isTaken(ends_.size(), false);
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
    for (const VertexId end : ends_[s]) {
      if (!isTaken[s] && continuation.next(s, end) == kNone) follow(s, end);
    }
  }
  for (const std::int32_t s : ofKind) {
    if (!isTaken[s]) follow(s, ends_[s][0]);
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
  Colour colour{static_cast<std::int32_t>(blocks_.size()), 0, kind};
  for (std::size_t k = 0; k < lines.size(); k += kWidth) {
    appendBlock(slotOf, lines.data() + k, std::min<std::size_t>(kWidth, lines.size() - k));
  }
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
