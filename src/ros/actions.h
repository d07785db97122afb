#pragma once
/// \file The node's actions: run for a duration, run to a phase.

#include <actionlib/server/action_server.h>
#include <ros/node_handle.h>
#include <ros/wall_timer.h>

#include <map>
#include <mutex>

#include "cloth_sim/RunForAction.h"
#include "cloth_sim/RunToPhaseAction.h"
#include "requests.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// Serves one action. Each goal becomes a run of the simulation thread; a new run takes the place
/// of the one before.
template <typename Action>
class RunAction {
 public:
  /// Converts a goal message.
  /// \throws std::runtime_error saying why the goal is rejected.
  using ToGoal = std::function<RunGoal(const typename Action::_action_goal_type::_goal_type&)>;

  RunAction(ros::NodeHandle& privateNode, const std::string& name, ToGoal toGoal,
            SimulationThread& simulation);

 private:
  using Server = actionlib::ActionServer<Action>;
  using Handle = typename Server::GoalHandle;
  using Result = typename Action::_action_result_type::_result_type;
  using Feedback = typename Action::_action_feedback_type::_feedback_type;

  void accept(Handle handle);
  void cancel(const Handle& handle);
  void finish(Handle handle, const RunResult& result);
  void tellProgress();
  static Result resultOf(const RunResult& result);

  ToGoal toGoal_;
  SimulationThread& simulation_;
  std::mutex mutex_;  ///< guards runs_
  struct Run {
    Handle handle;
    std::uint64_t number = 0;
    double end = 0.0;  ///< simulated time at the end [s], if it is known
  };
  std::map<std::string, Run> runs_;  ///< runs under way, by goal id
  Server server_;
  ros::WallTimer timer_;
};

/// The actions ~run_for and ~run_to_phase.
class Actions {
 public:
  Actions(ros::NodeHandle& privateNode, const RequestChecker& checker,
          SimulationThread& simulation);

 private:
  RunAction<RunForAction> runFor_;
  RunAction<RunToPhaseAction> runToPhase_;
};

}  // namespace cloth_sim
