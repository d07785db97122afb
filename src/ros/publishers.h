#pragma once
/// \file The topics of the node, published from a thread of its own so that stepping never waits.

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <std_msgs/String.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include "camera_topic.h"
#include "clamp_ports.h"
#include "cloth_sim/CompactFrame.h"
#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/markers.h"
#include "obstacle_trackers.h"
#include "obstacle_wrenches.h"
#include "parameters.h"
#include "robot_trackers.h"
#include "simulation_thread.h"
#include "warning_log.h"

namespace cloth_sim {

/// The clamps, obstacles and camera that are moved from outside, for their topics and diagnostics.
struct Trackers {
  ClampPorts& clamps;
  ObstacleTrackers& obstacles;
  RobotTrackers& robot;
  CameraTopic& camera;

  /// Has all follow their sources again, after a reset, which puts them back to where they began.
  void repeat() const {
    clamps.repeat();
    obstacles.repeat();
    robot.repeat();
  }
};

/// Publishes all topics of the node, tf and diagnostics, each at its rate. Topics without
/// subscribers are not computed.
class Publishers {
 public:
  /// \param scene  text of the scene, for recordings.
  Publishers(ros::NodeHandle& node, ros::NodeHandle& privateNode, const NodeParameters& parameters,
             const std::string& scene, SimulationThread& simulation, const Trackers& trackers);
  ~Publishers();
  Publishers(const Publishers&) = delete;
  Publishers& operator=(const Publishers&) = delete;

 private:
  using Clock = std::chrono::steady_clock;

  /// When something is to be sent: at most at its rate, and only if there is something new or
  /// someone new, or nothing was sent for a second.
  struct Schedule {
    explicit Schedule(double hz) : rate(hz) {}
    bool due(Clock::time_point now, std::uint64_t observation, std::uint32_t subscribers);

    double rate = 0.0;       ///< [Hz]; 0: never
    Clock::time_point last;  ///< when it was sent
    Pace pace;
    std::uint64_t lastObservation = 0;  ///< what was sent
    std::uint32_t lastSubscribers = 0;
  };

  void run();
  void tick();
  ros::Time stampOf(const Snapshot& snapshot) const;
  void repeatLatched();
  void sendCommands();
  void sendTopology(const Observation& observation);
  void sendEvents(const Observation& observation);
  void sendGraspEvents();
  void sendPhase(const Observation& observation);
  void sendState(const Observation& observation);
  void sendSceneFrame();
  void sendTransforms(const Snapshot& snapshot);
  void sendFrame(const Observation& observation);
  void sendCompactFrame(const Observation& observation);
  void sendSurfaces(const Observation& observation, Clock::time_point now);
  void sendMarkers(const Observation& observation);
  void sendContacts(const Observation& observation, Clock::time_point now);
  void sendSceneMarkers(const Observation& observation);
  void diagnoseTrackers(diagnostic_updater::DiagnosticStatusWrapper& status);
  void logWarnings(const std::vector<ResultWarning>& warnings);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  double wantedRate() const;
  double wantedFigures() const;
  bool wantContacts() const;

  NodeParameters parameters_;
  SimulationThread& simulation_;
  Trackers trackers_;
  std::string nodeName_;
  ros::Publisher markers_;
  ros::Publisher sceneMarkers_;
  ros::Publisher topology_;
  ros::Publisher frame_;
  ros::Publisher compactFrame_;
  ros::Publisher state_;
  ros::Publisher brokenSprings_;
  ros::Publisher tearEvents_;
  ros::Publisher phase_;
  ros::Publisher commands_;
  ros::Publisher scene_;
  ros::Publisher graspEvents_;
  ros::Publisher contacts_;
  ros::Publisher points_;
  ros::Publisher mesh_;
  ObstacleWrenches obstacleWrenches_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster staticBroadcaster_;
  diagnostic_updater::Updater updater_;

  Schedule markersSchedule_;
  Schedule sceneMarkersSchedule_;
  Schedule contactsSchedule_;
  Schedule frameSchedule_;
  Schedule compactFrameSchedule_;
  Schedule transformsSchedule_;
  Schedule stateSchedule_;
  Schedule wrenchSchedule_;
  Schedule obstacleWrenchSchedule_;
  Schedule pointsSchedule_;
  Schedule meshSchedule_;
  Schedule cameraSchedule_;
  MarkerBuilder builder_;
  MarkerBuilder sceneBuilder_;
  ClothFrame frameMessage_;
  CompactFrame compactFrameMessage_;
  FailureLog failures_;
  std_msgs::Header header_;  ///< of all messages of one tick
  std::shared_ptr<const Topology> sentTopology_;
  std::optional<std::string> sentPhase_;
  std_msgs::String sceneText_;
  std::optional<Clock::time_point> repeated_;  ///< time of the last latched messages
  ros::Time sentTransforms_;
  int sentBroken_ = -1;               ///< number of broken springs sent last; -1: none yet
  std::uint64_t resetsSeen_ = 0;      ///< in the batches of events
  std::uint64_t resetsFollowed_ = 0;  ///< in the observations
  Observation diagnosed_;             ///< the last observation
  WarningLog warningLog_;

  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last: it uses everything above
};

}  // namespace cloth_sim
