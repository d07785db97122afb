#pragma once
/// \file The order in which sweeps visit springs, and their parameters in that order.

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/threads/thread_pool.h"
#include "schedule_blocks.h"
#include "spring_parameters.h"
#include "threads/parallel_for.h"

namespace cloth_sim {

/// Orders springs so that a Gauss-Seidel sweep gives the same bits on any number of threads.
///
/// Springs are coloured: no two of a colour share a particle (graph_colouring.h). Consecutive
/// colours form a colour group, whose blocks share no particle (schedule_blocks.h): blocks run in
/// any order, or at once, with the same result. Within a block the sweep goes colour by colour.
/// Consecutive groups form a phase. The task graph of a phase tells which blocks of earlier groups
/// a block has to wait for, so threads meet only where a phase ends.
///
/// Springs of a colour whose ends are consecutive particle slots form a contiguous span, which a
/// sweep reads and writes without gathers. All others are in gathered spans, with a list of ends.
///
/// The springs of the undamaged mesh are laid out once. Where an edit removes a spring or changes
/// its ends, its place stays, without stiffness, so that spans stay whole. Springs that edits made
/// or moved are the overflow: coloured among themselves and swept last, in gathered spans. The
/// order depends on the slots of the network alone, not on the order of edits.
class SpringSchedule {
 public:
  /// Fewest springs in a contiguous span: the width of a SIMD block.
  static constexpr std::int32_t kShortestContiguous = 4;

  /// Springs of one colour at consecutive positions of the schedule.
  struct Span {
    std::int32_t first = 0;            ///< position of the first spring
    std::int32_t count = 0;            ///< springs
    bool isContiguous = false;         ///< ends of the k-th spring: `ends.a + k`, `ends.b + k`
    bool sharesParameters = false;     ///< with other spans (ParameterPatterns)
    SpringEnds ends;                   ///< of the first spring, if contiguous
    std::int32_t firstEnd = 0;         ///< index in `endA` and `endB`, if gathered
    std::int32_t firstParameters = 0;  ///< index in `parameters`
  };
  /// A spring as sweeps see it.
  struct Element {
    std::int32_t position = 0;
    std::int32_t a = kNone;  ///< particle slot
    std::int32_t b = kNone;  ///< particle slot
    SpringParameters parameters;
  };
  /// Consecutive spans, visited in order.
  struct Block {
    std::int32_t firstSpan = 0;
    std::int32_t endSpan = 0;
  };
  /// Consecutive blocks that share no particle.
  struct ColourGroup {
    std::int32_t firstBlock = 0;
    std::int32_t endBlock = 0;
    std::int32_t springs = 0;  ///< in all of them
  };

  void build(const Model& model, const std::vector<std::int32_t>& slotOf);
  /// Follows an edit of the model.
  /// \param slotOf  particle slot by vertex, after the edit.
  void applyChanges(const Model& model, const SpringChanges& changes,
                    const std::vector<std::int32_t>& slotOf);

  const std::vector<ColourGroup>& groups() const { return groups_; }  ///< in order of the sweep
  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<Span>& spans() const { return spans_; }
  /// Index of the first span of the overflow; no span from it on is contiguous.
  std::size_t firstOverflow() const { return original_.spans; }
  /// Number of positions, gone springs included.
  std::int32_t size() const {
    return spans_.empty() ? 0 : spans_.back().first + spans_.back().count;
  }

  /// Calls `visitor(first, end)` for consecutive spans in the order of the sweep, on several
  /// threads where that pays.
  template <typename SpansVisitor>
  void sweepSpans(const SpansVisitor& visitor) const {
    sweepOriginals(visitor);
    sweepOverflow(visitor);
  }
  /// The first part of it: spans of the undamaged mesh ...
  template <typename SpansVisitor>
  void sweepOriginals(const SpansVisitor& visitor) const;
  /// ... and the second part: spans from `firstOverflow` on.
  template <typename SpansVisitor>
  void sweepOverflow(const SpansVisitor& visitor) const;
  /// The same with `visitSpan(span)` for contiguous spans and `visitor(element)` for all other
  /// springs.
  template <typename SpanVisitor, typename Visitor>
  void sweep(const SpanVisitor& visitSpan, const Visitor& visitor) const {
    sweepSpans([&](const Span* span, const Span* end) {
      for (; span != end; ++span) span->isContiguous ? visitSpan(*span) : visit(*span, visitor);
    });
  }
  /// The same with `visitor(element)` for every spring.
  template <typename Visitor>
  void sweep(const Visitor& visitor) const {
    sweep([&](const Span& span) { visit(span, visitor); }, visitor);
  }
  /// Calls `visitor(element)` for every spring, position by position, on this thread.
  template <typename Visitor>
  void forEach(const Visitor& visitor) const {
    for (const Span& span : spans_) visit(span, visitor);
  }
  /// Calls `visitor(element)` for every spring of a span.
  template <typename Visitor>
  void visit(const Span& span, const Visitor& visitor) const {
    for (std::int32_t k = 0; k < span.count; ++k) visitor(element(span, k));
  }

  SpringEnds endsOf(const Span& span, std::int32_t k) const {
    if (span.isContiguous) return {span.ends.a + k, span.ends.b + k};
    return {endA[span.firstEnd + k], endB[span.firstEnd + k]};
  }

