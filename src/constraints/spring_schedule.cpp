#include "spring_schedule.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "graph_colouring.h"

namespace cloth_sim {
namespace {

/// Springs in a block of the overflow.
constexpr std::size_t kOverflowBlock = 512;
/// A block that waits for more blocks than this might as well wait for all of a phase.
constexpr std::size_t kMostDependencies = 16;

/// Springs of one colour in ascending order of their first ends, of which no two are the same.
std::vector<std::int32_t> sortedByFirstEnd(const std::vector<SpringEnds>& ends,
                                           const std::vector<std::int32_t>& slots) {
  std::int32_t low = std::numeric_limits<std::int32_t>::max();
  std::int32_t high = -1;
  for (const std::int32_t slot : slots) {
    low = std::min(low, ends[slot].a);
    high = std::max(high, ends[slot].a);
  }
  std::vector<std::int32_t> at(static_cast<std::size_t>(std::max(0, high - low + 1)), kNone);
  for (const std::int32_t slot : slots) at[ends[slot].a - low] = slot;
  at.erase(std::remove(at.begin(), at.end(), kNone), at.end());
  return at;
}

}  // namespace

// ---- the undamaged mesh -----------------------------------------------------------------------

void SpringSchedule::build(const Model& model, const std::vector<std::int32_t>& slotOf) {
  truncate({});
  patterns_ = {};
  positionOf_.assign(model.springs.slots().size(), kNone);
  isOverflow_.clear();
  appendOriginals(model, slotOf);
  original_ = extent();
  buildPhases();
}

SpringSchedule::Extent SpringSchedule::extent() const {
  return {endA.size(), parameters.size(), spans_.size(), blocks_.size(), groups_.size()};
}

void SpringSchedule::truncate(const Extent& extent) {
  endA.resize(extent.ends);
  endB.resize(extent.ends);
  parameters.resize(extent.parameters);
  spans_.resize(extent.spans);
  blocks_.resize(extent.blocks);
  groups_.resize(extent.groups);
}

void SpringSchedule::appendOriginals(const Model& model, const std::vector<std::int32_t>& slotOf) {
  std::vector<SpringEnds> ends;
  ends.reserve(model.springs.slots().size());
  for (const Spring& spring : model.springs.slots()) {
    ends.push_back(spring.exists() ? SpringEnds{slotOf[spring.a], slotOf[spring.b]} : SpringEnds{});
  }
  std::vector<std::int32_t> all(ends.size());
  std::iota(all.begin(), all.end(), 0);
  const std::int32_t particles = *std::max_element(slotOf.begin(), slotOf.end()) + 1;
  forColourGroups(colourSprings(model, all), ends, particles, [&](const ColourGroupBlocks& blocks) {
    ColourGroup group;
    const std::int32_t before = size();
    group.firstBlock = static_cast<std::int32_t>(blocks_.size());
    for (const Coloured& block : blocks) appendBlock(model.springs, ends, block);
    group.endBlock = static_cast<std::int32_t>(blocks_.size());
    group.springs = size() - before;
    groups_.push_back(group);
  });
}

void SpringSchedule::appendBlock(const SpringNetwork& springs, const std::vector<SpringEnds>& ends,
                                 const Coloured& colours) {
  Block block;
  block.firstSpan = static_cast<std::int32_t>(spans_.size());
  for (const std::vector<std::int32_t>& slots : colours) appendColour(springs, ends, slots);
  block.endSpan = static_cast<std::int32_t>(spans_.size());
  blocks_.push_back(block);
}

/// Appends contiguous spans as long as they go, and one gathered span of what is left.
void SpringSchedule::appendColour(const SpringNetwork& springs, const std::vector<SpringEnds>& ends,
                                  const std::vector<std::int32_t>& slots) {
  const std::vector<std::int32_t> sorted = sortedByFirstEnd(ends, slots);
  const auto endsOfSlot = [&](std::int32_t slot) { return ends[slot]; };
  const auto follows = [&](std::int32_t s, std::int32_t t) {
    return ends[t].a == ends[s].a + 1 && ends[t].b == ends[s].b + 1;
  };
  const auto append = [&](const std::int32_t* begin, const std::int32_t* end, bool isContiguous) {
    std::int32_t position = size();
    for (const std::int32_t* slot = begin; slot != end; ++slot) positionOf_[*slot] = position++;
    appendSpan(springs, endsOfSlot, begin, end, isContiguous);
  };
  std::vector<std::int32_t> others;
  const std::int32_t* const last = sorted.data() + sorted.size();
  for (const std::int32_t* begin = sorted.data(); begin != last;) {
    const std::int32_t* end = begin + 1;
    while (end != last && follows(*(end - 1), *end)) ++end;
    if (end - begin >= kShortestContiguous) {
      append(begin, end, true);
    } else {
      others.insert(others.end(), begin, end);
    }
    begin = end;
  }
  append(others.data(), others.data() + others.size(), false);
}

template <typename EndsOf>
void SpringSchedule::appendSpan(const SpringNetwork& springs, const EndsOf& endsOfSlot,
                                const std::int32_t* slot, const std::int32_t* end,
                                bool isContiguous) {
  if (slot == end) return;
  Span span;
  span.first = size();
  span.count = static_cast<std::int32_t>(end - slot);
  span.isContiguous = isContiguous;
  span.firstEnd = static_cast<std::int32_t>(endA.size());
  const auto parametersAt = [&](std::int32_t k) { return springs[slot[k]].parameters(); };
  std::int32_t shared = kNone;
  if (isContiguous) {
    span.ends = endsOfSlot(*slot);
    shared = patterns_.place(span.count, parametersAt, parameters);
  }
  span.sharesParameters = shared != kNone;
  span.firstParameters =
      span.sharesParameters ? shared : static_cast<std::int32_t>(parameters.size());
  for (std::int32_t k = 0; k < span.count; ++k) {
    if (!span.sharesParameters) parameters.append(parametersAt(k));
    if (isContiguous) continue;
    const SpringEnds ends = endsOfSlot(slot[k]);
    endA.push_back(ends.a);
    endB.push_back(ends.b);
  }
  spans_.push_back(span);
}

// ---- phases -----------------------------------------------------------------------------------

std::vector<SpringSchedule::SlotRange> SpringSchedule::slotRanges() const {
  std::vector<SlotRange> ranges;
  for (const Block& block : blocks_) {
    SlotRange range{std::numeric_limits<std::int32_t>::max(), -1};
    for (std::int32_t s = block.firstSpan; s < block.endSpan; ++s) {
      const Span& span = spans_[s];
      const std::int32_t stride = span.isContiguous ? span.count - 1 : 1;  // the first and the last
      for (std::int32_t k = 0; k < span.count; k += stride) {
        const SpringEnds ends = endsOf(span, k);
        range.first = std::min({range.first, ends.a, ends.b});
        range.last = std::max({range.last, ends.a, ends.b});
      }
    }
    ranges.push_back(range);
  }
  return ranges;
}

/// The blocks of the last phase, before `group`, that `block` may share particles with; as tasks.
std::vector<std::int32_t> SpringSchedule::dependenciesOf(
    std::int32_t block, const ColourGroup& group, const std::vector<SlotRange>& ranges) const {
  std::vector<std::int32_t> dependencies;
  const Phase& phase = phases_.back();
  for (std::int32_t earlier = phase.firstBlock; earlier < group.firstBlock; ++earlier) {
    if (ranges[block].overlaps(ranges[earlier])) {
      dependencies.push_back(earlier - phase.firstBlock);
    }
  }
  return dependencies;
}

/// A group begins a new phase where one of its blocks would wait for too many others.
void SpringSchedule::buildPhases() {
  phases_.clear();
  const std::vector<SlotRange> ranges = slotRanges();
  for (const ColourGroup& group : groups_) {
    bool isNew = phases_.empty();
    for (std::int32_t b = group.firstBlock; b < group.endBlock && !isNew; ++b) {
      isNew = dependenciesOf(b, group, ranges).size() > kMostDependencies;
    }
    if (isNew) phases_.push_back({group.firstBlock, group.firstBlock, 0, {}});
    Phase& phase = phases_.back();
    phase.endBlock = group.endBlock;
    phase.springs += group.springs;
    TaskGraph& tasks = phase.tasks;
    tasks.groupEnds.push_back(group.endBlock - phase.firstBlock);
    for (std::int32_t b = group.firstBlock; b < group.endBlock; ++b) {
      const std::vector<std::int32_t> dependencies = dependenciesOf(b, group, ranges);
      tasks.predecessors.insert(tasks.predecessors.end(), dependencies.begin(), dependencies.end());
      tasks.predecessorEnds.push_back(static_cast<std::int32_t>(tasks.predecessors.size()));
    }
  }
}

// ---- edits ------------------------------------------------------------------------------------

void SpringSchedule::applyChanges(const Model& model, const SpringChanges& changes,
                                  const std::vector<std::int32_t>& slotOf) {
  isOverflow_.resize(model.springs.slots().size(), false);
  truncate(original_);
  for (const auto* slots : {&changes.removed, &changes.modified, &changes.added}) {
    for (const std::int32_t slot : *slots) updatePlace(model.springs[slot], slot, slotOf);
  }
  const bool haveMostChanged = 2 * changes.modified.size() > isOverflow_.size();
  if (haveMostChanged) shareParametersAgain();
  original_ = extent();
  std::vector<std::int32_t> overflow;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(isOverflow_.size()); ++slot) {
    if (isOverflow_[slot]) overflow.push_back(slot);
  }
  appendOverflow(model, slotOf, colourSprings(model, overflow));
}

