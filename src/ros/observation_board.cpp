#include "observation_board.h"

#include <utility>

namespace cloth_sim {

void ObservationBoard::show(Observation observation) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    observation.number = observation_.number + 1;
    if (observation.whole) {
      observation.wholeNumber = observation.number;
    } else {
      observation.whole = observation_.whole;
      observation.wholeNumber = observation_.wholeNumber;
    }
    observation_ = std::move(observation);
  }
  shown_.notify_all();
}

Observation ObservationBoard::latest() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return observation_;
}

void ObservationBoard::waitFor(std::uint64_t seen, std::chrono::duration<double> timeout) const {
  std::unique_lock<std::mutex> lock(mutex_);
  shown_.wait_for(lock, timeout, [&] { return observation_.number > seen; });
}

void ObservationBoard::addEvents(const std::vector<FailureEvent>& failures,
                                 const std::vector<GripEvent>& grips) {
  if (failures.empty() && grips.empty()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  failures_.events.insert(failures_.events.end(), failures.begin(), failures.end());
  gripEvents_.insert(gripEvents_.end(), grips.begin(), grips.end());
}

void ObservationBoard::addCommand(CommandRecord record) {
  const std::lock_guard<std::mutex> lock(mutex_);
  record.number = commandCount_++;
  commands_.push_back(std::move(record));
}

void ObservationBoard::replaceFailures(FailureBatch failures) {
  const std::lock_guard<std::mutex> lock(mutex_);
  failures_ = std::move(failures);
}

FailureBatch ObservationBoard::takeFailures() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {failures_.resets, std::exchange(failures_.before, {}),
          std::exchange(failures_.events, {})};
}

std::vector<GripEvent> ObservationBoard::takeGripEvents() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(gripEvents_, {});
}

std::vector<CommandRecord> ObservationBoard::takeCommands() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(commands_, {});
}

}  // namespace cloth_sim
