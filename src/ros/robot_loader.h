#pragma once
/// \file Reads the robot of the parameter ~robot.

#include <ros/node_handle.h>

#include "cloth_sim/scene/scene.h"
#include "parameters.h"

namespace cloth_sim {

/// Reads the robot whose URDF is on the parameter server; an empty robot if there is to be none.
/// \throws ParameterError, which names the parameter ~robot.
Robot loadRobot(const ros::NodeHandle& node, const NodeParameters& parameters);

/// \param withoutIt  the scene as its file says.
/// \param scene      with all overrides.
/// \throws ParameterError if the scene without the robot has an obstacle of it, or if the scene
/// lacks
///         a clamp of it.
void checkRobot(const Robot& robot, const Scene& withoutIt, const Scene& scene);

}  // namespace cloth_sim
