#pragma once
/// \file Which method, and how many substeps, a scene needs for an error that one can live with.

#include <iosfwd>
#include <optional>

#include "cloth_sim/study/work_precision.h"

namespace cloth_sim {

struct Advice {
  double bound = 0.0;  ///< on the error
  Reference reference;
  RunResult own;          ///< with the scene's own configuration
  double ownError = 0.0;  ///< of that; NaN if there is none
  std::vector<WorkPrecisionRow> tried;
  std::optional<std::size_t> best;  ///< of `tried`: the cheapest that keeps the bound
};

/// Tries every registered method with its default options and 1, 2, 4 ... substeps: each until its
/// error is within the bound and stays there with twice the substeps (once may be an accident), or
/// it costs more than the cheapest that does so. Errors are against a
/// converged run (see `convergeReference`): of the time of separation if the scene as it is comes
/// apart within its duration, else of positions.
/// \throws std::runtime_error if no converged run comes through.
Advice advise(StudyScene study, double bound, const Announce& announce);

/// For people, with the winner as a block of YAML for the scene.
void writeAdvice(std::ostream& out, const StudyScene& study, const Advice& advice);

}  // namespace cloth_sim
