#include "gripper_plates.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// Half the width of the box of a plate along a direction [m].
double halfWidth(const LinkBox& box, const Quat& orientation, const Vec3& direction) {
  return (orientation.conjugate() * direction).cwiseAbs().dot(box.half);
}

/// Returns the axis x or y of a frame that is farther from a direction, and normal to it.
Vec3 axisAcross(const Quat& frame, const Vec3& direction) {
  const Vec3 x = frame * Vec3::UnitX();
  const Vec3 y = frame * Vec3::UnitY();
  const Vec3& axis = std::abs(x.dot(direction)) <= std::abs(y.dot(direction)) + 1e-9 ? x : y;
  return (axis - axis.dot(direction) * direction).normalized();
}

}  // namespace

std::optional<PlatePlacement> placeBetween(const std::array<GripperPlate, 2>& plates,
                                           const std::array<Pose, 2>& poses) {
  const Vec3 first = poses[0].toWorld(plates[0].box.centre);
  const Vec3 second = poses[1].toWorld(plates[1].box.centre);
  const double distance = (second - first).norm();
  if (!(distance > 0.0)) return std::nullopt;
  const Vec3 z = (second - first) / distance;
  const double before = halfWidth(plates[0].box, poses[0].orientation, z);
  const double behind = halfWidth(plates[1].box, poses[1].orientation, z);
  Eigen::Matrix3d axes;
  axes.col(0) = axisAcross(poses[0].orientation, z);
  axes.col(1) = z.cross(axes.col(0));
  axes.col(2) = z;
  PlatePlacement result;
  result.pose = {0.5 * (first + second + (before - behind) * z), Quat(axes).normalized()};
  result.gap = std::max(0.0, distance - before - behind);
  result.middles = {first, second};
  return result;
}

MovingPose carried(const MovingPose& frame, const Pose& place) {
  MovingPose result = frame;
  const Vec3 arm = frame.pose.orientation * place.position;
  result.pose.position += arm;
  result.pose.orientation = (frame.pose.orientation * place.orientation).normalized();
  result.linear += frame.angular.cross(arm);
  return result;
}

}  // namespace cloth_sim
