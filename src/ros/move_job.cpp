#include "move_job.h"

#include <algorithm>
#include <cmath>

#include "cloth_sim/validation.h"
#include "support/rotation.h"
#include "support/short_number.h"

namespace cloth_sim {
namespace {

constexpr double kMoveRoundOff = 1e-9;  ///< of times [s] and of speeds, relative
constexpr double kSameTarget = 1e-6;    ///< targets nearer than that are one [m], [rad]
constexpr double kStuckAfter = 1.0;  ///< simulated time without motion after which it is stuck [s]
constexpr double kMotion = 1e-4;     ///< less is no motion [m]
constexpr double kTurn = 1e-3;       ///< less is no turn [rad]
constexpr double kTimeLeft = 5.0;    ///< beyond twice the expected time, by default [s]

std::string ofWaypoint(std::size_t index, const std::string& what) {
  return "poses[" + std::to_string(index) + "]: " + what;
}

double distance(const Pose& a, const Pose& b) { return (b.position - a.position).norm(); }

std::string shortText(double value) { return shortNumber(value, 4); }

/// Returns the time from rest to rest over a way, within limits on speed and acceleration [s].
double timeFor(double way, double speed, double acceleration) {
  return way > 0.0 ? way / speed + speed / acceleration : 0.0;
}

std::string tooFast(std::size_t index, double asked, double limit, const char* unit) {
  return ofWaypoint(index, "expected at most the clamp's " + shortText(limit) + " " + unit +
                               " on the way there (got " + shortText(asked) + ")");
}

}  // namespace

double angleBetween(const Quat& a, const Quat& b) {
  return rotationVector(b * a.conjugate()).norm();
}

std::string validationError(const MovePlan& plan) {
  if (plan.waypoints.empty()) return "poses: expected at least one";
  if (!isNotNegative(plan.speed)) return "speed: expected a finite number >= 0";
  if (!isPositive(plan.positionTolerance))
    return "position_tolerance: expected a finite number >= 0";
  if (!isPositive(plan.orientationTolerance)) {
    return "orientation_tolerance: expected a finite number >= 0";
  }
  if (plan.timeLimit && !isPositive(*plan.timeLimit)) {
    return "time_limit: expected a finite number >= 0";
  }
  if (plan.timed && plan.speed > 0.0) return "speed: expected 0, as there are times_from_start";
  for (std::size_t k = 0; k < plan.waypoints.size(); ++k) {
    const std::string error = validationError(plan.waypoints[k].pose);
    if (!error.empty()) return ofWaypoint(k, error);
    const double time = plan.waypoints[k].time;
    const bool ascends = k == 0 ? isNotNegative(time) : time > plan.waypoints[k - 1].time;
    if (plan.timed && !ascends) {
      return "times_from_start[" + std::to_string(k) + "]: expected " +
             (k == 0 ? "a time >= 0" : "more than the one before");
    }
  }
  return "";
}

/// Returns why this clamp cannot go the way in its times; empty if it can.
std::string MoveJob::limitError(const ClampSpec& spec) const {
  if (!plan_.timed) {
    if (plan_.speed <= spec.maxLinearSpeed * (1.0 + kMoveRoundOff)) return "";
    return "speed: expected at most the clamp's " + shortText(spec.maxLinearSpeed) + " m/s (got " +
           shortText(plan_.speed) + ")";
  }
  for (std::size_t k = 0; k < plan_.waypoints.size(); ++k) {
    const Waypoint& from = before(k);
    const Waypoint& to = plan_.waypoints[k];
    const double time = to.time - from.time;
    const double way = distance(from.pose, to.pose);
    const double turn = angleBetween(from.pose.orientation, to.pose.orientation);
    if (time <= 0.0) {  // the first one, at the start
      if (isNear(from.pose, to.pose)) continue;
      return ofWaypoint(k, "expected the pose of the clamp, as its time is 0 (it is " +
                               shortText(way) + " m away)");
    }
    const double slack = 1.0 + kMoveRoundOff;
    if (way > spec.maxLinearSpeed * time * slack) {
      return tooFast(k, way / time, spec.maxLinearSpeed, "m/s");
    }
    if (turn > spec.maxAngularSpeed * time * slack) {
      return tooFast(k, turn / time, spec.maxAngularSpeed, "rad/s");
    }
  }
  return "";
}

/// Turns a speed into times.
void MoveJob::setTimes(const ClampSpec& spec) {
  double time = 0.0;
  for (std::size_t k = 0; k < plan_.waypoints.size(); ++k) {
    const Pose& from = before(k).pose;
    Waypoint& to = plan_.waypoints[k];
    time += std::max(distance(from, to.pose) / plan_.speed,
                     angleBetween(from.orientation, to.pose.orientation) / spec.maxAngularSpeed);
    to.time = time;
  }
  plan_.timed = true;
}

double MoveJob::expectedTime(const ClampSpec& spec) const {
  if (plan_.timed) return plan_.waypoints.back().time;
  double time = 0.0;
  for (std::size_t k = 0; k < plan_.waypoints.size(); ++k) {
    const Pose& from = before(k).pose;
    const Pose& to = plan_.waypoints[k].pose;
    time += timeFor(distance(from, to), spec.maxLinearSpeed, spec.maxLinearAcceleration);
    time += timeFor(angleBetween(from.orientation, to.orientation), spec.maxAngularSpeed,
                    spec.maxLinearAcceleration / kClampArm);
  }
  return time;
}

ClampJob::Turn MoveJob::begin(const Clamp& clamp, const Simulation& simulation) {
  start_ = {clamp.pose(), 0.0};
  const std::string error = limitError(clamp.spec());
  if (!error.empty()) return {{}, Outcome::kRefused, error};
  if (!plan_.timed && plan_.speed > 0.0) setTimes(clamp.spec());
  startTime_ = seenTime_ = movedAt_ = simulation.time();
  movedFrom_ = clamp.pose();
  limit_ = plan_.timeLimit.value_or(2.0 * expectedTime(clamp.spec()) + kTimeLeft);
  while (plan_.timed && !isLast() && plan_.waypoints[next_].time <= 0.0) ++next_;
  tellProgress(clamp.pose());
  return {{goOn(0.0)}, std::nullopt, ""};
}

/// Returns the command that sends the clamp to the next waypoint, so that it is there in time.
/// \param time  from the start [s].
Command MoveJob::goOn(double time) {
  const Waypoint& from = before(next_);
  const Waypoint& to = plan_.waypoints[next_];
  const double left = to.time - time;
  if (!plan_.timed || left <= kMoveRoundOff) {
    atEnd_ = isLast();
    expected_ = MovingPose{to.pose, Vec3::Zero(), Vec3::Zero(), 0.0};
    return SetClampTarget{clamp(), to.pose};
  }
  const double whole = to.time - from.time;
  const double gone = time - from.time;
  MovingPose target;
  target.linear = (to.pose.position - from.pose.position) / whole;
  target.angular = rotationVector(to.pose.orientation * from.pose.orientation.conjugate()) / whole;
  target.pose.position = from.pose.position + gone * target.linear;
  target.pose.orientation = turned(from.pose.orientation, target.angular, gone);
  target.horizon = left;
  expected_ = normalized(target);
  return GuideClamp{clamp(), target};
}

ClampJob::Turn MoveJob::proceed(const Clamp& clamp, const Simulation& simulation) {
  expected_.advance(simulation.time() - seenTime_);
  seenTime_ = simulation.time();
  const double time = seenTime_ - startTime_;
  if (distance(expected_.pose, clamp.target()) > kSameTarget ||
      angleBetween(expected_.pose.orientation, clamp.target().orientation) > kSameTarget) {
    return {{}, Outcome::kPreempted, "something else sent the clamp elsewhere"};
  }
  Turn turn;
  const std::size_t was = next_;
  const auto passed = [&](const Waypoint& it) {
    return plan_.timed ? time >= it.time - kMoveRoundOff : isNear(clamp.pose(), it.pose);
  };
  while (!isLast() && passed(plan_.waypoints[next_])) ++next_;
  const bool ends = plan_.timed && isLast() && !atEnd_ && passed(plan_.waypoints[next_]);
  if (next_ != was || ends) turn.commands.push_back(goOn(time));
  tellProgress(clamp.pose());
  if (isLast() && atEnd_ && isNear(clamp.pose(), plan_.waypoints.back().pose)) {
    turn.end = Outcome::kReached;
    turn.message = "it is there";
    return turn;
  }
  if (isStuck(clamp, seenTime_)) {
    return giveUp(Outcome::kBlocked, "it has not moved for 1 s: layers of cloth are in its way",
                  clamp);
  }
  if (time < limit_ - kMoveRoundOff) return turn;
  return giveUp(Outcome::kTimedOut, "it was not there within " + shortText(limit_) + " s", clamp);
}

bool MoveJob::isNear(const Pose& pose, const Pose& goal) const {
  return distance(pose, goal) <= plan_.positionTolerance &&
         angleBetween(pose.orientation, goal.orientation) <= plan_.orientationTolerance;
}

/// Tells whether the clamp has stood still for a while although its target is elsewhere.
bool MoveJob::isStuck(const Clamp& clamp, double time) {
  const bool moved = distance(movedFrom_, clamp.pose()) > kMotion ||
                     angleBetween(movedFrom_.orientation, clamp.pose().orientation) > kTurn;
  if (moved || isNear(clamp.pose(), clamp.target())) {
    movedFrom_ = clamp.pose();
    movedAt_ = time;
  }
  return time - movedAt_ > kStuckAfter;
}

void MoveJob::tellProgress(const Pose& pose) {
  double left = distance(pose, plan_.waypoints[next_].pose);
  for (std::size_t k = next_ + 1; k < plan_.waypoints.size(); ++k) {
    left += distance(before(k).pose, plan_.waypoints[k].pose);
  }
  progress_->waypoint = static_cast<std::uint32_t>(next_);
  progress_->distance = left;
}

std::optional<Command> MoveJob::hold(const Clamp& clamp) const {
  return SetClampTarget{this->clamp(), clamp.stoppingPose()};
}

ClampJob::Turn MoveJob::giveUp(Outcome outcome, const std::string& message,
                               const Clamp& clamp) const {
  return {{*hold(clamp)}, outcome, message};
}

}  // namespace cloth_sim
