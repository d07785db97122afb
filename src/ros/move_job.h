#pragma once
/// \file The goal of a clamp to move along waypoints. No ROS in here.

#include <atomic>
#include <memory>

#include "clamp_job.h"

namespace cloth_sim {

/// A pose on the way of a clamp.
struct Waypoint {
  Pose pose;          ///< in the world
  double time = 0.0;  ///< from the start [s], if the plan is timed
};

/// The way that a clamp is to go.
struct MovePlan {
  std::vector<Waypoint> waypoints;     ///< at least one
  bool timed = false;                  ///< whether the waypoints have times
  double speed = 0.0;                  ///< if not: along the way [m/s]; 0: as fast as it can
  double positionTolerance = 0.001;    ///< [m]
  double orientationTolerance = 0.01;  ///< [rad]
  std::optional<double> timeLimit;     ///< [s]; absent: twice the time of the way and 5 s
};

/// Returns why a plan cannot be followed by any clamp, in one sentence; empty if some can.
std::string validationError(const MovePlan& plan);

/// Returns the angle between two orientations [rad].
double angleBetween(const Quat& a, const Quat& b);

/// The progress of a clamp on its way. Written by the simulation thread, read by others.
struct MoveProgress {
  std::atomic<std::uint32_t> waypoint{0};  ///< index of the one that it goes to
  std::atomic<double> distance{0.0};       ///< left along the way [m]
};

/// Moves a clamp along waypoints: straight, and evenly between those that have times. Over when it
/// is within the tolerances of the last one.
class MoveJob : public ClampJob {
 public:
  /// \param plan  without a validationError.
  MoveJob(const std::string& clamp, MovePlan plan, std::shared_ptr<MoveProgress> progress,
          ClampJobListener listener)
      : ClampJob(clamp, Part::kMotion, std::move(listener)),
        plan_(std::move(plan)),
        progress_(std::move(progress)) {}

  Turn begin(const Clamp& clamp, const Simulation& simulation) override;
  Turn proceed(const Clamp& clamp, const Simulation& simulation) override;
  std::optional<Command> hold(const Clamp& clamp) const override;

 private:
  std::string limitError(const ClampSpec& spec) const;
  void setTimes(const ClampSpec& spec);
  double expectedTime(const ClampSpec& spec) const;
  const Waypoint& before(std::size_t k) const { return k == 0 ? start_ : plan_.waypoints[k - 1]; }
  Command goOn(double time);
  bool isLast() const { return next_ + 1 == plan_.waypoints.size(); }
  bool isNear(const Pose& pose, const Pose& goal) const;
  bool isStuck(const Clamp& clamp, double time);
  void tellProgress(const Pose& pose);
  Turn giveUp(Outcome outcome, const std::string& message, const Clamp& clamp) const;

  MovePlan plan_;
  std::shared_ptr<MoveProgress> progress_;
  Waypoint start_;          ///< the clamp at the start
  double startTime_ = 0.0;  ///< [s]
  double limit_ = 0.0;      ///< [s] from the start
  double seenTime_ = 0.0;   ///< of the last turn [s]
  std::size_t next_ = 0;    ///< waypoint that it goes to
  bool atEnd_ = false;      ///< whether it is sent to the last waypoint, to stay there
  MovingPose expected_;     ///< target of the clamp, unless somebody else changed it
  Pose movedFrom_;          ///< pose when it last moved noticeably
  double movedAt_ = 0.0;    ///< time of that [s]
};

}  // namespace cloth_sim
