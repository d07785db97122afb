#include "cloth_sim/solver/error_estimate.h"

#include <sstream>

namespace cloth_sim {

std::string shortfallText(const ErrorEstimate& error) {
  if (error.sufficed) return "";
  std::ostringstream text;
  text.precision(2);
  text << "solver.budget (" << error.budget << " substeps) does not keep solver.error ("
       << error.asked << "): by its estimate, strains have been wrong by up to "
       << error.largestStrain << " and positions by " << 100.0 * error.largestPosition
       << " % of the side";
  return text.str();
}

}  // namespace cloth_sim
