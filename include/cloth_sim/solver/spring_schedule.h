#pragma once
/// \file The order in which sweeps visit springs, and their constants in that order.

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/threads/parallel_for.h"

namespace cloth_sim {

/// Springs are coloured: no two of a colour share a particle. Consecutive colours are then joined
/// into a batch as long as the batch falls apart into many strands that share no particle. Within a
/// strand the springs are visited colour by colour; strands may run in any order, or at once, with
/// the same result. On a grid a strand is some rows, which stay in the cache while all the
/// colours pass over them.
///
/// The springs of the undamaged mesh are laid out once. Where the ends of consecutive springs are
/// consecutive particles they form a run, which is swept without gathers. Where a spring has gone
/// or its ends have changed, its place stays with zero stiffness, so runs stay whole; springs that
/// an edit made or moved are appended, coloured among themselves. The schedule is a function of the
/// slots of the network alone, not of the order of edits.
class SpringSchedule {
 public:
  /// Particle slots of a spring.
  struct Ends {
    std::int32_t a = kNone;
    std::int32_t b = kNone;
  };
  /// Consecutive positions of one colour.
  struct Span {
    std::int32_t first = 0;
    std::int32_t count = 0;
    bool isRun = false;  ///< their ends are consecutive particles
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
  std::int32_t size() const { return static_cast<std::int32_t>(endA.size()); }
  /// Position of a spring by its slot in the network.
  std::int32_t positionOf(std::int32_t springSlot) const { return position_[springSlot]; }

  /// Calls `runVisitor(first, count)` for runs and `otherVisitor(first, count)` for spans of
  /// springs whose ends are anywhere, but no two of them share a particle, in the order of the
  /// sweep, on several threads where that pays.
  template <typename RunVisitor, typename OtherVisitor>
  void sweep(const RunVisitor& runVisitor, const OtherVisitor& otherVisitor) const;

  /// A visitor of spans that calls `visitor(position)` for every spring.
  template <typename Visitor>
  static auto each(const Visitor& visitor) {
    return [visitor](std::int32_t first, std::int32_t count) {
      for (std::int32_t p = first; p < first + count; ++p) visitor(p);
    };
  }

  /// The same, with `visitor(position)` for every spring.
  template <typename Visitor>
  void sweep(const Visitor& visitor) const {
    sweep(each(visitor), each(visitor));
  }

  // By position:
  std::vector<std::int32_t> endA, endB;  ///< particle slots
  std::vector<double> restLength;        ///< [m]
  std::vector<double> stiffness;         ///< [N/m]; 0 where the spring is gone
  std::vector<double> damping;           ///< [N s/m]; nothing unless `damped`
  bool damped = false;                   ///< some spring has or had a dashpot
  double dampingAt(std::int32_t position) const { return damped ? damping[position] : 0.0; }

 private:
  struct Extent {
    std::size_t positions = 0;
    std::size_t spans = 0;
    std::size_t strands = 0;
    std::size_t batches = 0;
  };
  using Coloured = std::vector<std::vector<std::int32_t>>;  ///< spring slots by colour

  Coloured colour(const Model& model, const std::vector<std::int32_t>& slots) const;
  /// Puts a spring where the undamaged mesh had it, if its ends are the same, or else among the
  /// appended ones; or nowhere, if it is gone.
  void settle(const Spring& spring, std::int32_t slot, const std::vector<std::int32_t>& slotOf);
  void append(const Model& model, const std::vector<std::int32_t>& slotOf, Coloured colours);
  void appendLater(const Model& model, const std::vector<std::int32_t>& slotOf,
                   const Coloured& colours);
  void appendStrand(const SpringNetwork& springs, const std::vector<std::int32_t>& slotOf,
                    const std::vector<Ends>& ends, const Coloured& colours);
  void appendColour(const SpringNetwork& springs, const std::vector<std::int32_t>& slotOf,
                    const std::vector<Ends>& ends, const std::vector<std::int32_t>& slots);
  void appendSpan(const SpringNetwork& springs, const std::vector<std::int32_t>& slotOf,
                  const std::vector<std::int32_t>& slots, bool isRun);
  void place(const Spring& spring, std::int32_t position, const std::vector<std::int32_t>& slotOf);
  void truncate(const Extent& extent);

  std::vector<Batch> batches_;
  std::vector<Strand> strands_;
  std::vector<Span> spans_;
  std::vector<std::int32_t> position_;  ///< by spring slot
  /// By spring slot of the undamaged mesh; since the first edit.
  std::vector<std::int32_t> originalPosition_;
  std::vector<bool> isAppended_;  ///< by spring slot: after the original positions; as long
  std::int32_t originalSlots_ = 0;
  Extent original_;
};

template <typename RunVisitor, typename OtherVisitor>
void SpringSchedule::sweep(const RunVisitor& runVisitor, const OtherVisitor& otherVisitor) const {
  /// Fewer springs are not worth a second thread.
  constexpr std::int32_t kGrainSprings = 2048;
  for (const Batch& batch : batches_) {
    const std::int32_t strands = batch.endStrand - batch.firstStrand;
    const std::int32_t grain =
        static_cast<std::int32_t>(std::int64_t{kGrainSprings} * strands / batch.springs) + 1;
    parallelFor(strands, grain, [&](std::int32_t begin, std::int32_t end) {
      const std::int32_t firstSpan = strands_[batch.firstStrand + begin].firstSpan;
      const std::int32_t endSpan = strands_[batch.firstStrand + end - 1].endSpan;
      for (std::int32_t k = firstSpan; k < endSpan; ++k) {
        const Span& span = spans_[k];
        if (span.isRun) {
          runVisitor(span.first, span.count);
        } else {
          otherVisitor(span.first, span.count);
        }
      }
    });
  }
}

}  // namespace cloth_sim
