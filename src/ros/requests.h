#pragma once
/// \file From messages to commands: what cannot be understood becomes a message that says why.
///
/// This border checks what belongs to a message: its frame, its size, fields that exclude each
/// other. What the values must be, every command says itself (sim/command.h), and
/// `Simulation::apply` asks it before anything changes.

#include <geometry_msgs/PoseStamped.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cloth_sim/AddClamp.h"
#include "cloth_sim/CutStroke.h"
#include "cloth_sim/DragRay.h"
#include "cloth_sim/GripperCommand.h"
#include "cloth_sim/MoveClampGoal.h"
#include "cloth_sim/Refine.h"
#include "cloth_sim/ResetScene.h"
#include "cloth_sim/scene/scene.h"
#include "cloth_sim/sim/command.h"
#include "move_job.h"

namespace cloth_sim {

/// Says why a request is refused, in one sentence.
struct Refusal {
  std::string message;
};
/// A command, or why a message makes none.
using Request = std::variant<Command, Refusal>;

/// A way for a clamp, or why a message makes none.
using MoveRequest = std::variant<MovePlan, Refusal>;

/// Turns a pose in a tf frame into the world frame.
/// \throws std::runtime_error if the frame is unknown at the asked time.
using WorldTransform = std::function<Pose(const Pose&, const std_msgs::Header&)>;

/// Turns messages into commands in the world frame. Thread-safe if `WorldTransform` is.
class RequestChecker {
 public:
  RequestChecker(const Scene& scene, WorldTransform toWorld);

  Request clampPose(const std::string& clamp, const geometry_msgs::PoseStamped& pose) const;
  Request grasp(const std::string& clamp, bool grasp) const;
  /// Returns the command for the force, if there is one, then that for the width; or a single
  /// refusal, if either is invalid.
  std::vector<Request> gripper(const std::string& clamp, const GripperCommand& command) const;
  Request gripWidth(const std::string& clamp, double width) const;
  /// Returns the way of a goal, in the world frame.
  MoveRequest move(const MoveClampGoal& goal) const;
  /// Returns the way of a trajectory with at least one point, each with one transform.
  MoveRequest trajectory(const trajectory_msgs::MultiDOFJointTrajectory& message) const;
  Request newClamp(const AddClamp::Request& message) const;
  Request reset(std::uint8_t scope) const;
  Request resolution(std::uint32_t columns) const;
  Request stroke(const CutStroke& message) const;
  Request drag(const DragRay& message) const;
  Request refinement(const Refine::Request& message) const;

  /// The names of the scene's phases, in order.
  const std::vector<std::string>& phases() const { return phases_; }
  /// Returns why there is no phase of that name to run to; empty if there is one.
  std::string phaseError(const std::string& phase) const;

 private:
  Pose frameOf(const std_msgs::Header& header) const { return toWorld_(Pose(), header); }

  std::vector<std::string> phases_;
  WorldTransform toWorld_;
};

/// Returns why `factor` cannot be a real-time factor; empty if it can.
std::string realTimeFactorError(double factor);
/// Returns why that many steps cannot be requested at once; empty if they can.
std::string stepCountError(std::uint32_t count);
/// Returns why `name` cannot name a saved state; empty if it can: no path, nothing hidden.
std::string stateNameError(const std::string& name);

}  // namespace cloth_sim
