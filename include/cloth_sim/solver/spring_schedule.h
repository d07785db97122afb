#pragma once
/// \file The order in which sweeps visit springs, and their constants in that order.

#include <set>

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// Springs in batches of one colour: no two of a batch share a particle, so a batch may run in any
/// order, in vector lanes or on threads, with the same result.
///
/// The springs of the undamaged mesh are laid out once. Where the ends of consecutive springs are
/// consecutive particles they form a run, which is swept without gathers. Where a spring has gone or
/// its ends have changed, its place stays with zero stiffness, so runs stay whole; springs that an
/// edit made or moved are appended, coloured among themselves. The schedule is a function of the slots of the network
/// alone, not of the order of edits.
class SpringSchedule {
 public:
  /// Consecutive positions whose ends are consecutive particles.
  struct Run {
    std::int32_t first = 0;  ///< position of the first spring
    std::int32_t count = 0;
  };
  /// One colour: some runs, then positions [firstSingle, endSingle) one by one.
  struct Batch {
    std::vector<Run> runs;
    std::int32_t firstSingle = 0;
    std::int32_t endSingle = 0;
  };

  void build(const Model& model, const std::vector<std::int32_t>& slotOf);
  void follow(const Model& model, const SpringChanges& changes,
              const std::vector<std::int32_t>& slotOf);

  const std::vector<Batch>& batches() const { return batches_; }
  std::int32_t size() const { return static_cast<std::int32_t>(endA.size()); }
  /// Position of a spring by its slot in the network.
  std::int32_t positionOf(std::int32_t springSlot) const { return position_[springSlot]; }

  // By position:
  std::vector<std::int32_t> endA, endB;  ///< particle slots
  std::vector<double> restLength;        ///< [m]
  std::vector<double> stiffness;         ///< [N/m]; 0 where the spring is gone
  std::vector<double> damping;           ///< [N s/m]
  bool damped = false;                   ///< some spring has a dashpot

 private:
  using Coloured = std::vector<std::vector<std::int32_t>>;  ///< spring slots by colour

  Coloured colour(const Model& model, const std::vector<std::int32_t>& slots) const;
  /// Puts a spring where the undamaged mesh had it, if its ends are the same, or else among the
  /// appended ones; or nowhere, if it is gone.
  void settle(const Spring& spring, std::int32_t slot, const std::vector<std::int32_t>& slotOf);
  void append(const Model& model, const std::vector<std::int32_t>& slotOf, Coloured colours);
  void place(const Spring& spring, std::int32_t position, const std::vector<std::int32_t>& slotOf);
  void truncate(std::int32_t positions, std::size_t batches);
  void findRuns(Batch& batch, std::vector<std::int32_t>& slots, const SpringNetwork& springs,
                const std::vector<std::int32_t>& slotOf);

  std::vector<Batch> batches_;
  std::vector<std::int32_t> position_;  ///< by spring slot
  std::vector<std::int32_t> originalPosition_;  ///< by spring slot of the undamaged mesh
  std::set<std::int32_t> appended_;             ///< spring slots after the original positions
  std::int32_t originalSlots_ = 0;
  std::int32_t originalPositions_ = 0;
  std::size_t originalBatches_ = 0;
};

}  // namespace cloth_sim
