#pragma once
/// \file The springs that have failed: counted, listed, and reported once each.

#include <vector>

#include "cloth_sim/sim/counts.h"
#include "cloth_sim/surgery/failure.h"

namespace cloth_sim {

/// All failures since the start of the simulation or its last reset.
class FailureHistory {
 public:
  void add(const FailureEvent& event);

  const BrokenCounts& counts() const { return counts_; }
  /// All events, in order.
  const std::vector<FailureEvent>& all() const { return events_; }
  /// Returns the events since the last call.
  std::vector<FailureEvent> takeNew();

 private:
  friend class StateFormat;

  BrokenCounts counts_;
  std::vector<FailureEvent> events_;
  std::size_t taken_ = 0;  ///< number of events that takeNew has returned
};

}  // namespace cloth_sim
