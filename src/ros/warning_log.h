#pragma once
/// \file Tells which warnings about a result are new.

#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "cloth_sim/sim/result_warning.h"

namespace cloth_sim {

/// Passes each doubt on once, and again after it was gone: a reset takes all doubts back.
class WarningLog {
 public:
  /// \param present  all warnings that there are now.
  /// \return those that were not there at the last call.
  std::vector<ResultWarning> takeNew(const std::vector<ResultWarning>& present) {
    std::vector<ResultWarning> fresh;
    std::set<std::size_t> told;
    for (const ResultWarning& warning : present) {
      if (told_.count(warning.about) == 0) fresh.push_back(warning);
      told.insert(warning.about);
    }
    told_ = std::move(told);
    return fresh;
  }

 private:
  std::set<std::size_t> told_;
};

}  // namespace cloth_sim
