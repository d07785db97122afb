#pragma once
/// \file The node's command topics, except those of clamps.

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <std_msgs/String.h>

#include <vector>

#include "cloth_sim/CutStroke.h"
#include "requests.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// Subscribes to ~cut_stroke, ~drag and ~phase_command. Invalid input has no effect but a warning,
/// at most two a second.
class Inputs {
 public:
  Inputs(ros::NodeHandle& privateNode, const RequestChecker& checker, SimulationThread& simulation);

 private:
  void onCutStroke(const CutStroke& stroke);
  void onDrag(const DragRay& ray);
  void onPhase(const std_msgs::String& phase);

  const RequestChecker& checker_;
  SimulationThread& simulation_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace cloth_sim
