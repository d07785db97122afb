#pragma once
/// \file Corrections along springs that edits made.

#include "compliance.h"
#include "particles.h"
#include "spring_schedule.h"
#include "support/simd.h"

namespace cloth_sim {

/// Springs that share no particle. Those that fill up a four do nothing.
struct alignas(32) FourLater {
  std::int32_t a[kLanes], b[kLanes];  ///< where the numbers of their ends begin
  double rest[kLanes];                ///< [m]
  double give[kLanes];                ///< see `giveOf`
};

/// Springs that cuts and refinement made are in no run. Their particles are copied, coordinates
/// side by side, before they are swept, and back after it.
class OverflowProjection {
 public:
  /// To be called when springs or masses have changed ...
  /// \param inverseMass  by slot.
  void setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass);
  /// ... and then, and when the length of the substeps has.
  /// \param compliances  by parameters of the schedule.
  void setStep(const SpringSchedule& schedule, const Compliances& compliances);
  /// Moves the ends of these springs, in the order of the schedule.
  void correct(const SpringSchedule& schedule, Particles& particles);

 private:
  /// Calls `visit(spring, k)` for these springs; k is that of a lane of `fours_`.
  template <typename Visit>
  void forSprings(const SpringSchedule& schedule, const Visit& visit) const;
  void findBegins(const SpringSchedule& schedule);
  std::vector<std::int32_t> listParticles(const SpringSchedule& schedule,
                                          const ScalarArray& inverseMass);
  void gather(const Particles& particles);
  void scatter(Particles& particles) const;

  std::vector<std::int32_t> slots_;  ///< of the particles, ascending
  ScalarArray x_;                    ///< x, y, z and the inverse mass of each
  ScalarArray start_;                ///< the same at the start of the substep; of dashpots
  std::vector<FourLater> fours_;     ///< a span that is no multiple of them is filled up
  std::vector<double> lag_;          ///< of each spring of them, see `Compliance`; of dashpots
  std::vector<std::size_t> begins_;  ///< by span: its first four; and after the last
};

}  // namespace cloth_sim