/// Puts a spring where the undamaged mesh had it, if its ends are the same; counts it among the
/// overflow if they are not. A spring that is gone leaves its place without stiffness.
void SpringSchedule::updatePlace(const Spring& spring, std::int32_t slot,
                                 const std::vector<std::int32_t>& slotOf) {
  const bool isOriginal = slot < static_cast<std::int32_t>(positionOf_.size());
  const std::int32_t position = isOriginal ? positionOf_[slot] : kNone;
  bool keepsPlace = false;
  if (position != kNone) {
    const auto isBefore = [](std::int32_t p, const Span& span) { return p < span.first; };
    Span& span = *(std::upper_bound(spans_.begin(), spans_.end(), position, isBefore) - 1);
    const SpringEnds ends = endsOf(span, position - span.first);
    keepsPlace = spring.exists() && ends.a == slotOf[spring.a] && ends.b == slotOf[spring.b];
    setParameters(keepsPlace ? spring.parameters() : SpringParameters{}, span,
                  position - span.first);
  }
  isOverflow_[slot] = spring.exists() && !keepsPlace;
}

void SpringSchedule::setParameters(const SpringParameters& spring, Span& span, std::int32_t k) {
  if (parametersOf(span, k) == spring) return;
  if (span.sharesParameters) unshareParameters(span);
  parameters.set(span.firstParameters + k, spring);
}

