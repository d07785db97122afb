#pragma once
/// \file When something that comes at most at a rate is due. No ROS in here.

#include <algorithm>
#include <chrono>

namespace cloth_sim {

/// Holds a mean rate: never more than one a period over time, but single ones may come a quarter of
/// a period early. So what happens at just that rate, with some jitter, is let through each time,
/// where a bound on every single distance would drop each one that comes early.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// \param rate  > 0 [Hz]
  bool isDue(Clock::time_point now, double rate) const {
    return now >= slot_ + part(1.0 - kEarly, rate);
  }

  /// One is taken now.
  void take(Clock::time_point now, double rate) {
    const Clock::duration early = part(kEarly, rate);
    slot_ = std::clamp(slot_ + part(1.0, rate), now - early, now + early);
  }

 private:
  static constexpr double kEarly = 0.25;  ///< of a period

  static Clock::duration part(double periods, double rate) {
    return std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(periods / rate));
  }

  Clock::time_point slot_;  ///< when the last one should have come
};

}  // namespace cloth_sim
