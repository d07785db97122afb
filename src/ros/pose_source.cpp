#include "pose_source.h"

#include <ros/names.h>

#include <algorithm>

namespace cloth_sim {
namespace {

/// Checks that `name` is empty or a valid topic name. \return the error, or "".
std::string topicError(const char* what, const std::string& name) {
  std::string error;
  if (name.empty() || ros::names::validate(name, error)) return "";
  return std::string(what) + ": " + error;
}

}  // namespace

std::string toString(const PoseSource& source) {
  switch (source.kind) {
    case PoseSource::Kind::kFrame:
      return "tf frame " + source.name;
    case PoseSource::Kind::kPose:
    case PoseSource::Kind::kOdometry:
      return "topic " + source.name;
    case PoseSource::Kind::kNothing:
      break;
  }
  return "nothing";
}

const char* toString(TrackingStatus::State state) {
  switch (state) {
    case TrackingStatus::State::kTracking:
      return "following";
    case TrackingStatus::State::kLost:
      return "lost";
    case TrackingStatus::State::kWaiting:
      break;
  }
  return "waiting";
}

double silence(double wall, double time) { return time < 0.0 ? wall : std::min(wall, time); }

std::string sourceError(const Follow::Request& request) {
  int sources = 0;
  for (const std::string* name : {&request.tf, &request.pose, &request.odometry}) {
    if (!name->empty()) ++sources;
  }
  if (sources > 1) return "give one of tf, pose and odometry, not several";
  for (const std::string& error :
       {topicError("pose", request.pose), topicError("odometry", request.odometry),
        topicError("grasp_width", request.grasp_width)}) {
    if (!error.empty()) return error;
  }
  return "";
}

PoseSource toPoseSource(const Follow::Request& request) {
  PoseSource source;
  source.graspWidth = request.grasp_width;
  if (!request.tf.empty()) {
    source.kind = PoseSource::Kind::kFrame;
    source.name = request.tf;
  } else if (!request.pose.empty()) {
    source.kind = PoseSource::Kind::kPose;
    source.name = request.pose;
  } else if (!request.odometry.empty()) {
    source.kind = PoseSource::Kind::kOdometry;
    source.name = request.odometry;
  }
  return source;
}

}  // namespace cloth_sim
