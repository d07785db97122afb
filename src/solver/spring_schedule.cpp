#include "cloth_sim/solver/spring_schedule.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <map>
#include <numeric>

namespace cloth_sim {
namespace {

/// Shorter stretches are not worth a loop of their own.
constexpr std::int32_t kShortestRun = 8;
/// Absorbs rounding in material coordinates when they are divided by a spacing.
constexpr double kGridTolerance = 1e-6;
/// Springs in a strand, if there are as many. A strand shall stay in the first-level cache, but not
/// be so short that a colour loads what the colour before it has hardly stored.
constexpr std::size_t kStrandSprings = 4096;
/// ... and more strands in a batch than this have nothing for them but their ends.
constexpr std::size_t kMostStrands = 64;
/// ... of those that edits made.
constexpr std::size_t kLaterStrand = 512;
/// A batch that falls apart into fewer sets leaves threads idle.
constexpr std::int32_t kFewestSets = 16;

/// On a grid two colours suffice for parallel springs of one kind. Colours that are to be joined
/// into a batch are numbered one after the other: first those within rows, then those between rows
/// 2k and 2k + 1, then those between rows 2k + 1 and 2k + 2, then those over two rows.
int colourOf(const Model& model, const Spring& spring, int parity) {
  const bool bend = spring.kind == SpringKind::kBend;
  const Vec2 d = model.mesh.material(spring.b) - model.mesh.material(spring.a);
  switch (spring.direction) {
    case ThreadDirection::kWarp:
      return (bend ? 2 : 0) + parity;
    case ThreadDirection::kWeft:
      return bend ? 10 + parity : 4 + 3 * parity;
    case ThreadDirection::kBias:
      return (d.x() * d.y() > 0.0 ? 5 : 6) + 3 * parity;
  }
  return 0;
}

/// The colour that a spring would have on a grid, from its place in material coordinates.
int gridColour(const Model& model, const Spring& spring) {
  const Vec2& p = model.mesh.material(spring.a);
  const Vec2& q = model.mesh.material(spring.b);
  const int axis = spring.direction == ThreadDirection::kWarp ? 0 : 1;
  const double origin = axis == 0 ? model.cloths[model.clothOf(spring.a)].materialOffset : 0.0;
  const double low = std::min(p[axis], q[axis]) - origin;
  const double extent = std::abs(q[axis] - p[axis]);
  const auto cell = static_cast<long>(std::floor(low / extent + kGridTolerance));
  return colourOf(model, spring, static_cast<int>(cell & 1));
}

/// Greedy colouring that prefers a given colour where it is free.
class Colouring {
 public:
  explicit Colouring(std::int32_t particles) : place_(static_cast<std::size_t>(particles), kNone) {}

  int pick(const Spring& spring, int preferred) {
    const std::size_t first = placeOf(spring.a);
    const std::size_t second = placeOf(spring.b);
    Used& a = used_[first];
    Used& b = used_[second];
    int colour = preferred;
    if (a[colour] || b[colour]) {
      colour = 0;
      while (a[colour] || b[colour]) ++colour;
    }
    a[colour] = b[colour] = true;
    return colour;
  }

 private:
  /// Twice the springs that a particle can reasonably have.
  using Used = std::bitset<512>;

  std::size_t placeOf(VertexId v) {
    if (place_[v] == kNone) {
      place_[v] = static_cast<std::int32_t>(used_.size());
      used_.emplace_back();
    }
    return static_cast<std::size_t>(place_[v]);
  }

  std::vector<std::int32_t> place_;  ///< in used_, by particle
  std::vector<Used> used_;           ///< of particles that have been seen
};

/// Particles joined by springs into connected sets.
class Sets {
 public:
  explicit Sets(std::int32_t particles) : parent_(static_cast<std::size_t>(particles), kNone) {}

