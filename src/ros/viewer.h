#pragma once
/// \file From messages back to a snapshot: what is in a bag can be drawn without the simulation.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <std_msgs/String.h>

#include <vector>

#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/ClothState.h"
#include "cloth_sim/ClothTopology.h"
#include "cloth_sim/ros/markers.h"
#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// What a message says of the surface. Strain is drawn along the edges of the triangles, since a
/// message has no springs.
std::shared_ptr<const Topology> fromTopologyMessage(const ClothTopology& message);
/// Fills in positions and time. \return false, and nothing changed, unless `message` belongs to
/// the snapshot's topology and has a position for each of its vertices.
bool fromFrameMessage(const ClothFrame& message, Snapshot& snapshot);
/// Fills in counts, phase and clamps; `scene` knows the size of their plates.
void fromStateMessage(const ClothState& message, const Scene& scene, Snapshot& snapshot);

/// Draws what a node, or a bag of it, tells of a cloth: topology, frame, state and scene under the
/// namespace of the node "cloth" become markers.
class Viewer {
 public:
  Viewer(ros::NodeHandle& node, const MarkerStyle& style);

 private:
  void onTopology(const ClothTopology& message);
  void onFrame(const ClothFrame& message);
  void onState(const ClothState& message);
  void onScene(const std_msgs::String& message);

  Scene scene_;
  Snapshot snapshot_;
  MarkerBuilder builder_;
  ros::Publisher markers_;
  std::vector<ros::Subscriber> subscribers_;
};

/// Runs a node with a `Viewer` until ROS shuts down.
int runViewer(int argc, char** argv);

}  // namespace cloth_sim
