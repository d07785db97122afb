#pragma once
/// \file Commands to clamps: where to go, when to grasp, how hard to hold; new ones and old ones.

#include <stdexcept>

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Does `act(clamp)` with the clamp of that name, or refuses the name.
template <typename Act>
CommandResult withClamp(const std::string& name, SimulationParts& parts, Act act) {
  Clamp* clamp = parts.holders.find(name);
  if (clamp == nullptr) return refuseUnknown("clamp", name, parts.holders.clampNames());
  act(*clamp);
  return done();
}

/// Returns the name of an obstacle that `point` is inside of now; "" if it is in none.
std::string obstacleAround(const Vec3& point, const SimulationParts& parts);

/// Reports success, with a warning if the target of a clamp is inside of an obstacle.
CommandResult doneWithTarget(const Clamp& clamp, const SimulationParts& parts);

/// Returns the distance from which a clamp can grasp its patch [m]: that of the place above it
/// where clamps start by default, and half the diagonal of a plate.
double patchReach(const ClampSpec& spec);

/// Closes or opens a clamp. Refuses to close one that has a patch beyond its reach.
CommandResult setClosed(const std::string& clamp, bool closed, SimulationParts& parts);

/// Sends a clamp to a pose, where it goes within its limits on speed and acceleration.
struct SetClampTarget {
  static constexpr const char* kKind = "set_clamp_target";
  static constexpr Wakes kWakes = Wakes::kIfSomethingMoves;

  std::string clamp;
  Pose pose;  ///< in the world

  std::string describe() const { return clamp + " to " + toText(pose.position); }
  std::string validationError() const { return cloth_sim::validationError(pose); }
  CommandResult apply(SimulationParts& parts) const {
    Clamp* it = parts.holders.find(clamp);
    if (it == nullptr) return refuseUnknown("clamp", clamp, parts.holders.clampNames());
    it->setTarget({pose.position, pose.orientation.normalized()});
    return doneWithTarget(*it, parts);
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, pose);
  }
};

/// Sends a clamp along with a target that moves, such as the hand of a robot.
struct GuideClamp {
  static constexpr const char* kKind = "guide_clamp";
  static constexpr Wakes kWakes = Wakes::kIfSomethingMoves;

  std::string clamp;
  MovingPose target;  ///< in the world

  std::string describe() const { return clamp + " to " + toText(target.pose.position); }
  std::string validationError() const { return cloth_sim::validationError(target); }
  CommandResult apply(SimulationParts& parts) const {
    Clamp* it = parts.holders.find(clamp);
    if (it == nullptr) return refuseUnknown("clamp", clamp, parts.holders.clampNames());
    it->guide(normalized(target));
    return doneWithTarget(*it, parts);
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, target);
  }
};

/// Limits the force with which a clamp holds the cloth.
struct SetGripForce {
  static constexpr const char* kKind = "set_grip_force";
  static constexpr Wakes kWakes = Wakes::kAlways;

  std::string clamp;
  std::optional<double> force;  ///< [N], > 0; absent: no limit

  std::string describe() const {
    return clamp + (force ? " " + std::to_string(*force) + " N" : " any");
  }
  std::string validationError() const {
    return !force || isPositive(*force) ? "" : "grip force: expected a finite number > 0";
  }
  CommandResult apply(SimulationParts& parts) const {
    return withClamp(clamp, parts, [this](Clamp& it) { it.setGripForce(force); });
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, force);
  }
};

/// Returns the largest width at which a clamp closes [m]: halfway between closed and open.
inline double closingWidth(const ClampSpec& spec) { return 0.5 * (spec.gapClosed + spec.gapOpen); }

/// Closes or opens a clamp as the width of a gripper says: up to halfway between closed and open it
/// closes, beyond that it lets go.
struct SetGapWidth {
  static constexpr const char* kKind = "set_gap_width";
  static constexpr Wakes kWakes = Wakes::kIfSomethingMoves;

  std::string clamp;
  double width = 0.0;  ///< [m]

  std::string describe() const { return clamp + " " + std::to_string(width) + " m"; }
  std::string validationError() const {
    return std::isfinite(width) ? "" : "width: expected a finite number";
  }
  CommandResult apply(SimulationParts& parts) const {
    const Clamp* it = parts.holders.find(clamp);
    if (it == nullptr) return refuseUnknown("clamp", clamp, parts.holders.clampNames());
    return setClosed(clamp, width <= closingWidth(it->spec()), parts);
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, width);
  }
};

/// Closes a clamp, or lets it go. A clamp with a patch that is out of its reach refuses to close.
struct SetGrasp {
  static constexpr const char* kKind = "set_grasp";
  static constexpr Wakes kWakes = Wakes::kIfSomethingMoves;

  std::string clamp;
  bool grasp = true;  ///< true: close, false: release

  std::string describe() const { return clamp + (grasp ? " closes" : " lets go"); }
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const { return setClosed(clamp, grasp, parts); }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, grasp);
  }
};

/// Adds a clamp, until it is removed or the scene is reset.
struct CreateClamp {
  static constexpr const char* kKind = "create_clamp";
  static constexpr Wakes kWakes = Wakes::kAlways;

  ClampSpec spec;

  std::string describe() const { return spec.name; }
  /// Empty: `Holders::add` checks the specification, against the model too.
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    if (parts.holders.find(spec.name) != nullptr) {
      return refuse("there is a clamp '" + spec.name + "' already");
    }
    try {
      parts.holders.add(spec, parts.model);
      return done();
    } catch (const std::invalid_argument& error) {
      return refuse(error.what());
    }
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(spec);
  }
};

/// Removes a clamp, which lets go, until the scene is reset.
struct DeleteClamp {
  static constexpr const char* kKind = "delete_clamp";
  static constexpr Wakes kWakes = Wakes::kAlways;

  std::string clamp;

  std::string describe() const { return clamp; }
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    if (parts.holders.remove(clamp)) return done();
    return refuseUnknown("clamp", clamp, parts.holders.clampNames());
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp);
  }
};

}  // namespace cloth_sim
