#pragma once
/// \file The summary of a run as JSON.

#include <string>

#include "cloth_sim/sim/run_record.h"

namespace cloth_sim {

/// Returns the summary of a run as indented JSON text. It is always valid JSON: a number that is
/// not finite is written as null. \param wallTime     duration of the run [s]. \param interrupted
/// whether somebody stopped it before its end.
std::string summaryJson(const Simulation& simulation, const RunRecord& record, double wallTime,
                        bool interrupted = false);

}  // namespace cloth_sim
