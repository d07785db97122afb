#include "clamp_actions.h"

#include <ros/console.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/validation.h"
#include "grip_job.h"

namespace cloth_sim {
namespace {

constexpr double kProgressPeriod = 0.1;  ///< of feedback, in wall time [s]
using Outcome = ClampJobResult::Outcome;

/// Returns a force for a GripJob: none if the message leaves it at zero.
std::optional<double> forceOf(double given) {
  return given > 0.0 ? std::optional<double>(given) : std::nullopt;
}

// ---- gripper ----------------------------------------------------------------------------------

using Gripper = ClampActionServer<gripper_msgs::GripperCommandAction>;

Gripper::Work gripWork(const std::string& clamp, const Gripper::Goal& goal,
                       const ClampJobListener& listener) {
  const std::string error = gripError(goal.command.position, goal.command.max_effort);
  if (!error.empty()) throw std::runtime_error(error);
  Gripper::Work work;
  work.job = std::make_shared<GripJob>(clamp, goal.command.position,
                                       forceOf(goal.command.max_effort), listener);
  return work;
}

bool toGripResult(const ClampJobResult& end, Gripper::Result& result) {
  result.position = end.gap;
  result.effort = end.force;
  result.stalled = !end.held.empty();
  result.reached_goal = end.outcome == Outcome::kReached;
  return result.reached_goal;
}

Gripper::Feedback toGripFeedback(const ClampSnapshot& clamp) {
  Gripper::Feedback feedback;
  feedback.position = clamp.gap;
  feedback.effort = clamp.wrench.force.norm();
  feedback.stalled = clamp.state == ClampState::kClosed && clamp.contents.held > 0;
  feedback.reached_goal = false;
  return feedback;
}

// ---- grasp_cloth ------------------------------------------------------------------------------

using GraspCloth = ClampActionServer<GraspClothAction>;

GraspCloth::Work graspWork(const std::string& clamp, const GraspClothGoal& goal,
                           const ClampJobListener& listener) {
  if (!isNotNegative(goal.grip_force)) {
    throw std::runtime_error("grip_force: expected a finite number > 0, or 0 for no change");
  }
  GraspCloth::Work work;
  work.job = std::make_shared<GripJob>(clamp, 0.0, forceOf(goal.grip_force), listener);
  return work;
}

std::uint8_t graspOutcome(const ClampJobResult& end) {
  switch (end.outcome) {
    case Outcome::kReached:
      return end.held.empty() ? GraspClothResult::NOTHING : GraspClothResult::HOLDS;
    case Outcome::kPreempted:
    case Outcome::kCancelled:
      return GraspClothResult::PREEMPTED;
    case Outcome::kRefused:
      return GraspClothResult::REFUSED;
    default:
      return GraspClothResult::FAILED;
  }
}

bool toGraspResult(const ClampJobResult& end, GraspClothResult& result) {
  result.outcome = graspOutcome(end);
  result.message = end.message;
  if (result.outcome == GraspClothResult::HOLDS) {
    result.message = "it holds " + std::to_string(end.held.size()) + " particles";
  } else if (result.outcome == GraspClothResult::NOTHING) {
    result.message = "it has closed, and holds nothing";
  }
  for (const VertexId v : end.held) result.particles.push_back(static_cast<std::uint32_t>(v));
  result.revision = end.revision;
  result.held = static_cast<std::uint32_t>(end.held.size());
  result.held_area = end.heldArea;
  result.time = end.time;
  return result.outcome == GraspClothResult::HOLDS;
}

GraspClothFeedback toGraspFeedback(const ClampSnapshot& clamp) {
  GraspClothFeedback feedback;
  feedback.gap = clamp.gap;
  feedback.held = static_cast<std::uint32_t>(clamp.contents.held);
  return feedback;
}

// ---- move -------------------------------------------------------------------------------------

using Move = ClampActionServer<MoveClampAction>;

Move::Work moveWork(const std::string& clamp, const MoveRequest& request,
                    const ClampJobListener& listener) {
  if (const auto* refusal = std::get_if<Refusal>(&request)) {
    throw std::runtime_error(refusal->message);
  }
  const MovePlan& plan = std::get<MovePlan>(request);
  Move::Work work;
  work.goal = plan.waypoints.back().pose;
  work.progress = std::make_shared<MoveProgress>();
  work.job = std::make_shared<MoveJob>(clamp, plan, work.progress, listener);
  return work;
}

std::uint8_t moveOutcome(Outcome outcome) {
  switch (outcome) {
    case Outcome::kReached:
      return MoveClampResult::REACHED;
    case Outcome::kBlocked:
      return MoveClampResult::BLOCKED;
    case Outcome::kPreempted:
    case Outcome::kCancelled:
      return MoveClampResult::PREEMPTED;
    case Outcome::kTimedOut:
      return MoveClampResult::TIMED_OUT;
    case Outcome::kRefused:
      return MoveClampResult::REFUSED;
    case Outcome::kFailed:
      break;
  }
  return MoveClampResult::FAILED;
}

bool toMoveResult(const ClampJobResult& end, const Pose& goal, MoveClampResult& result) {
  result.outcome = moveOutcome(end.outcome);
  result.message = end.message;
  result.pose = toPoseMessage(end.pose);
  if (end.outcome != Outcome::kRefused) {
    result.position_error = (goal.position - end.pose.position).norm();
    result.orientation_error = angleBetween(end.pose.orientation, goal.orientation);
  }
  result.time = end.time;
  return end.outcome == Outcome::kReached;
}

MoveClampFeedback toMoveFeedback(const ClampSnapshot& clamp, const Move::Work& work) {
  MoveClampFeedback feedback;
  feedback.pose = toPoseMessage(clamp.pose);
  feedback.distance = work.progress->distance;
  feedback.waypoint = work.progress->waypoint;
  return feedback;
}

// ---- trajectory -------------------------------------------------------------------------------

/// Follows a trajectory from a topic; one without points stops the clamp. Warns of a bad end.
void follow(const std::string& clamp, const trajectory_msgs::MultiDOFJointTrajectory& message,
            const RequestChecker& checker, SimulationThread& simulation) {
  const ClampJobListener listener{
      {}, [clamp](const ClampJobResult& end) {
        if (end.outcome == Outcome::kReached || end.outcome == Outcome::kCancelled) return;
        const bool refused = end.outcome == Outcome::kRefused;
        ROS_WARN_STREAM("~clamps/" << clamp << "/trajectory: "
                                   << (refused ? "refused: " : "ended: ") << end.message);
      }};
  if (message.points.empty()) {
    simulation.cancelJob(clamp, ClampJob::Part::kMotion);
    return;
  }
  try {
    simulation.startJob(moveWork(clamp, checker.trajectory(message), listener).job);
  } catch (const std::runtime_error& error) {
    ClampJobResult refused;
    refused.outcome = Outcome::kRefused;
    refused.message = error.what();
    listener.answer(refused);
  }
}

}  // namespace

template <typename Action>
ClampActionServer<Action>::ClampActionServer(ros::NodeHandle& node, const std::string& clamp,
                                             const std::string& name, Converter converter,
                                             SimulationThread& simulation)
    : clamp_(clamp),
      simulation_(simulation),
      goals_(std::make_shared<Goals>()),
      server_(
          node, "clamps/" + clamp + "/" + name, [this](Handle handle) { accept(handle); },
          [this](Handle handle) { cancel(handle); }, false),
      timer_(node.createWallTimer(ros::WallDuration(kProgressPeriod),
                                  [this](const ros::WallTimerEvent&) { tellProgress(); })) {
  goals_->converter = std::move(converter);
  server_.start();
}

template <typename Action>
void ClampActionServer<Action>::accept(Handle handle) {
  const std::shared_ptr<Goals> goals = goals_;
  const ClampJobListener listener{
      [handle, goals] { begin(handle, *goals); },
      [handle, goals](const ClampJobResult& end) { finish(handle, end, *goals); }};
  Work work;
  try {
    work = goals->converter.toWork(*handle.getGoal(), listener);
  } catch (const std::runtime_error& error) {
    ClampJobResult refused;
    refused.outcome = ClampJobResult::Outcome::kRefused;
    refused.message = error.what();
    finish(handle, refused, *goals);
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(goals->mutex);
    goals->entries[handle.getGoalID().id] = {handle, work};
  }
  simulation_.startJob(work.job);
}

template <typename Action>
void ClampActionServer<Action>::cancel(const Handle& handle) {
  const std::lock_guard<std::mutex> lock(goals_->mutex);
  const auto found = goals_->entries.find(handle.getGoalID().id);
  if (found != goals_->entries.end()) simulation_.cancelJob(found->second.work.job);
}

template <typename Action>
void ClampActionServer<Action>::begin(Handle handle, Goals& goals) {
  goals.gate.pass([&] { handle.setAccepted(); });
  const std::lock_guard<std::mutex> lock(goals.mutex);
  const auto found = goals.entries.find(handle.getGoalID().id);
  if (found != goals.entries.end()) found->second.hasBegun = true;
}

template <typename Action>
void ClampActionServer<Action>::finish(Handle handle, const ClampJobResult& end, Goals& goals) {
  Pose goal;
  {
    const std::lock_guard<std::mutex> lock(goals.mutex);
    const auto found = goals.entries.find(handle.getGoalID().id);
    if (found != goals.entries.end()) {
      goal = found->second.work.goal;
      goals.entries.erase(found);
    }
  }
  Result result;
  const bool succeeded = goals.converter.toResult(end, goal, result);
  goals.gate.pass([&] { answer(handle, end, succeeded, result); });
}

template <typename Action>
void ClampActionServer<Action>::answer(Handle& handle, const ClampJobResult& end, bool succeeded,
                                       const Result& result) {
  switch (end.outcome) {
    case ClampJobResult::Outcome::kRefused:
      return handle.setRejected(result, end.message);
    case ClampJobResult::Outcome::kPreempted:
    case ClampJobResult::Outcome::kCancelled:
      return handle.setCanceled(result, end.message);
    default:
      succeeded ? handle.setSucceeded(result, end.message) : handle.setAborted(result, end.message);
  }
}

template <typename Action>
void ClampActionServer<Action>::tellProgress() {
  const std::lock_guard<std::mutex> lock(goals_->mutex);
  if (goals_->entries.empty()) return;
  const Observation now = simulation_.observe();
  const auto& clamps = now.snapshot->clamps;
  const auto clamp = std::find_if(clamps.begin(), clamps.end(),
                                  [this](const ClampSnapshot& it) { return it.name == clamp_; });
  if (clamp == clamps.end()) return;
  for (auto& [id, entry] : goals_->entries) {
    if (!entry.hasBegun) continue;
    entry.handle.publishFeedback(goals_->converter.toFeedback(*clamp, entry.work));
  }
}

ClampActions::ClampActions(ros::NodeHandle& node, const std::string& clamp,
                           const RequestChecker& checker, SimulationThread& simulation)
    : gripper_(node, clamp, "gripper",
               {[clamp](const Gripper::Goal& goal, const ClampJobListener& listener) {
                  return gripWork(clamp, goal, listener);
                },
                [](const ClampJobResult& end, const Pose& /*goal*/, Gripper::Result& result) {
                  return toGripResult(end, result);
                },
                [](const ClampSnapshot& now, const Gripper::Work& /*work*/) {
                  return toGripFeedback(now);
                }},
               simulation),
      graspCloth_(node, clamp, "grasp_cloth",
                  {[clamp](const GraspClothGoal& goal, const ClampJobListener& listener) {
                     return graspWork(clamp, goal, listener);
                   },
                   [](const ClampJobResult& end, const Pose& /*goal*/, GraspClothResult& result) {
                     return toGraspResult(end, result);
                   },
                   [](const ClampSnapshot& now, const GraspCloth::Work& /*work*/) {
                     return toGraspFeedback(now);
                   }},
                  simulation),
      move_(node, clamp, "move",
            {[clamp, &checker](const MoveClampGoal& goal, const ClampJobListener& listener) {
               return moveWork(clamp, checker.move(goal), listener);
             },
             toMoveResult, toMoveFeedback},
            simulation) {
  using Trajectory = trajectory_msgs::MultiDOFJointTrajectory;
  const boost::function<void(const Trajectory&)> callback =
      [clamp, &checker, &simulation](const Trajectory& message) {
        follow(clamp, message, checker, simulation);
      };
  trajectory_ =
      node.subscribe<Trajectory, const Trajectory&>("clamps/" + clamp + "/trajectory", 1, callback);
}

}  // namespace cloth_sim
