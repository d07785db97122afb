#pragma once
/// \file The grip force of a gripper from the effort of its motor. Needs no node and no master.

#include <array>
#include <optional>
#include <string>

#include "robot_description.h"

namespace cloth_sim {

/// A joint that moves one plate of a gripper against the other.
struct GripMotor {
  std::string name;       ///< of the joint
  RobotJoint joint;       ///< what it moves
  std::size_t plate = 0;  ///< the plate that it moves
  double friction = 0.5;  ///< Coulomb coefficient between plates and cloth, > 0 [-]
};

/// Returns the force that cloth between the plates bears until it slips [N], > 0: friction of both
/// plates, 2 mu N. By virtual work, an effort T presses the plates together with N = T / |dg/dq|,
/// with g their distance and q the position of the joint. What the joint loses by its own friction
/// is not taken off.
/// \param effort   of the joint, of either sign [N] or [N m].
/// \param joint    pose of the frame of the joint.
/// \param middles  of the plates, in the same frame as `joint` [m].
/// \return nothing if the effort is not finite, or if the joint hardly moves the plates against
///         each other.
std::optional<double> gripForce(const GripMotor& motor, double effort, const Pose& joint,
                                const std::array<Vec3, 2>& middles);

}  // namespace cloth_sim
