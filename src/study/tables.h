#pragma once
/// \file The results of the study as CSV. A missing number is written as nan, a missing limit as
/// inf.

#include <iosfwd>

#include "resolution.h"
#include "stability.h"
#include "work_precision.h"

namespace cloth_sim {

/// The reference of the runs of one scene.
struct NamedReference {
  std::string scene;
  std::string source;
  double ownError = 0.0;
};

void writeWorkPrecision(std::ostream& out, const std::vector<WorkPrecisionRow>& rows);
/// Writes the rows of scenes about tearing.
void writeTearing(std::ostream& out, const std::vector<WorkPrecisionRow>& rows);
void writePareto(std::ostream& out, const std::vector<WorkPrecisionRow>& front);
void writeReferences(std::ostream& out, const std::vector<NamedReference>& references);
/// Writes every probe of every bisection. The rows of the oscillator have its stiffness.
void writeStability(std::ostream& out, const std::vector<StabilityLimit>& limits);
void writeStabilityLimits(std::ostream& out, const std::vector<StabilityLimit>& limits);
void writeResolution(std::ostream& out, const std::vector<ResolutionRow>& rows);
/// Writes one line for every run that was skipped or refused, with the reason. Returns their
/// number.
int writeSkipped(std::ostream& out, const std::vector<WorkPrecisionRow>& rows);

}  // namespace cloth_sim
