#include "spring_schedule.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "connected_sets.h"
#include "graph_colouring.h"

namespace cloth_sim {
namespace {

/// Springs in a strand, if there are as many. A strand shall stay in the first-level cache, but not
/// be so short that a colour loads what the colour before it has hardly stored.
constexpr std::size_t kStrandSprings = 4096;
/// ... and more strands in a batch than this have nothing for them but their ends.
constexpr std::size_t kMostStrands = 64;
/// ... of those that edits made.
constexpr std::size_t kLaterStrand = 512;
/// A batch that falls apart into fewer sets leaves threads idle. One whose sets reach further than
/// this part of all particles makes them wait for each other's caches: what one thread has moved in
/// this batch, another one moves in the next.
constexpr std::int32_t kFewestSets = 16;
/// Who waits for more others might as well wait for all.
constexpr std::size_t kMostWaits = 16;

/// How many strands a batch has. Of a cloth that threads share, if more than one four or a multiple
/// of it, so that two of them share every batch at about the same row, and have something to do
/// while the strands at that row wait for each other.
std::size_t strandsFor(std::size_t springs, bool isShared) {
  const std::size_t strands = (springs + kStrandSprings - 1) / kStrandSprings;
  if (!isShared) return strands;
  if (springs <= kStrandSprings / 4) return 1;
  return std::min((strands + 3) / 4 * 4, kMostStrands);
}

/// Springs of one colour by the place of their first ends, of which no two are the same.
std::vector<std::int32_t> sortedByFirstEnd(const std::vector<SpringSchedule::Ends>& ends,
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

/// The first spring from `begin` on that has another parameters than that one, or the end.
const std::int32_t* endOfEqualParameters(const SpringNetwork& springs, const std::int32_t* begin,
                                         const std::int32_t* end) {
  const SpringParameters parameters = springs[*begin].parameters();
  return std::find_if(begin + 1, end, [&](std::int32_t slot) {
    return !(springs[slot].parameters() == parameters);
  });
}

/// Which strand a set of springs goes to.
struct Strands {
  std::size_t count = 0;
  std::vector<std::size_t> byRoot;
};

/// Divides springs into strands of about the same size, whole sets in the order of their roots.
template <typename Colours, typename RootOf>
Strands divide(Colours begin, Colours end, bool isShared, const RootOf& rootOf) {
  std::vector<std::size_t> number;  // of springs, by root
  std::size_t all = 0;
  for (auto colour = begin; colour != end; ++colour) {
    for (const std::int32_t slot : *colour) {
      const auto root = static_cast<std::size_t>(rootOf(slot));
      if (number.size() <= root) number.resize(root + 1, 0);
      ++number[root];
    }
    all += colour->size();
  }
  Strands strands;
  strands.byRoot.resize(number.size());
  const std::size_t count = strandsFor(all, isShared);
  std::size_t taken = 0;
  std::size_t before = 0;  // in earlier strands
  for (std::size_t root = 0; root < number.size(); ++root) {
    const bool isTooMany = (taken + number[root]) * count > all * (strands.count + 1);
    if (isTooMany && taken > before) {
      before = taken;
      ++strands.count;
    }
    strands.byRoot[root] = strands.count;
    taken += number[root];
  }
  ++strands.count;
  return strands;
}

}  // namespace

SpringSchedule::Extent SpringSchedule::extent() const {
  return {endA.size(), parameters.size(), spans_.size(), strands_.size(), batches_.size()};
}

void SpringSchedule::truncate(const Extent& extent) {
  endA.resize(extent.others);
  endB.resize(extent.others);
  parameters.resize(extent.parameters);
  spans_.resize(extent.spans);
  strands_.resize(extent.strands);
  batches_.resize(extent.batches);
}

void SpringSchedule::build(const Model& model, const std::vector<std::int32_t>& slotOf) {
  truncate({});
  patterns_ = {};
  std::vector<std::int32_t> all(model.springs.slots().size());
  std::iota(all.begin(), all.end(), 0);
  home_.assign(all.size(), kNone);
  isAppended_.clear();
  append(model, slotOf, colourSprings(model, all));
  original_ = extent();
  std::vector<Reach> reach = reaches();
  divideSlots(*std::max_element(slotOf.begin(), slotOf.end()) + 1, reach);
  orderWave(reach);
  orderRounds(reach);
}

void SpringSchedule::follow(const Model& model, const SpringChanges& changes,
                            const std::vector<std::int32_t>& slotOf) {
  isAppended_.resize(model.springs.slots().size(), false);
  truncate(original_);
  for (const auto* slots : {&changes.removed, &changes.modified, &changes.added}) {
    for (std::int32_t slot : *slots) settle(model.springs[slot], slot, slotOf);
  }
  // Where nearly all have changed, runs may have one parameters as before.
  if (2 * changes.modified.size() > isAppended_.size()) gatherParameters();
  original_ = extent();
  std::vector<std::int32_t> appended;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(isAppended_.size()); ++slot) {
    if (isAppended_[slot]) appended.push_back(slot);
  }
  appendLater(model, slotOf, colourSprings(model, appended));
}

void SpringSchedule::settle(const Spring& spring, std::int32_t slot,
                            const std::vector<std::int32_t>& slotOf) {
  const std::int32_t home = slot < static_cast<std::int32_t>(home_.size()) ? home_[slot] : kNone;
  bool atHome = false;
  if (home != kNone) {
    const auto before = [](std::int32_t position, const Span& s) { return position < s.first; };
    Span& span = *(std::upper_bound(spans_.begin(), spans_.end(), home, before) - 1);
    const Ends ends = endsOf(span, home - span.first);
    atHome = spring.exists() && ends.a == slotOf[spring.a] && ends.b == slotOf[spring.b];
    setParameters(atHome ? spring.parameters() : SpringParameters{}, span, home - span.first);
  }
  isAppended_[slot] = spring.exists() && !atHome;
}

void SpringSchedule::setParameters(const SpringParameters& of, Span& span, std::int32_t k) {
  if (parametersOf(span, k) == of) return;
  if (span.isUniform || span.sharesParameters) separateParameters(span);
  parameters.set(span.firstParameters + k, of);
}

/// Gives every spring of a run a parameters of its own.
void SpringSchedule::separateParameters(Span& span) {
  const Span before = span;
  span.firstParameters = static_cast<std::int32_t>(parameters.size());
  span.isUniform = false;
  span.sharesParameters = false;
  for (std::int32_t k = 0; k < span.count; ++k) parameters.append(parametersOf(before, k));
}

/// Keeps one parameters for every run that has no other, and none that nobody has.
void SpringSchedule::gatherParameters() {
  SpringParameterTable gathered;
  patterns_ = {};
  for (Span& span : spans_) {
    const Span before = span;
    const auto lawAt = [&](std::int32_t k) { return parametersOf(before, k); };
    span.isUniform = span.isRun;
    for (std::int32_t k = 1; k < span.count; ++k) {
      span.isUniform = span.isUniform && lawAt(k) == lawAt(0);
    }
    const bool mayShare = span.isRun && !span.isUniform;
    const std::int32_t shared = mayShare ? patterns_.place(span.count, lawAt, gathered) : kNone;
    span.sharesParameters = shared != kNone;
    span.firstParameters =
        span.sharesParameters ? shared : static_cast<std::int32_t>(gathered.size());
    if (span.sharesParameters) continue;
    for (std::int32_t k = 0; k < (span.isUniform ? 1 : span.count); ++k) gathered.append(lawAt(k));
  }
  parameters = std::move(gathered);
}

/// Springs of a colour share no particle: they may be swept in any order, or at once.
void SpringSchedule::appendLater(const Model& model, const std::vector<std::int32_t>& slotOf,
                                 const Coloured& colours) {
  const auto endsOf = [&](std::int32_t slot) {
    const Spring& spring = model.springs[slot];
    return Ends{slotOf[spring.a], slotOf[spring.b]};
  };
  for (const std::vector<std::int32_t>& slots : colours) {
    Batch batch;
    batch.firstStrand = static_cast<std::int32_t>(strands_.size());
    batch.springs = static_cast<std::int32_t>(slots.size());
    for (std::size_t first = 0; first < slots.size(); first += kLaterStrand) {
      const std::size_t end = std::min(first + kLaterStrand, slots.size());
      Strand strand;
      strand.firstSpan = static_cast<std::int32_t>(spans_.size());
      appendSpan(model.springs, endsOf, slots.data() + first, slots.data() + end, {});
      strand.endSpan = static_cast<std::int32_t>(spans_.size());
      strands_.push_back(strand);
    }
    batch.endStrand = static_cast<std::int32_t>(strands_.size());
    batches_.push_back(batch);
  }
}

void SpringSchedule::append(const Model& model, const std::vector<std::int32_t>& slotOf,
                            Coloured colours) {
  const std::int32_t particles = *std::max_element(slotOf.begin(), slotOf.end()) + 1;
  std::vector<Ends> ends;  // close together, as they are looked up in many orders
  ends.reserve(model.springs.slots().size());
  for (const Spring& spring : model.springs.slots()) {
    ends.push_back(spring.exists() ? Ends{slotOf[spring.a], slotOf[spring.b]} : Ends{});
  }
  const auto joinAll = [&](ConnectedSets& sets, const std::vector<std::int32_t>& slots) {
    for (std::int32_t slot : slots) sets.join(ends[slot].a, ends[slot].b);
  };
  std::size_t springs = 0;
  for (const std::vector<std::int32_t>& colour : colours) springs += colour.size();
  const bool isShared = springs >= kGrainOfWaiting;
  for (std::size_t first = 0; first < colours.size();) {
    ConnectedSets sets(particles);
    joinAll(sets, colours[first]);
    std::size_t end = first + 1;
    for (; end < colours.size(); ++end) {
      ConnectedSets joined = sets;
      joinAll(joined, colours[end]);
      if (joined.count() < std::min(kFewestSets, sets.count())) break;
      if (joined.widest() > particles / kFewestSets) break;
      sets = std::move(joined);
    }
    Batch batch;
    const std::int32_t before = size();
    batch.firstStrand = static_cast<std::int32_t>(strands_.size());
    const auto rootOf = [&](std::int32_t slot) { return sets.rootOf(ends[slot].a); };
    const Strands strandOf =
        divide(colours.begin() + first, colours.begin() + end, isShared, rootOf);
    std::vector<Coloured> strands(strandOf.count, Coloured(end - first));
    for (std::size_t c = first; c < end; ++c) {
      for (std::int32_t slot : colours[c]) {
        strands[strandOf.byRoot[rootOf(slot)]][c - first].push_back(slot);
      }
    }
    for (const Coloured& strand : strands) appendStrand(model.springs, ends, strand);
    batch.endStrand = static_cast<std::int32_t>(strands_.size());
    batch.springs = size() - before;
    batches_.push_back(batch);
    first = end;
  }
}

std::vector<SpringSchedule::Reach> SpringSchedule::reaches() const {
  std::vector<Reach> reaches;
  for (const Strand& strand : strands_) {
    Reach reach{std::numeric_limits<std::int32_t>::max(), -1};
    for (std::int32_t k = strand.firstSpan; k < strand.endSpan; ++k) {
      const Span& span = spans_[k];
      const std::int32_t stride = span.isRun ? span.count - 1 : 1;  // of a run the first and last
      for (std::int32_t at = 0; at < span.count; at += stride) {
        const Ends ends = endsOf(span, at);
        reach.first = std::min({reach.first, ends.a, ends.b});
        reach.last = std::max({reach.last, ends.a, ends.b});
      }
    }
    reaches.push_back(reach);
  }
  return reaches;
}

/// Among the strands of the first batch, which then reach as far as their slots.
void SpringSchedule::divideSlots(std::int32_t slots, std::vector<Reach>& reaches) {
  bounds_.clear();
  if (batches_.empty()) return;
  const auto begin = reaches.begin();
  const auto end = begin + batches_.front().endStrand;
  const auto overlaps = [](const Reach& a, const Reach& b) { return a.last >= b.first; };
  if (std::adjacent_find(begin, end, overlaps) != end) return;
  for (auto reach = begin; reach != end; ++reach) {
    bounds_.push_back(reach == begin ? 0 : reach->first);
  }
  bounds_.push_back(slots);
  for (std::size_t k = 0; k + 1 < bounds_.size(); ++k) {
    reaches[k] = {bounds_[k], bounds_[k + 1] - 1};
  }
}

/// By the last particle of those that a strand comes after, as if each shared all in its reach.
void SpringSchedule::orderWave(const std::vector<Reach>& reaches) {
  std::vector<std::int32_t> last(strands_.size());
  for (const Batch& batch : batches_) {
    for (std::int32_t s = batch.firstStrand; s < batch.endStrand; ++s) {
      last[s] = reaches[s].last;
      for (std::int32_t t = 0; t < batch.firstStrand; ++t) {
        if (reaches[s].meets(reaches[t])) last[s] = std::max(last[s], last[t]);
      }
    }
  }
  wave_.resize(strands_.size());
  std::iota(wave_.begin(), wave_.end(), 0);
  std::stable_sort(wave_.begin(), wave_.end(),
                   [&](std::int32_t s, std::int32_t t) { return last[s] < last[t]; });
}

/// A batch begins a round where a strand of it would wait for too many of the round before.
void SpringSchedule::orderRounds(const std::vector<Reach>& reaches) {
  rounds_.clear();
  for (const Batch& batch : batches_) {
    const auto waitsOf = [&](std::int32_t strand) {
      std::vector<std::int32_t> waits;
      const Round& round = rounds_.back();
      for (std::int32_t earlier = round.firstStrand; earlier < batch.firstStrand; ++earlier) {
        const bool meets = reaches[strand].meets(reaches[earlier]);
        if (meets) waits.push_back(earlier - round.firstStrand);
      }
      return waits;
    };
    bool begins = rounds_.empty();
    for (std::int32_t s = batch.firstStrand; s < batch.endStrand && !begins; ++s) {
      begins = waitsOf(s).size() > kMostWaits;
    }
    if (begins) rounds_.push_back({batch.firstStrand, batch.firstStrand, 0, {}});
    Round& round = rounds_.back();
    round.endStrand = batch.endStrand;
    round.springs += batch.springs;
    TaskGraph& order = round.order;
    order.groupEnds.push_back(batch.endStrand - round.firstStrand);
    for (std::int32_t s = batch.firstStrand; s < batch.endStrand; ++s) {
      const std::vector<std::int32_t> waits = waitsOf(s);
      order.waits.insert(order.waits.end(), waits.begin(), waits.end());
      order.waitEnds.push_back(static_cast<std::int32_t>(order.waits.size()));
    }
  }
}

void SpringSchedule::appendStrand(const SpringNetwork& springs, const std::vector<Ends>& ends,
                                  const Coloured& colours) {
  Strand strand;
  strand.firstSpan = static_cast<std::int32_t>(spans_.size());
  for (const std::vector<std::int32_t>& slots : colours) appendColour(springs, ends, slots);
  strand.endSpan = static_cast<std::int32_t>(spans_.size());
  strands_.push_back(strand);
}

void SpringSchedule::appendColour(const SpringNetwork& springs, const std::vector<Ends>& ends,
                                  const std::vector<std::int32_t>& slots) {
  const std::vector<std::int32_t> sorted = sortedByFirstEnd(ends, slots);
  const auto endsOf = [&](std::int32_t slot) { return ends[slot]; };
  const auto follows = [&](std::int32_t s, std::int32_t t) {
    return ends[t].a == ends[s].a + 1 && ends[t].b == ends[s].b + 1;
  };
  std::vector<std::int32_t> singles;
  const auto appendRun = [&](const std::int32_t* begin, const std::int32_t* end, bool isUniform) {
    if (end - begin < kShortestRun) {
      singles.insert(singles.end(), begin, end);
      return;
    }
    Span run;
    run.isRun = true;
    run.isUniform = isUniform;
    appendSpan(springs, endsOf, begin, end, run);
  };
  const auto appendRunLikeOthers = [&](const std::int32_t* begin, const std::int32_t* end) {
    const auto count = static_cast<std::int32_t>(end - begin);
    if (count < kShortestRun || endOfEqualParameters(springs, begin, end) == end) return false;
    Span run;
    run.firstParameters = patterns_.place(
        count, [&](std::int32_t k) { return springs[begin[k]].parameters(); }, parameters);
    run.isRun = true;
    run.sharesParameters = run.firstParameters != kNone;
    if (run.sharesParameters) appendSpan(springs, endsOf, begin, end, run);
    return run.sharesParameters;
  };
  const auto appendRunsByLaw = [&](const std::int32_t* at, const std::int32_t* end) {
    const std::int32_t* mixed = at;  // up to where parameters change too often for uniform runs
    while (at != end) {
      const std::int32_t* const same = endOfEqualParameters(springs, at, end);
      if (same - at >= kShortestRun) {
        appendRun(mixed, at, false);
        appendRun(at, same, true);
        mixed = same;
      }
      at = same;
    }
    appendRun(mixed, end, false);
  };
  const std::int32_t* const last = sorted.data() + sorted.size();
  for (const std::int32_t* at = sorted.data(); at != last;) {
    const std::int32_t* stop = at + 1;
    while (stop != last && follows(*(stop - 1), *stop)) ++stop;
    if (!appendRunLikeOthers(at, stop)) appendRunsByLaw(at, stop);
    at = stop;
  }
  appendSpan(springs, endsOf, singles.data(), singles.data() + singles.size(), {});
}

template <typename EndsOf>
void SpringSchedule::appendSpan(const SpringNetwork& springs, const EndsOf& endsOf,
                                const std::int32_t* slot, const std::int32_t* end, Span span) {
  if (slot == end) return;
  const auto originals = static_cast<std::int32_t>(home_.size());
  span.first = size();
  span.count = static_cast<std::int32_t>(end - slot);
  span.others = static_cast<std::int32_t>(endA.size());
  if (!span.sharesParameters) span.firstParameters = static_cast<std::int32_t>(parameters.size());
  if (span.isRun) span.ends = endsOf(*slot);
  if (span.isUniform) parameters.append(springs[*slot].parameters());
  for (std::int32_t position = span.first; slot != end; ++slot, ++position) {
    if (*slot < originals && home_[*slot] == kNone) home_[*slot] = position;  // where it is first
    if (!span.isUniform && !span.sharesParameters) parameters.append(springs[*slot].parameters());
    if (span.isRun) continue;
    const Ends ends = endsOf(*slot);
    endA.push_back(ends.a);
    endB.push_back(ends.b);
  }
  spans_.push_back(span);
}

}  // namespace cloth_sim
