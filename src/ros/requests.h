#pragma once
/// \file The border: what comes in by message is checked here and becomes a command, or a message
/// that says why not. Nothing that fails a check reaches the simulation.

#include <geometry_msgs/PoseStamped.h>

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cloth_sim/AddClamp.h"
#include "cloth_sim/CutStroke.h"
#include "cloth_sim/DragRay.h"
#include "cloth_sim/GripperCommand.h"
#include "cloth_sim/Refine.h"
#include "cloth_sim/ResetScene.h"
#include "cloth_sim/scene/scene.h"
#include "cloth_sim/sim/command.h"

namespace cloth_sim {

/// Why a request is refused, in one sentence.
struct Refusal {
  std::string message;
};
using Request = std::variant<Command, Refusal>;

/// Turns a pose in a tf frame into the world frame.
/// \throws std::runtime_error if the frame is unknown at the asked time.
using WorldTransform = std::function<Pose(const Pose&, const std_msgs::Header&)>;

/// Checks requests against what a scene has. Clamps come and go: whether one is there, only the
/// simulation can say.
class RequestChecker {
 public:
  RequestChecker(const Scene& scene, WorldTransform toWorld);

  Request clampPose(const std::string& clamp, const geometry_msgs::PoseStamped& pose) const;
  Request grasp(const std::string& clamp, bool grasp) const;
  /// The force limit first, if there is one, then the width; or a single refusal.
  std::vector<Request> gripper(const std::string& clamp, const GripperCommand& command) const;
  Request gripWidth(const std::string& clamp, double width) const;
  Request newClamp(const AddClamp::Request& message) const;
  Request phase(const std::string& phase) const;
  Request reset(std::uint8_t scope) const;
  /// Empty if `factor` can be a real-time factor.
  std::string realTimeFactor(double factor) const;
  /// Empty if the number of steps can be asked for.
  std::string steps(std::uint32_t count) const;
  Request stroke(const CutStroke& message) const;
  Request drag(const DragRay& message) const;
  Request refinement(const Refine::Request& message) const;
  /// Empty if `name` can be the name of a saved state: no path, nothing hidden.
  std::string stateName(const std::string& name) const;

  const std::vector<std::string>& phases() const { return phases_; }

 private:
  std::vector<std::string> phases_;
  WorldTransform toWorld_;
};

}  // namespace cloth_sim
