#pragma once
/// \file The order in which sweeps visit springs, and their constants in that order.

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/threads/thread_pool.h"
#include "spring_parameters.h"
#include "threads/parallel_for.h"

namespace cloth_sim {

/// Springs are coloured: no two of a colour share a particle. Consecutive colours are then joined
/// into a batch as long as the batch falls apart into many strands that share no particle. Within a
/// strand the springs are visited colour by colour; strands may run in any order, or at once, with
/// the same result. On a grid a strand is some rows, which stay in the cache while all the
/// colours pass over them. A strand may have its turn as soon as those of earlier batches that it
/// shares particles with have had theirs: one thread alone goes over the cloth once, as a wave, and
/// several need not wait for each other between batches.
///
/// The springs of the undamaged mesh are laid out once. Where the ends of consecutive springs are
/// consecutive particles they form a run, which is swept without gathers and without a list of
/// ends; if all of them have the same parameters, as in the middle of a grid, it is there once, and
/// runs whose parameters follow each other alike, as those from border to border, share them. Where
/// a spring has gone or its ends have changed, its place stays with zero stiffness, so runs stay
/// whole; springs that an edit made or moved are appended, coloured among themselves. What a sweep
/// does is a function of the slots of the network alone, not of the order of edits.
class SpringSchedule {
 public:
  /// Springs in a run at least.
  static constexpr std::int32_t kShortestRun = 4;
  /// Particle slots of a spring.
  struct Ends {
    std::int32_t a = kNone;
    std::int32_t b = kNone;
  };
  /// Consecutive positions of one colour.
  struct Span {
    std::int32_t first = 0;
    std::int32_t count = 0;
    bool isRun = false;                ///< their ends are consecutive particles
    bool isUniform = false;            ///< a run of one parameters
    bool sharesParameters = false;     ///< with other runs
    Ends ends;                         ///< of the first one of a run
    std::int32_t others = 0;           ///< of its first one in `endA` and `endB`, if it is no run
    std::int32_t firstParameters = 0;  ///< of its first one, or of them all, in `parameters`
  };
  /// A spring as sweeps see it.
  struct Element {
    std::int32_t position = 0;
    std::int32_t a = kNone;  ///< particle slots
    std::int32_t b = kNone;
    SpringParameters parameters;
  };
  /// Consecutive spans, to be visited in order.
  struct Strand {
    std::int32_t firstSpan = 0;
    std::int32_t endSpan = 0;
  };
  /// Consecutive strands that share no particle.
  struct Batch {
    std::int32_t firstStrand = 0;
    std::int32_t endStrand = 0;
    std::int32_t springs = 0;  ///< in all of them
  };

  void build(const Model& model, const std::vector<std::int32_t>& slotOf);
  void follow(const Model& model, const SpringChanges& changes,
              const std::vector<std::int32_t>& slotOf);

  /// To be visited in order.
  const std::vector<Batch>& batches() const { return batches_; }
  const std::vector<Strand>& strands() const { return strands_; }
  const std::vector<Span>& spans() const { return spans_; }
  /// The first of `spans` whose springs edits made or moved; none from it on is a run.
  std::size_t firstLater() const { return original_.spans; }
  std::int32_t size() const {
    return spans_.empty() ? 0 : spans_.back().first + spans_.back().count;
  }

  /// Calls `visitor(span, end)` for consecutive spans of the undamaged mesh, in the order of the
  /// sweep, on several threads where that pays.
  template <typename SpansVisitor>
  void sweepOriginals(const SpansVisitor& visitor) const {
    sweepOriginals(
        0, [](std::int32_t, std::int32_t) {}, visitor);
  }
  /// ... and `prepare(first, last)` for consecutive particle slots, which together are [0, slots),
  /// before any spring of theirs.
  template <typename Prepare, typename SpansVisitor>
  void sweepOriginals(std::int32_t slots, const Prepare& prepare,
                      const SpansVisitor& visitor) const;
  /// Calls `visitor(span, end)` for those from `firstLater` on, in the order of the sweep: after
  /// the others.
  template <typename SpansVisitor>
  void sweepLater(const SpansVisitor& visitor) const;
  /// Calls `visitor(span, end)` for all of them.
  template <typename SpansVisitor>
  void sweepSpans(const SpansVisitor& visitor) const {
    sweepOriginals(visitor);
    sweepLater(visitor);
  }
  /// The same with `visitRun(span)` for runs and `visitor(element)` for all other springs.
  template <typename RunVisitor, typename Visitor>
  void sweep(const RunVisitor& visitRun, const Visitor& visitor) const {
    sweepSpans([&](const Span* span, const Span* end) {
      for (; span != end; ++span) span->isRun ? visitRun(*span) : visit(*span, visitor);
    });
  }
  /// The same with `visitor(element)` for every spring.
  template <typename Visitor>
  void sweep(const Visitor& visitor) const {
    sweep([&](const Span& span) { visit(span, visitor); }, visitor);
  }
  /// The same by ascending position, on one thread.
  template <typename Visitor>
  void forEach(const Visitor& visitor) const {
    for (const Span& span : spans_) visit(span, visitor);
  }
  /// The same for a span.
  template <typename Visitor>
  void visit(const Span& span, const Visitor& visitor) const {
    for (std::int32_t k = 0; k < span.count; ++k) visitor(element(span, k));
  }

  SpringParameterTable parameters;
  std::vector<std::int32_t> endA, endB;  ///< particle slots, of springs that are in no run

 private:
  /// Fewer springs, or particles, are not worth a second thread ...
  static constexpr std::int32_t kGrain = 4096;
  /// ... and fewer springs whose strands wait for each other.
  static constexpr std::int32_t kGrainOfWaiting = 16384;

