#pragma once
/// \file What the commands of a simulation check, and how they answer.

#include <cmath>
#include <string>

#include "cloth_sim/sim/command.h"

namespace cloth_sim {

/// How far from one the norm of a commanded quaternion may be.
constexpr double kUnitTolerance = 1e-3;

inline CommandResult done(const std::string& message = "") { return {true, message}; }
inline CommandResult refuse(const std::string& message) { return {false, message}; }

/// Why a pose cannot be used; empty if it can.
inline std::string poseDefect(const Pose& pose) {
  if (!pose.position.allFinite()) return "position: expected three finite numbers";
  if (!pose.orientation.coeffs().allFinite()) return "orientation: expected four finite numbers";
  if (std::abs(pose.orientation.norm() - 1.0) > kUnitTolerance) {
    return "orientation: expected a unit quaternion (its norm is " +
           std::to_string(pose.orientation.norm()) + ")";
  }
  return "";
}

template <typename Items, typename Name>
std::string listNames(const Items& items, const Name& name) {
  std::string names;
  for (const auto& item : items) names += (names.empty() ? "" : ", ") + name(item);
  return names.empty() ? "there are none" : "known: " + names;
}

/// Why a target that moves cannot be used; empty if it can.
inline std::string targetDefect(const MovingPose& target) {
  if (!target.linear.allFinite()) return "velocity: expected three finite numbers";
  if (!target.angular.allFinite()) return "angular velocity: expected three finite numbers";
  if (!std::isfinite(target.horizon) || target.horizon < 0.0) {
    return "horizon: expected a number >= 0";
  }
  return poseDefect(target.pose);
}

}  // namespace cloth_sim
