#pragma once
/// \file One pass of corrections along springs, one after the other.

#include <functional>

#include "compliance.h"
#include "overflow_projection.h"
#include "uniform_mass_range.h"

namespace cloth_sim {

/// What is to be done with particles before their springs: `prepare(first, last)` for slots.
using Prepare = std::function<void(std::size_t first, std::size_t last)>;

/// Moves the ends of springs, in the order of a schedule; see `Compliance`.
class SpringProjection {
 public:
  /// To be called when springs or masses have changed ...
  /// \param inverseMass  by slot [1/kg]; they have to be the same when springs are corrected.
  void setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass);
  /// ... and then, and when the length of the substeps has.
  /// \param h  that length [s].
  void setStep(const SpringSchedule& schedule, double h);
  /// \param prepare  if any: called for all slots, part by part, each as late as may be, so that
  ///                 what it has written is still in the cache.
  void correct(const SpringSchedule& schedule, Particles& particles, const Prepare& prepare = {});

 private:
  Compliances compliances_;             ///< by parameters of the schedule
  std::vector<UniformMassRange> even_;  ///< by span of the schedule
  OverflowProjection later_;
};

}  // namespace cloth_sim