  struct Extent {
    std::size_t others = 0;
    std::size_t parameters = 0;
    std::size_t spans = 0;
    std::size_t strands = 0;
    std::size_t batches = 0;
  };
  /// What a strand shares with others at most: particles from the first to the last of its own.
  struct Reach {
    std::int32_t first = 0;
    std::int32_t last = 0;
    bool meets(const Reach& other) const { return other.first <= last && first <= other.last; }
  };
  /// Consecutive batches through which threads go without waiting for each other between them.
  struct Round {
    std::int32_t firstStrand = 0;
    std::int32_t endStrand = 0;
    std::int32_t springs = 0;
    TaskGraph order;  ///< of strands, from `firstStrand` on
  };
  using Coloured = std::vector<std::vector<std::int32_t>>;  ///< spring slots by colour

  Ends endsOf(const Span& span, std::int32_t k) const {
    if (span.isRun) return {span.ends.a + k, span.ends.b + k};
    return {endA[span.others + k], endB[span.others + k]};
  }
  SpringParameters parametersOf(const Span& span, std::int32_t k) const {
    return parameters[span.firstParameters + (span.isUniform ? 0 : k)];
  }
  Element element(const Span& span, std::int32_t k) const {
    const Ends ends = endsOf(span, k);
    return {span.first + k, ends.a, ends.b, parametersOf(span, k)};
  }
  template <typename StrandVisitor>
  void visitOriginals(const StrandVisitor& visit) const;
  /// \param end  after the last strand.
  template <typename SpansVisitor>
  void visitSpans(std::int32_t strand, std::int32_t end, const SpansVisitor& visitor) const {
    visitor(spans_.data() + strands_[strand].firstSpan, spans_.data() + strands_[end - 1].endSpan);
  }
  Extent extent() const;
  void truncate(const Extent& extent);

  /// Puts a spring where the undamaged mesh had it, if its ends are the same, or else among those
  /// to be appended; or nowhere, if it is gone.
  void settle(const Spring& spring, std::int32_t slot, const std::vector<std::int32_t>& slotOf);
  void setParameters(const SpringParameters& of, Span& span, std::int32_t k);
  void separateParameters(Span& span);
  void gatherParameters();
  void append(const Model& model, const std::vector<std::int32_t>& slotOf, Coloured colours);
  void appendLater(const Model& model, const std::vector<std::int32_t>& slotOf,
                   const Coloured& colours);
  std::vector<Reach> reaches() const;
  void divideSlots(std::int32_t slots, std::vector<Reach>& reaches);
  void orderWave(const std::vector<Reach>& reaches);
  void orderRounds(const std::vector<Reach>& reaches);
  void appendStrand(const SpringNetwork& springs, const std::vector<Ends>& ends,
                    const Coloured& colours);
  void appendColour(const SpringNetwork& springs, const std::vector<Ends>& ends,
                    const std::vector<std::int32_t>& slots);
  template <typename EndsOf>
  void appendSpan(const SpringNetwork& springs, const EndsOf& endsOf, const std::int32_t* slot,
                  const std::int32_t* end, Span span);

  std::vector<Batch> batches_;
  std::vector<Strand> strands_;
  std::vector<Span> spans_;
  ParameterPatterns patterns_;
  // Strands of the undamaged mesh:
  std::vector<std::int32_t> wave_;    ///< for one thread
  std::vector<Round> rounds_;         ///< for several
  std::vector<std::int32_t> bounds_;  ///< before, between and after the slots of the first batch's,
                                      ///< if they have no others between theirs
  std::vector<std::int32_t> home_;    ///< by spring slot of the undamaged mesh: its position
  std::vector<bool> isAppended_;      ///< by spring slot, since the first edit
  Extent original_;
};

template <typename Prepare, typename SpansVisitor>
void SpringSchedule::sweepOriginals(std::int32_t slots, const Prepare& prepare,
                                    const SpansVisitor& visitor) const {
  const std::int32_t divided = bounds_.empty() ? 0 : bounds_.back();
  parallelFor(slots - divided, kGrain, [&](std::int32_t first, std::int32_t last) {
    prepare(divided + first, divided + last);
  });
  visitOriginals([&](std::int32_t strand) {
    const bool isFirstOfItsSlots = strand + 1 < static_cast<std::int32_t>(bounds_.size());
    if (isFirstOfItsSlots) prepare(bounds_[strand], bounds_[strand + 1]);
    visitSpans(strand, strand + 1, visitor);
  });
}

template <typename StrandVisitor>
void SpringSchedule::visitOriginals(const StrandVisitor& visit) const {
  ThreadPool* const pool = ThreadPool::ofThisThread();
  if (pool == nullptr) {
    for (const std::int32_t strand : wave_) visit(strand);
    return;
  }
  for (const Round& round : rounds_) {
    if (round.springs < (round.order.waits.empty() ? kGrain : kGrainOfWaiting)) {
      for (std::int32_t strand = round.firstStrand; strand < round.endStrand; ++strand) {
        visit(strand);
      }
    } else {
      parallelInOrder(*pool, round.order,
                      [&](std::int32_t part) { visit(round.firstStrand + part); });
    }
  }
}

template <typename SpansVisitor>
void SpringSchedule::sweepLater(const SpansVisitor& visitor) const {
  for (std::size_t next = original_.batches; next < batches_.size(); ++next) {
    const Batch& batch = batches_[next];
    const std::int32_t strands = batch.endStrand - batch.firstStrand;
    const std::int32_t grain =
        static_cast<std::int32_t>(std::int64_t{kGrain / 2} * strands / batch.springs) + 1;
    parallelFor(strands, grain, [&](std::int32_t begin, std::int32_t end) {
      visitSpans(batch.firstStrand + begin, batch.firstStrand + end, visitor);
    });
  }
}

}  // namespace cloth_sim
