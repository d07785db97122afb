#include "cloth_sim/sim/sleep.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Round-off of a sum of many time steps, compared with the time that a scene names [s].
constexpr double kTimeTolerance = 1e-9;

}  // namespace

bool Sleep::isSlow(const State& state) const {
  if (!settings_) return false;
  const double limit = settings_->speed * settings_->speed;
  return std::all_of(state.v.begin(), state.v.end(),
                     [limit](const Vec3& v) { return v.squaredNorm() < limit; });
}

bool Sleep::endStep(bool rests, double dt) {
  if (!settings_) return false;
  atRest_ = rests ? atRest_ + dt : 0.0;
  asleep_ = rests && atRest_ >= settings_->after - kTimeTolerance;
  return asleep_;
}

void Sleep::wake() {
  asleep_ = false;
  atRest_ = 0.0;
}

}  // namespace cloth_sim
