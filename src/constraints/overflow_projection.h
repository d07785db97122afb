#pragma once
/// \file Projection of the springs that edits made or moved.

#include "particles.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// Projects the overflow of a schedule as reference_projection.h says, four springs at a time.
///
/// The particles of these springs lie anywhere in memory, so a sweep works on copies that have x, y
/// and z side by side: an end costs one load and one store instead of three gathers and three
/// scatters. A step of a cloth with a refined strip takes 0.9 of the time.
class OverflowProjection {
 public:
  /// Finds springs and particles. To be called when springs or masses have changed, and then
  /// `setStep`.
  /// \param inverseMass  by particle slot [1/kg].
  void setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass);
  /// Finds the weights for substeps of length h [s].
  void setStep(const SpringSchedule& schedule, const ScalarArray& inverseMass, double h);
  /// Projects every spring of the overflow once, in the order of the schedule.
  void project(const SpringSchedule& schedule, Particles& particles);

 private:
  /// Four springs that share no particle. Lanes without a spring have weights of zero.
  struct alignas(32) Block {
    std::int32_t a[4] = {};  ///< where the copy of the end begins in `x_`
    std::int32_t b[4] = {};
    double restLength[4] = {};  ///< [m]
    double weightA[4] = {};
    double weightB[4] = {};
  };
  struct Kernel;

  void findParticles(const SpringSchedule& schedule, std::size_t slots);
  /// Calls `visit(spring, block, lane)` for every spring.
  template <typename Visit>
  void forEach(const SpringSchedule& schedule, const Visit& visit) const;
  void load(const VectorArray& from, ScalarArray& copies) const;
  void store(VectorArray& to) const;

  std::vector<Block> blocks_;
  std::vector<double> gamma_;  ///< four for each block; empty where there are no dashpots
  std::vector<std::int32_t> firstBlock_;  ///< by span of the overflow; and after the last
  std::vector<std::int32_t> slots_;       ///< of the particles, ascending
  std::vector<std::int32_t> places_;      ///< by slot: where its copy begins, or kNone
  ScalarArray x_;      ///< copies of positions: x, y, z and a zero of each particle [m]
  ScalarArray start_;  ///< the same at the start of the substep; empty where there are no dashpots
};

}  // namespace cloth_sim
