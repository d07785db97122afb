#pragma once
/// \file Rules for poses and numbers that come from outside: scene files, messages, commands.

#include <cmath>
#include <string>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Tolerance for the norm of a quaternion. Four decimal digits or float32 arithmetic of a sender
/// keep within it. Quaternions within it are normalised, others are refused.
constexpr double kUnitNormTolerance = 1e-3;

/// Tells whether `orientation` is a unit quaternion up to `kUnitNormTolerance` (false for NaN).
inline bool isUnit(const Quat& orientation) {
  return std::abs(orientation.norm() - 1.0) <= kUnitNormTolerance;
}

/// Tells whether `value` is a finite number >= 0.
inline bool isNotNegative(double value) { return std::isfinite(value) && value >= 0.0; }

/// Tells whether `value` is a finite number > 0.
inline bool isPositive(double value) { return std::isfinite(value) && value > 0.0; }

/// Returns why a pose cannot be used, in one sentence; empty if it can.
inline std::string validationError(const Pose& pose) {
  if (!pose.position.allFinite()) return "position: expected three finite numbers";
  if (!pose.orientation.coeffs().allFinite()) return "orientation: expected four finite numbers";
  if (!isUnit(pose.orientation)) {
    return "orientation: expected a unit quaternion (its norm is " +
           std::to_string(pose.orientation.norm()) + ")";
  }
  return "";
}

}  // namespace cloth_sim
