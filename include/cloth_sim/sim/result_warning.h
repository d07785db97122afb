#pragma once
/// \file Warnings of a simulation about its own results.

#include <cstddef>
#include <string>

namespace cloth_sim {

/// A doubt about the result of a simulation that goes on.
struct ResultWarning {
  std::size_t about = 0;  ///< the same number as long as it is the same doubt, whatever the figures
  std::string text;       ///< one sentence
};

}  // namespace cloth_sim
