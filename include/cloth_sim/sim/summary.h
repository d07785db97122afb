#pragma once
/// \file The result of a run as JSON.

#include <string>

#include "cloth_sim/sim/run_record.h"

namespace cloth_sim {

/// The summary of a run as indented JSON text. Always valid JSON: a number that is not finite is
/// written as null.
/// \param wallTime     what the run took [s].
/// \param interrupted  somebody stopped it before its end.
std::string summaryJson(const Simulation& simulation, const RunRecord& record, double wallTime,
                        bool interrupted = false);

}  // namespace cloth_sim
