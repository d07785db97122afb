#pragma once
/// \file What the study found, as CSV. Numbers that there are not are nan, limits that there are
/// not inf.

#include <iosfwd>

#include "resolution.h"
#include "stability.h"
#include "work_precision.h"

namespace cloth_sim {

/// What the runs of one scene were compared with.
struct NamedReference {
  std::string scene;
  std::string source;
  double ownError = 0.0;
};

void writeWorkPrecision(std::ostream& out, const std::vector<WorkPrecisionRow>& rows);
/// Of the rows of scenes about tearing.
void writeTearing(std::ostream& out, const std::vector<WorkPrecisionRow>& rows);
void writePareto(std::ostream& out, const std::vector<WorkPrecisionRow>& front);
void writeReferences(std::ostream& out, const std::vector<NamedReference>& references);
/// Every probe of every bisection. The oscillator's rows are those with its stiffness.
void writeStability(std::ostream& out, const std::vector<StabilityLimit>& limits);
void writeStabilityLimits(std::ostream& out, const std::vector<StabilityLimit>& limits);
void writeResolution(std::ostream& out, const std::vector<ResolutionRow>& rows);
/// One line for every run that was not made or refused, and why. Returns how many.
int writeSkipped(std::ostream& out, const std::vector<WorkPrecisionRow>& rows);

}  // namespace cloth_sim
