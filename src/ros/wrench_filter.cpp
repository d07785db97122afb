#include "wrench_filter.h"

#include <cmath>

namespace cloth_sim {

Wrench WrenchFilter::filter(double time, const Wrench& wrench) {
  if (cutoff_ <= 0.0) return wrench;
  if (!time_ || time < *time_) {
    value_ = wrench;
  } else {
    const double gain = -std::expm1(-2.0 * M_PI * cutoff_ * (time - *time_));
    value_.force += gain * (wrench.force - value_.force);
    value_.torque += gain * (wrench.torque - value_.torque);
  }
  time_ = time;
  return value_;
}

}  // namespace cloth_sim
