#pragma once
/// \file A limit on the rate of something. No ROS in here.

#include <algorithm>
#include <chrono>

namespace cloth_sim {

/// Limits the mean rate of events to one per period; a single event may come a quarter of a period
/// early. So a source with exactly that rate and some jitter passes completely, while a limit on
/// each interval would drop every early event.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// Tells whether an event may happen now. \param rate  > 0 [Hz]
  bool isDue(Clock::time_point now, double rate) const {
    return now >= slot_ + part(1.0 - kEarly, rate);
  }

  /// Records that an event happens now.
  void take(Clock::time_point now, double rate) {
    const Clock::duration early = part(kEarly, rate);
    slot_ = std::clamp(slot_ + part(1.0, rate), now - early, now + early);
  }

 private:
  static constexpr double kEarly = 0.25;  ///< largest lead of an event, in periods

  static Clock::duration part(double periods, double rate) {
    return std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(periods / rate));
  }

  Clock::time_point slot_;  ///< time at which the last event was due
};

}  // namespace cloth_sim
