#pragma once
/// \file The source of poses that a clamp or an obstacle tracks, as a user names it.

#include <string>

#include "cloth_sim/Follow.h"

namespace cloth_sim {

/// A source without a new pose for longer than this is lost [s].
constexpr double kSourceTimeout = 0.5;

/// A tf frame or a topic of poses, and for a clamp the topic of a hand's width.
struct PoseSource {
  enum class Kind { kNothing, kFrame, kPose, kOdometry };
  Kind kind = Kind::kNothing;
  std::string name;        ///< of the tf frame or of the topic
  std::string graspWidth;  ///< topic of std_msgs/Float64 [m]; "": none
  double patience =
      kSourceTimeout;          ///< how long the first pose may take until it counts as lost [s]
  bool repeatsStatic = false;  ///< a static frame is passed on at each look-up
};

/// Describes a source: "tf frame gripper_link", "topic /hand/pose", "nothing".
std::string toString(const PoseSource& source);

/// Checks that a request names at most one source, and only valid topic names.
/// \return the validation error; empty if the request is valid.
std::string sourceError(const Follow::Request& request);
/// \param request  valid according to `sourceError`.
PoseSource toPoseSource(const Follow::Request& request);

/// Returns how long a source has been silent [s]: by the wall, but not while ROS time stands still,
/// as in a paused simulation by which all live. \param wall, time  since the last pose, by the wall
/// and by ROS time [s]; ROS time may jump back.
double silence(double wall, double time);

/// State of one tracker, for the diagnostics.
struct TrackingStatus {
  enum class State { kWaiting, kTracking, kLost };
  std::string name;    ///< of what is moved: "clamp left", "obstacle ball"
  std::string source;  ///< toString(PoseSource)
  State state = State::kWaiting;
  std::string reason;  ///< why there is no pose yet or any more; "" while tracking
};
/// Names a state as the diagnostics do: "waiting", "following", "lost".
const char* toString(TrackingStatus::State state);

}  // namespace cloth_sim
