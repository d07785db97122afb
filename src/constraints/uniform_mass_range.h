#pragma once
/// \file Where masses need not be read.

#include "particles.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// Springs [from, end) of a run, whole fours from its first on, whose ends all have one mass.
struct UniformMassRange {
  std::int32_t from = 0;
  std::int32_t end = 0;
};

/// The longest one of each span; none where that is no run.
/// \param inverseMass  by slot.
void findUniformMassRanges(const SpringSchedule& schedule, const ScalarArray& inverseMass,
                           std::vector<UniformMassRange>& stretches);

}  // namespace cloth_sim
