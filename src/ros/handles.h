#pragma once
/// \file Interactive markers with which the mouse moves clamps and obstacles in rviz.

#include <interactive_markers/interactive_marker_server.h>
#include <interactive_markers/menu_handler.h>
#include <ros/node_handle.h>
#include <ros/steady_timer.h>

#include <map>
#include <mutex>
#include <set>
#include <string>

#include "requests.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// Returns a handle on one clamp, with six degrees of freedom and a menu to grasp and release.
visualization_msgs::InteractiveMarker clampHandle(const ClampSnapshot& clamp,
                                                  const std::string& world);

/// Returns a handle on a sphere or board, which moves along three axes.
visualization_msgs::InteractiveMarker obstacleHandle(const Obstacle& obstacle,
                                                     const std::string& world);

/// Tells whether an obstacle gets a handle: planes and bounds reach too far for one.
bool hasHandle(const Obstacle& obstacle);

/// Serves the handles of a scene as the interactive markers ~handles. A clamp moves to its handle
/// within its limits; an obstacle moves to its handle at up to 0.5 m/s (simulated time). A handle
/// that nobody holds stays on its clamp or obstacle.
class Handles {
 public:
  /// \param world  tf frame of the world.
  Handles(const ros::NodeHandle& privateNode, const std::string& world,
          const RequestChecker& checker, SimulationThread& simulation);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  /// An obstacle, and where its handle is.
  struct Guided {
    Pose pose;              ///< where the obstacle was sent last
    Vec3 goal;              ///< position of the handle [m]
    bool underWay = false;  ///< the obstacle has yet to reach the handle
    double time = 0.0;      ///< simulated time of `pose` [s]
  };

  void add(const visualization_msgs::InteractiveMarker& marker);
  void onFeedback(const Feedback& feedback);
  void onGrasp(const std::string& marker, bool grasp);
  void sendObstacle(const std::string& obstacle, const Vec3& goal);
  void refresh();
  void updateClampHandles(const Snapshot& now);
  std::map<std::string, Pose> moved(const Snapshot& now);
  void advance(const std::string& obstacle, Guided& guided, double time);
  /// Returns whether a handle is to be moved to `pose`; if so, remembers the pose.
  bool shallShow(const std::string& marker, const Pose& pose);

  const RequestChecker& checker_;
  SimulationThread& simulation_;
  std::string world_;
  std::set<std::string> clamps_;          ///< clamps with a handle; for constructor and timer only
  std::mutex mutex_;                      ///< guards the next three, for callbacks of any thread
  std::string held_;                      ///< marker that the mouse holds; "": none
  std::map<std::string, Pose> shown_;     ///< poses of the handles, by marker
  std::map<std::string, Guided> guided_;  ///< by obstacle
  interactive_markers::InteractiveMarkerServer server_;
  interactive_markers::MenuHandler menu_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
