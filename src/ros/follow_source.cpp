#include "follow_source.h"

#include <ros/names.h>

namespace cloth_sim {
namespace {

/// Empty if `name` is empty or can be the name of a topic.
std::string topicDefect(const char* what, const std::string& name) {
  std::string error;
  if (name.empty() || ros::names::validate(name, error)) return "";
  return std::string(what) + ": " + error;
}

}  // namespace

std::string toString(const FollowSource& source) {
  switch (source.kind) {
    case FollowSource::Kind::kFrame:
      return "tf frame " + source.name;
    case FollowSource::Kind::kPose:
    case FollowSource::Kind::kOdometry:
      return "topic " + source.name;
    case FollowSource::Kind::kNothing:
      break;
  }
  return "nothing";
}

const char* toString(FollowStatus::State state) {
  switch (state) {
    case FollowStatus::State::kFollowing:
      return "following";
    case FollowStatus::State::kLost:
      return "lost";
    case FollowStatus::State::kWaiting:
      break;
  }
  return "waiting";
}

std::string followDefect(const Follow::Request& request) {
  int sources = 0;
  for (const std::string* name : {&request.tf, &request.pose, &request.odometry}) {
    if (!name->empty()) ++sources;
  }
  if (sources > 1) return "give one of tf, pose and odometry, not several";
  for (const std::string& defect :
       {topicDefect("pose", request.pose), topicDefect("odometry", request.odometry),
        topicDefect("grasp_width", request.grasp_width)}) {
    if (!defect.empty()) return defect;
  }
  return "";
}

FollowSource toFollowSource(const Follow::Request& request) {
  FollowSource source;
  source.graspWidth = request.grasp_width;
  if (!request.tf.empty()) {
    source.kind = FollowSource::Kind::kFrame;
    source.name = request.tf;
  } else if (!request.pose.empty()) {
    source.kind = FollowSource::Kind::kPose;
    source.name = request.pose;
  } else if (!request.odometry.empty()) {
    source.kind = FollowSource::Kind::kOdometry;
    source.name = request.odometry;
  }
  return source;
}

}  // namespace cloth_sim
