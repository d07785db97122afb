#include "cloth_sim/sim/failure_history.h"

namespace cloth_sim {

void FailureHistory::add(const FailureEvent& event) {
  events_.push_back(event);
  ++counts_.total;
  ++counts_.byKind[static_cast<std::size_t>(event.kind)];
  ++(event.cause == FailureCause::kTear ? counts_.torn : counts_.cut);
}

std::vector<FailureEvent> FailureHistory::takeNew() {
  const auto first = events_.begin() + static_cast<std::ptrdiff_t>(taken_);
  taken_ = events_.size();
  return {first, events_.end()};
}

}  // namespace cloth_sim