  SpringParameterTable parameters;
  std::vector<std::int32_t> endA, endB;  ///< particle slots of springs in gathered spans

 private:
  /// Fewer springs are not worth a second thread ...
  static constexpr std::int32_t kGrain = 4096;
  /// ... and neither are fewer springs whose blocks wait for each other.
  static constexpr std::int32_t kDependentGrain = 16384;

  /// Sizes of the arrays, to go back to.
  struct Extent {
    std::size_t ends = 0;
    std::size_t parameters = 0;
    std::size_t spans = 0;
    std::size_t blocks = 0;
    std::size_t groups = 0;
  };
  /// All slots from a block's first to its last: an upper bound of the particles it touches.
  struct SlotRange {
    std::int32_t first = 0;
    std::int32_t last = 0;
    bool overlaps(const SlotRange& other) const {
      return other.first <= last && first <= other.last;
    }
  };
  /// Consecutive colour groups that threads go through without a barrier between them.
  struct Phase {
    std::int32_t firstBlock = 0;
    std::int32_t endBlock = 0;
    std::int32_t springs = 0;
    TaskGraph tasks;  ///< of its blocks; task k is block `firstBlock + k`
  };

  SpringParameters parametersOf(const Span& span, std::int32_t k) const {
    return parameters[span.firstParameters + k];
  }
  Element element(const Span& span, std::int32_t k) const {
    const SpringEnds ends = endsOf(span, k);
    return {span.first + k, ends.a, ends.b, parametersOf(span, k)};
  }

  Extent extent() const;
  void truncate(const Extent& extent);
  void appendOriginals(const Model& model, const std::vector<std::int32_t>& slotOf);
  void appendBlock(const SpringNetwork& springs, const std::vector<SpringEnds>& ends,
                   const Coloured& colours);
  void appendColour(const SpringNetwork& springs, const std::vector<SpringEnds>& ends,
                    const std::vector<std::int32_t>& slots);
  void appendOverflow(const Model& model, const std::vector<std::int32_t>& slotOf,
                      const Coloured& colours);
  template <typename EndsOf>
  void appendSpan(const SpringNetwork& springs, const EndsOf& endsOf, const std::int32_t* slot,
                  const std::int32_t* end, bool isContiguous);
  void updatePlace(const Spring& spring, std::int32_t slot,
                   const std::vector<std::int32_t>& slotOf);
  void setParameters(const SpringParameters& spring, Span& span, std::int32_t k);
  void unshareParameters(Span& span);
  void shareParametersAgain();
  std::vector<SlotRange> slotRanges() const;
  void buildPhases();
  std::vector<std::int32_t> dependenciesOf(std::int32_t block, const ColourGroup& group,
                                           const std::vector<SlotRange>& ranges) const;

  template <typename SpansVisitor>
  void sweepPhase(const Phase& phase, const SpansVisitor& visitor) const;
  template <typename SpansVisitor>
  void sweepOverflowGroup(const ColourGroup& group, const SpansVisitor& visitor) const;
  /// Visits the spans of blocks [block, end).
  template <typename SpansVisitor>
  void visitBlocks(std::int32_t block, std::int32_t end, const SpansVisitor& visitor) const {
    visitor(spans_.data() + blocks_[block].firstSpan, spans_.data() + blocks_[end - 1].endSpan);
  }

  std::vector<ColourGroup> groups_;
  std::vector<Block> blocks_;
  std::vector<Span> spans_;
  std::vector<Phase> phases_;  ///< of the undamaged mesh
  ParameterPatterns patterns_;
  std::vector<std::int32_t> positionOf_;  ///< by spring slot of the undamaged mesh
  std::vector<bool> isOverflow_;          ///< by spring slot
  Extent original_;                       ///< the undamaged mesh's part of the arrays
};

template <typename SpansVisitor>
void SpringSchedule::sweepOriginals(const SpansVisitor& visitor) const {
  for (const Phase& phase : phases_) sweepPhase(phase, visitor);
}

template <typename SpansVisitor>
void SpringSchedule::sweepOverflow(const SpansVisitor& visitor) const {
  for (std::size_t k = original_.groups; k < groups_.size(); ++k) {
    sweepOverflowGroup(groups_[k], visitor);
  }
}

template <typename SpansVisitor>
void SpringSchedule::sweepPhase(const Phase& phase, const SpansVisitor& visitor) const {
  ThreadPool* const pool = ThreadPool::ofThisThread();
  const std::int32_t grain = phase.tasks.predecessors.empty() ? kGrain : kDependentGrain;
  if (pool == nullptr || phase.springs < grain) {
    return visitBlocks(phase.firstBlock, phase.endBlock, visitor);
  }
  parallelInOrder(*pool, phase.tasks, [&](std::int32_t task) {
    visitBlocks(phase.firstBlock + task, phase.firstBlock + task + 1, visitor);
  });
}

template <typename SpansVisitor>
void SpringSchedule::sweepOverflowGroup(const ColourGroup& group,
                                        const SpansVisitor& visitor) const {
  const std::int32_t blocks = group.endBlock - group.firstBlock;
  const auto grain =
      static_cast<std::int32_t>(std::int64_t{kGrain / 2} * blocks / group.springs) + 1;
  parallelFor(blocks, grain, [&](std::int32_t begin, std::int32_t end) {
    visitBlocks(group.firstBlock + begin, group.firstBlock + end, visitor);
  });
}

}  // namespace cloth_sim
