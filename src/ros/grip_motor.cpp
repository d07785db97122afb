#include "grip_motor.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// A motor that is off holds next to nothing: a clamp needs a grip force above 0 [N].
constexpr double kLeastForce = 1e-3;
/// Motion of the plates against each other per motion of the joint below which there is no telling
/// their force [-] or [m].
constexpr double kLeastLever = 1e-6;

}  // namespace

std::optional<double> gripForce(const GripMotor& motor, double effort, const Pose& joint,
                                const std::array<Vec3, 2>& middles) {
  const Vec3 across = (middles[1] - middles[0]).normalized();
  const Vec3 axis = joint.orientation * motor.joint.axis;
  const Vec3 motion =
      motor.joint.isSliding ? axis : axis.cross(middles[motor.plate] - joint.position);
  const double lever = std::abs(motion.dot(across));
  if (!std::isfinite(effort) || !(lever > kLeastLever)) return std::nullopt;
  return std::max(kLeastForce, 2.0 * motor.friction * std::abs(effort) / lever);
}

}  // namespace cloth_sim
