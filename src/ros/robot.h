#pragma once
/// \file The links of a robot that cloth can touch, and the clamps that its grippers are.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "grip_motor.h"
#include "gripper_plates.h"
#include "robot_description.h"

namespace cloth_sim {

/// A clamp of the scene whose plates are two links.
struct GripperSettings {
  std::array<std::string, 2> plates;
  std::string motor;      ///< joint that presses the plates together; "": none limits the grip
  double friction = 0.5;  ///< Coulomb coefficient between plates and cloth, > 0 [-]
};

/// The parameter ~robot.
struct RobotSettings {
  std::string description = "robot_description";  ///< name of the parameter with the URDF
  std::vector<std::string> links;       ///< that are obstacles; empty: all with collision geometry
  std::vector<std::string> selfFilter;  ///< links that are none
  std::map<std::string, GripperSettings> clamps;  ///< by clamp
};

/// One element of the collision geometry of a link, as an obstacle of the scene.
struct RobotObstacle {
  std::string name;  ///< of the obstacle
  std::string link;  ///< and its tf frame
  CollisionPart part;
};

/// A gripper, whose plates a clamp of the scene follows.
struct RobotGripper {
  std::string clamp;
  std::string base;  ///< link from which both plates hang, and its tf frame
  std::array<GripperPlate, 2> plates;
  std::optional<GripMotor> motor;  ///< whose effort limits the grip force
};

/// A robot in a scene.
struct Robot {
  std::vector<RobotObstacle> obstacles;
  std::vector<RobotGripper> grippers;
};

/// Chooses the links that are obstacles, and the plates of the clamps. Plates are no obstacles,
/// unless `settings.links` names them: the clamp takes their place.
/// \throws RobotError
Robot chooseLinks(const RobotDescription& description, const RobotSettings& settings,
                  const MeshFinder& find);

/// Returns the obstacles as overrides of a scene, so that its text has them: recordings and saved
/// states need no robot. They begin below the scene, where no cloth is, and jump to their links as
/// soon as tf knows them.
std::vector<std::string> overridesOf(const std::vector<RobotObstacle>& obstacles);

/// Checks a robot against the scene without it.
/// \param obstacles, clamps  names in the scene.
/// \throws RobotError if an obstacle exists already, or a clamp does not.
void checkNames(const Robot& robot, const std::vector<std::string>& obstacles,
                const std::vector<std::string>& clamps);

}  // namespace cloth_sim
