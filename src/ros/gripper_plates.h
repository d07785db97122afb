#pragma once
/// \file The place of a clamp between two fingers of a gripper. Needs no node and no master.

#include <array>
#include <optional>
#include <string>

#include "cloth_sim/clamp/moving_pose.h"
#include "robot_description.h"

namespace cloth_sim {

/// A finger of a gripper, as a plate of a clamp.
struct GripperPlate {
  std::string frame;  ///< tf frame of the finger
  LinkBox box;        ///< around its collision geometry, in this frame
};

/// A clamp between two plates.
struct PlatePlacement {
  /// Midway between the plates. Its z axis points from the middle of the first plate to that of the
  /// second; its x axis lies along x of the first plate's frame, or along y if x is nearer to z.
  Pose pose;
  double gap = 0.0;             ///< between the inner sides of the plates, >= 0 [m]
  std::array<Vec3, 2> middles;  ///< of the plates [m]
};

/// Places a clamp between two plates.
/// \param poses  of the frames of both, in any frame that the result is to be in.
/// \return nothing if the middles of the plates coincide.
std::optional<PlatePlacement> placeBetween(const std::array<GripperPlate, 2>& plates,
                                           const std::array<Pose, 2>& poses);

/// Returns the motion of a body that a moving frame carries along. \param place  of it in the
/// frame.
MovingPose carried(const MovingPose& frame, const Pose& place);

}  // namespace cloth_sim
