#pragma once
/// \file The node's private parameters.

#include <ros/node_handle.h>

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "camera_topic.h"
#include "pose_source.h"
#include "robot.h"

namespace cloth_sim {

/// An invalid parameter; the message has its name, what was expected and the value.
class ParameterError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The private parameters with their documented defaults (docs/ros_api.md).
struct NodeParameters {
  std::string scene = "tear_seam";   ///< file, or name under config/scenes
  std::vector<std::string> set;      ///< "dotted.key=value" overrides of the scene
  std::string worldFrame = "world";  ///< tf frame of all world quantities
  double rateMarkers = 30.0;         ///< of ~markers and ~scene_markers, >= 0; 0: never [Hz]
  double rateFrame = 60.0;           ///< of ~frame, >= 0; 0: never [Hz]
  double rateSurface = 30.0;         ///< of ~points and ~mesh, >= 0; 0: never [Hz]
  double rateState = 30.0;           ///< of ~state and tf, > 0 [Hz]
  double rateWrench = 60.0;          ///< of the clamps' wrenches, >= 0; 0: never [Hz]
  double rateTracking = 100.0;       ///< of tf look-ups of tracked frames, > 0 [Hz]
  double wrenchCutoff = 0.0;         ///< of the low-pass filter of wrenches, >= 0; 0: none [Hz]
  double realTimeFactor = 1.0;       ///< simulated over wall time, >= 0; 0: as fast as possible
  int threads = 0;                   ///< of the simulation, >= 0; 0: one per processor
  bool paused = false;               ///< start paused
  bool publishClock = false;         ///< publish simulated time on /clock
  std::string stateDirectory = "~/.ros/cloth_sim";  ///< of ~save_state and ~load_state
  double strainRange = 0.2;  ///< strain of the last colour of the markers, > 0 [-]
  bool handles = false;      ///< show interactive markers on clamps and obstacles
  bool twoSided = false;     ///< markers draw the back of the cloth in its own colour
  std::map<std::string, PoseSource> clampSources;     ///< tracked poses, by clamp
  std::map<std::string, PoseSource> obstacleSources;  ///< tracked poses, by obstacle
  std::optional<RobotSettings> robot;                 ///< whose links are obstacles
  std::optional<CameraSettings> camera;               ///< of ~camera_points
};

/// Reads and validates the private parameters; warns about unknown ones.
/// \throws ParameterError
NodeParameters readParameters(const ros::NodeHandle& privateNode);

}  // namespace cloth_sim
