#pragma once
/// \file What a clamp or an obstacle follows, as people say it.

#include <string>

#include "cloth_sim/Follow.h"

namespace cloth_sim {

struct FollowSource {
  enum class Kind { kNothing, kFrame, kPose, kOdometry };
  Kind kind = Kind::kNothing;
  std::string name;        ///< of the tf frame or topic
  std::string graspWidth;  ///< topic of std_msgs/Float64; "": none
};

/// "tf frame gripper_link", "topic /hand/pose"; "nothing".
std::string toString(const FollowSource& source);

/// Empty if at most one of the sources is named, and the names can be names.
std::string followDefect(const Follow::Request& request);
/// \param request  without a defect.
FollowSource toFollowSource(const Follow::Request& request);

/// How a follower gets on.
struct FollowStatus {
  enum class State { kWaiting, kFollowing, kLost };
  std::string follower;  ///< "clamp left", "obstacle ball"
  std::string source;    ///< toString(FollowSource)
  State state = State::kWaiting;
  std::string reason;  ///< why it waits or has lost its source; "" if it follows
};
/// "waiting", "following", "lost"
const char* toString(FollowStatus::State state);

}  // namespace cloth_sim
