#include "rotation.h"

#include <cmath>

namespace cloth_sim {

Vec3 rotationVector(const Quat& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return q.vec() * (sign * 2.0 * std::atan2(sine, std::abs(q.w())) / sine);
}

Quat turned(const Quat& orientation, const Vec3& angularVelocity, double dt) {
  const double speed = angularVelocity.norm();
  if (speed == 0.0) return orientation;
  const Quat turn(Eigen::AngleAxisd(speed * dt, angularVelocity / speed));
  return (turn * orientation).normalized();
}

}  // namespace cloth_sim
