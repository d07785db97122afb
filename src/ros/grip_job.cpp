#include "grip_job.h"

#include "cloth_sim/validation.h"

namespace cloth_sim {

std::string gripError(double width, double force) {
  if (!std::isfinite(width)) return "position: expected a finite number";
  if (!isNotNegative(force)) {
    return "max_effort: expected a finite number > 0, or 0 for no change";
  }
  return "";
}

/// Sets the force after the width, which may be refused: then nothing has changed.
ClampJob::Turn GripJob::begin(const Clamp& clamp, const Simulation& /*simulation*/) {
  closes_ = width_ <= closingWidth(clamp.spec());
  Turn turn;
  turn.commands.push_back(SetGapWidth{this->clamp(), width_});
  if (force_) turn.commands.push_back(SetGripForce{this->clamp(), force_});
  return turn;
}

ClampJob::Turn GripJob::proceed(const Clamp& clamp, const Simulation& /*simulation*/) {
  const bool open = clamp.state() == ClampState::kOpen;
  if (closes_ == open) {
    return {
        {}, Outcome::kPreempted, open ? "something else opened it" : "something else closed it"};
  }
  if (closes_ && clamp.state() == ClampState::kClosed) {
    return {{}, Outcome::kReached, "the plates have closed"};
  }
  if (open && clamp.gap() >= clamp.spec().gapOpen) {
    return {{}, Outcome::kReached, "the plates have opened"};
  }
  return {};
}

}  // namespace cloth_sim