/// Gives a span parameters of its own.
void SpringSchedule::unshareParameters(Span& span) {
  const Span before = span;
  span.firstParameters = static_cast<std::int32_t>(parameters.size());
  span.sharesParameters = false;
  for (std::int32_t k = 0; k < span.count; ++k) parameters.append(parametersOf(before, k));
}

/// Finds shared sequences anew and drops parameters that no span has.
void SpringSchedule::shareParametersAgain() {
  SpringParameterTable table;
  patterns_ = {};
  for (Span& span : spans_) {
    const Span before = span;
    const auto parametersAt = [&](std::int32_t k) { return parametersOf(before, k); };
    const std::int32_t shared =
        span.isContiguous ? patterns_.place(span.count, parametersAt, table) : kNone;
    span.sharesParameters = shared != kNone;
    span.firstParameters = span.sharesParameters ? shared : static_cast<std::int32_t>(table.size());
    for (std::int32_t k = 0; k < span.count && !span.sharesParameters; ++k) {
      table.append(parametersAt(k));
    }
  }
  parameters = std::move(table);
}

void SpringSchedule::appendOverflow(const Model& model, const std::vector<std::int32_t>& slotOf,
                                    const Coloured& colours) {
  const auto endsOfSlot = [&](std::int32_t slot) {
    const Spring& spring = model.springs[slot];
    return SpringEnds{slotOf[spring.a], slotOf[spring.b]};
  };
  for (const std::vector<std::int32_t>& slots : colours) {
    ColourGroup group;
    group.firstBlock = static_cast<std::int32_t>(blocks_.size());
    group.springs = static_cast<std::int32_t>(slots.size());
    for (std::size_t first = 0; first < slots.size(); first += kOverflowBlock) {
      const std::size_t end = std::min(first + kOverflowBlock, slots.size());
      Block block;
      block.firstSpan = static_cast<std::int32_t>(spans_.size());
      appendSpan(model.springs, endsOfSlot, slots.data() + first, slots.data() + end, false);
      block.endSpan = static_cast<std::int32_t>(spans_.size());
      blocks_.push_back(block);
    }
    group.endBlock = static_cast<std::int32_t>(blocks_.size());
    groups_.push_back(group);
  }
}

}  // namespace cloth_sim
