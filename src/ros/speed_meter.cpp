#include "speed_meter.h"

namespace cloth_sim {
namespace {

constexpr double kWindow = 0.5;  ///< wall time of a measurement [s]

}  // namespace

void SpeedMeter::restart(double time) {
  start_ = Clock::now();
  busy_ = {};
  startTime_ = time;
  steps_ = 0;
}

void SpeedMeter::addStep(double time, Clock::duration busy, double cpuTime) {
  busy_ += busy;
  cpuTime_ += cpuTime;
  ++steps_;
  const double wall = std::chrono::duration<double>(Clock::now() - start_).count();
  if (wall < kWindow) return;
  realTimeFactor_ = (time - startTime_) / wall;
  stepTime_ = std::chrono::duration<double>(busy_).count() / steps_;
  restart(time);
}

}  // namespace cloth_sim
