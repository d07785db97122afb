#pragma once
/// \file Interactive markers: clamps and obstacles that are moved with the mouse in rviz.

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

/// A handle on one clamp, with six degrees of freedom and a menu to grasp and release.
visualization_msgs::InteractiveMarker clampHandle(const ClampSnapshot& clamp,
                                                  const std::string& world);

/// A handle on a sphere or board, along three axes.
visualization_msgs::InteractiveMarker obstacleHandle(const Obstacle& obstacle,
                                                     const std::string& world);

/// Whether an obstacle gets a handle: planes and bounds reach too far for one.
bool hasHandle(const Obstacle& obstacle);

/// Serves the handles of a scene as the interactive markers ~handles. A clamp goes where its handle
/// is put, within its limits; an obstacle follows its handle at 0.5 m/s of simulated time at most.
/// Handles that nobody holds go along with what they are on.
class Handles {
 public:
  /// \param world  tf frame of the world.
  Handles(const ros::NodeHandle& privateNode, const std::string& world,
          const RequestChecker& checker, SimulationThread& simulation);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  /// An obstacle on its way to its handle.
  struct Guided {
    Pose pose;  ///< where it was sent last
    Vec3 goal;  ///< where its handle is [m]
    bool underWay = false;
    double time = 0.0;  ///< simulated, of `pose` [s]
  };

  void add(const visualization_msgs::InteractiveMarker& marker);
  void onFeedback(const Feedback& feedback);
  void onGrasp(const std::string& marker, bool grasp);
  void guide(const std::string& obstacle, const Vec3& goal);
  void refresh();
  void followClamps(const Snapshot& now);
  std::map<std::string, Pose> moved(const Snapshot& now);
  void advance(const std::string& obstacle, Guided& guided, double time);
  /// Whether a handle is to be moved there; then it is remembered to be.
  bool shallShow(const std::string& marker, const Pose& pose);
  void submit(const Request& request);

  const RequestChecker& checker_;
  SimulationThread& simulation_;
  std::string world_;
  std::set<std::string> clamps_;          ///< that have a handle; for the constructor and the timer
  std::mutex mutex_;                      ///< of what is below; callbacks come from several threads
  std::string held_;                      ///< marker that a mouse holds; empty: none
  std::map<std::string, Pose> shown_;     ///< by marker
  std::map<std::string, Guided> guided_;  ///< by obstacle
  interactive_markers::InteractiveMarkerServer server_;
  interactive_markers::MenuHandler menu_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