  /// The smallest particle of the set.
  std::int32_t rootOf(std::int32_t p) const {
    while (parent_[p] != p) p = parent_[p];
    return p;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  std::int32_t count() const { return count_; }

 private:
  std::int32_t find(std::int32_t p) {
    if (parent_[p] == kNone) {
      parent_[p] = p;
      ++count_;
    }
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }

  std::vector<std::int32_t> parent_;  ///< kNone: not seen yet
  std::int32_t count_ = 0;
};

}  // namespace

void SpringSchedule::build(const Model& model, const std::vector<std::int32_t>& slotOf) {
  truncate({});
  originalSlots_ = static_cast<std::int32_t>(model.springs.slots().size());
  std::vector<std::int32_t> all(originalSlots_);
  std::iota(all.begin(), all.end(), 0);
  position_.assign(originalSlots_, kNone);
  append(model, slotOf, colour(model, all));
  originalPosition_ = position_;
  original_ = {endA.size(), spans_.size(), strands_.size(), batches_.size()};
}

void SpringSchedule::follow(const Model& model, const SpringChanges& changes,
                            const std::vector<std::int32_t>& slotOf) {
  position_.resize(model.springs.slots().size(), kNone);
  isAppended_.resize(model.springs.slots().size(), false);
  for (const auto* slots : {&changes.removed, &changes.modified, &changes.added}) {
    for (std::int32_t slot : *slots) settle(model.springs[slot], slot, slotOf);
  }
  truncate(original_);
  std::vector<std::int32_t> appended;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(isAppended_.size()); ++slot) {
    if (isAppended_[slot]) appended.push_back(slot);
  }
  appendLater(model, slotOf, colour(model, appended));
}

void SpringSchedule::settle(const Spring& spring, std::int32_t slot,
                            const std::vector<std::int32_t>& slotOf) {
  const std::int32_t home = slot < originalSlots_ ? originalPosition_[slot] : kNone;
  const bool atHome = spring.exists() && home != kNone && endA[home] == slotOf[spring.a] &&
                      endB[home] == slotOf[spring.b];
  if (atHome) {
    place(spring, home, slotOf);
    position_[slot] = home;
  } else if (home != kNone) {
    stiffness[home] = damping[home] = 0.0;
  }
  isAppended_[slot] = spring.exists() && !atHome;
}

SpringSchedule::Coloured SpringSchedule::colour(const Model& model,
                                                const std::vector<std::int32_t>& slots) const {
  Coloured colours;
  Colouring colouring(model.particleCount());
  for (std::int32_t slot : slots) {
    const Spring& spring = model.springs[slot];
    if (!spring.exists()) continue;
    const auto chosen = static_cast<std::size_t>(colouring.pick(spring, gridColour(model, spring)));
    if (colours.size() <= chosen) colours.resize(chosen + 1);
    colours[chosen].push_back(slot);
  }
  return colours;
}

/// Springs of a colour share no particle: they may be swept in any order, or at once.
void SpringSchedule::appendLater(const Model& model, const std::vector<std::int32_t>& slotOf,
                                 const Coloured& colours) {
  for (const std::vector<std::int32_t>& slots : colours) {
    if (slots.empty()) continue;
    Batch batch;
    batch.firstStrand = static_cast<std::int32_t>(strands_.size());
    batch.springs = static_cast<std::int32_t>(slots.size());
    for (std::size_t first = 0; first < slots.size(); first += kLaterStrand) {
      const std::size_t end = std::min(first + kLaterStrand, slots.size());
      Strand strand;
      strand.firstSpan = static_cast<std::int32_t>(spans_.size());
      appendSpan(model.springs, slotOf, {slots.begin() + first, slots.begin() + end}, false);
      strand.endSpan = static_cast<std::int32_t>(spans_.size());
      strands_.push_back(strand);
    }
    batch.endStrand = static_cast<std::int32_t>(strands_.size());
    batches_.push_back(batch);
  }
}

void SpringSchedule::append(const Model& model, const std::vector<std::int32_t>& slotOf,
                            Coloured colours) {
  const SpringNetwork& springs = model.springs;
  const std::int32_t particles = *std::max_element(slotOf.begin(), slotOf.end()) + 1;
  const auto joinAll = [&](Sets& sets, const std::vector<std::int32_t>& slots) {
    for (std::int32_t slot : slots) sets.join(slotOf[springs[slot].a], slotOf[springs[slot].b]);
  };
  for (std::size_t first = 0; first < colours.size();) {
    Sets sets(particles);
    joinAll(sets, colours[first]);
    std::size_t end = first + 1;
    for (; end < colours.size(); ++end) {
      Sets joined = sets;
      joinAll(joined, colours[end]);
      if (joined.count() < std::min(kFewestSets, sets.count())) break;
      sets = std::move(joined);
    }
    std::map<std::int32_t, Coloured> byRoot;
    for (std::size_t c = first; c < end; ++c) {
      for (std::int32_t slot : colours[c]) {
        Coloured& set = byRoot[sets.rootOf(slotOf[springs[slot].a])];
        set.resize(end - first);
        set[c - first].push_back(slot);
      }
    }
    std::size_t springsOfBatch = 0;
    for (std::size_t c = first; c < end; ++c) springsOfBatch += colours[c].size();
    const std::size_t enough = std::max(kStrandSprings, springsOfBatch / kMostStrands);
    Batch batch;
    const std::int32_t before = size();
    batch.firstStrand = static_cast<std::int32_t>(strands_.size());
    Coloured strand(end - first);
    for (auto set = byRoot.begin(); set != byRoot.end();) {
      std::size_t count = 0;
      for (std::size_t c = 0; c < strand.size(); ++c) {
        strand[c].insert(strand[c].end(), set->second[c].begin(), set->second[c].end());
        count += strand[c].size();
      }
      if (++set != byRoot.end() && count < enough) continue;
      appendStrand(springs, slotOf, strand);
      for (std::vector<std::int32_t>& slots : strand) slots.clear();
    }
    batch.endStrand = static_cast<std::int32_t>(strands_.size());
    batch.springs = size() - before;
    if (batch.springs > 0) batches_.push_back(batch);
    first = end;
  }
}

void SpringSchedule::appendStrand(const SpringNetwork& springs,
                                  const std::vector<std::int32_t>& slotOf,
                                  const Coloured& colours) {
  Strand strand;
  strand.firstSpan = static_cast<std::int32_t>(spans_.size());
  for (const std::vector<std::int32_t>& slots : colours) appendColour(springs, slotOf, slots);
  strand.endSpan = static_cast<std::int32_t>(spans_.size());
  strands_.push_back(strand);
}

void SpringSchedule::appendColour(const SpringNetwork& springs,
                                  const std::vector<std::int32_t>& slotOf,
                                  const std::vector<std::int32_t>& slots) {
  std::vector<std::int32_t> sorted = slots;
  std::sort(sorted.begin(), sorted.end(), [&](std::int32_t s, std::int32_t t) {
    return slotOf[springs[s].a] < slotOf[springs[t].a];
  });
  const auto follows = [&](std::int32_t s, std::int32_t t) {
    return slotOf[springs[t].a] == slotOf[springs[s].a] + 1 &&
           slotOf[springs[t].b] == slotOf[springs[s].b] + 1;
  };
  std::vector<std::int32_t> singles;
  for (auto at = sorted.begin(); at != sorted.end();) {
    auto stop = at + 1;
    while (stop != sorted.end() && follows(*(stop - 1), *stop)) ++stop;
    if (stop - at >= kShortestRun) {
      appendSpan(springs, slotOf, {at, stop}, true);
    } else {
      singles.insert(singles.end(), at, stop);
    }
    at = stop;
  }
  if (!singles.empty()) appendSpan(springs, slotOf, singles, false);
}

void SpringSchedule::appendSpan(const SpringNetwork& springs,
                                const std::vector<std::int32_t>& slotOf,
                                const std::vector<std::int32_t>& slots, bool isRun) {
  spans_.push_back({size(), static_cast<std::int32_t>(slots.size()), isRun});
  for (std::int32_t slot : slots) {
    const std::int32_t position = size();
    position_[slot] = position;
    endA.push_back(kNone);
    endB.push_back(kNone);
    restLength.push_back(0.0);
    stiffness.push_back(0.0);
    damping.push_back(0.0);
    place(springs[slot], position, slotOf);
  }
}

void SpringSchedule::place(const Spring& spring, std::int32_t position,
                           const std::vector<std::int32_t>& slotOf) {
  endA[position] = slotOf[spring.a];
  endB[position] = slotOf[spring.b];
  restLength[position] = spring.restLength;
  stiffness[position] = spring.stiffness;
  damping[position] = spring.damping;
  if (spring.damping > 0.0) damped = true;
}

void SpringSchedule::truncate(const Extent& extent) {
  endA.resize(extent.positions);
  endB.resize(extent.positions);
  restLength.resize(extent.positions);
  stiffness.resize(extent.positions);
  damping.resize(extent.positions);
  spans_.resize(extent.spans);
  strands_.resize(extent.strands);
  batches_.resize(extent.batches);
}

}  // namespace cloth_sim
