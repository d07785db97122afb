#pragma once
/// \file The speed of a simulation in real time. Independent of ROS.

#include <chrono>

namespace cloth_sim {

/// Measures the real-time factor and the duration of a step as means over half a second, and the
/// CPU time of all steps.
class SpeedMeter {
 public:
  using Clock = std::chrono::steady_clock;

  /// Begins a new measurement; the results of the last one stay.
  /// \param time  simulated time now [s].
  void restart(double time);
  /// Counts a step.
  /// \param time     simulated time after it [s].
  /// \param busy     wall time that it took.
  /// \param cpuTime  CPU time that it took [s].
  void addStep(double time, Clock::duration busy, double cpuTime);
  /// Sets the real-time factor to zero, for a simulation that has stopped.
  void stop() { realTimeFactor_ = 0.0; }

  /// Tells whether steps have been counted since the measurement began.
  bool isMeasuring() const { return steps_ > 0; }
  double realTimeFactor() const { return realTimeFactor_; }  ///< simulated over wall time [-]
  double stepTime() const { return stepTime_; }              ///< wall time of a step [s]
  double cpuTime() const { return cpuTime_; }                ///< of all steps so far [s]

 private:
  Clock::time_point start_;
  Clock::duration busy_{};
  double startTime_ = 0.0;  ///< simulated time at start_ [s]
  int steps_ = 0;
  double realTimeFactor_ = 0.0;
  double stepTime_ = 0.0;
  double cpuTime_ = 0.0;
};

}  // namespace cloth_sim
