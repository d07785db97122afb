#pragma once
/// \file The node's command topics but those of clamps. Bad input is warned about, not more often
/// than twice a second, and has no effect.

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <std_msgs/String.h>

#include <vector>

#include "cloth_sim/CutStroke.h"
#include "requests.h"
#include "simulation_thread.h"

namespace cloth_sim {

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
