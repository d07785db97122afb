#pragma once
/// \file Errors of both engines in motion.

#include <string>
#include <vector>

#include "study/at_size.h"

namespace cloth_sim::bench {

/// Measures both engines in the swing and the hang of the study, in turns of three frames, against
/// one reference. Prints each row as soon as it is known.
std::vector<AtSizeRow> compareInMotion(int particles);

}  // namespace cloth_sim::bench
