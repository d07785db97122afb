#include "cloth_sim/sim/sleep.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Round-off of a sum of many time steps, compared with the time that a scene names [s].
constexpr double kTimeTolerance = 1e-9;

}  // namespace

void Sleep::beginStep(const State& state) {
  if (settings_) before_ = state.x.values();
}

bool Sleep::isSlow(const State& state, double dt) const {
  if (!settings_ || before_.size() != state.x.values().size()) return false;
  const double most = settings_->speed * dt;
  return std::equal(
      before_.begin(), before_.end(), state.x.values().begin(),
      [most](const Vec3& from, const Vec3& to) { return (to - from).squaredNorm() < most * most; });
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
