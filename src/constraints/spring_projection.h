#pragma once
/// \file Gauss-Seidel projection of all springs of a schedule.

#include "overflow_projection.h"
#include "particles.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// Projects springs as reference_projection.h says, four at a time.
///
/// The weights of four springs are a SIMD block. Spans whose springs have the same parameters and
/// masses, as nearly all rows of a grid do, share their blocks, which then stay in the first-level
/// cache. Where the number of springs in a span is no multiple of four, the first block of the span
/// covers its last four springs; weights of zero leave those alone that later blocks project.
/// Springs that edits made or moved follow, by OverflowProjection.
class SpringProjection {
 public:
  /// Finds which spans share weights. To be called when springs or masses have changed, and then
  /// `setStep`.
  /// \param inverseMass  by particle slot [1/kg].
  void setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass);
  /// Finds the weights for substeps of length h [s].
  /// \param inverseMass  as in `setMasses`.
  void setStep(const SpringSchedule& schedule, const ScalarArray& inverseMass, double h);
  /// Projects every spring once, in the order of the schedule.
  void project(const SpringSchedule& schedule, Particles& particles);

 private:
  /// Weights of four springs.
  struct alignas(32) WeightBlock {
    double a[4] = {};
    double b[4] = {};
  };
  /// Full blocks [from, end) of a span, counted without the first one if that covers the last
  /// springs again.
  struct BlockRange {
    std::int32_t from = 0;
    std::int32_t end = 0;
  };
  struct Kernel;

  void findOwners(const SpringSchedule& schedule, const ScalarArray& inverseMass);
  static BlockRange symmetricBlocks(const SpringSchedule& schedule, std::size_t span,
                                    const ScalarArray& inverseMass);

  std::vector<std::int32_t> firstBlock_;  ///< by span of the undamaged mesh: index in `blocks_`
  /// By span: where both ends of each spring have the same weight, as nearly everywhere on a grid.
  /// There both move by the same vector, which saves a tenth of a step of a large cloth.
  std::vector<BlockRange> symmetric_;
  std::vector<std::int32_t> owners_;  ///< spans with blocks of their own, ascending
  std::vector<WeightBlock> blocks_;
  std::vector<double> gamma_;  ///< four for each block; empty where there are no dashpots
  /// A span and the hash of all that its weights depend on; kept to save allocations.
  struct Key {
    std::uint64_t hash = 0;
    std::int32_t span = 0;
  };
  std::vector<Key> keys_;
  OverflowProjection overflow_;
};

}  // namespace cloth_sim
