#pragma once
/// \file The actions of one clamp, ~clamps/<name>/gripper, grasp_cloth and move, and its topic
/// ~clamps/<name>/trajectory.

#include <actionlib/server/action_server.h>
#include <ros/node_handle.h>
#include <ros/wall_timer.h>

#include <map>
#include <memory>
#include <mutex>

#ifdef CLOTH_SIM_CONTROL_MSGS
#include <control_msgs/GripperCommandAction.h>
#endif

#include "cloth_sim/GraspClothAction.h"
#include "cloth_sim/GripperCommandAction.h"
#include "cloth_sim/MoveClampAction.h"
#include "gate.h"
#include "requests.h"
#include "simulation_thread.h"

namespace cloth_sim {

#ifdef CLOTH_SIM_CONTROL_MSGS
namespace gripper_msgs = ::control_msgs;
#else
namespace gripper_msgs = ::cloth_sim;
#endif

/// Serves one action of a clamp. Each goal becomes a ClampJob, which answers it from the simulation
/// thread; the newest goal counts.
///
/// actionlib destroys the publishers of a server before it waits for goals that are being answered
/// or received. So answers pass a gate, which closes first, and a server is to be destroyed where
/// no callback of it is under way: in the thread of `node`'s queue (SerialQueue).
template <typename Action>
class ClampActionServer {
 public:
  using Goal = typename Action::_action_goal_type::_goal_type;
  using Result = typename Action::_action_result_type::_result_type;
  using Feedback = typename Action::_action_feedback_type::_feedback_type;

  /// A goal under way, with what its feedback and result need.
  struct Work {
    std::shared_ptr<ClampJob> job;
    std::shared_ptr<MoveProgress> progress;  ///< of a move
    Pose goal;                               ///< of a move
  };
  /// Conversions between messages and jobs.
  struct Converter {
    /// Makes the job of a goal. \throws std::runtime_error saying why the goal is refused.
    std::function<Work(const Goal&, const ClampJobListener&)> toWork;
    /// Converts the end. \return whether the goal has succeeded.
    std::function<bool(const ClampJobResult&, const Pose& goal, Result&)> toResult;
    std::function<Feedback(const ClampSnapshot&, const Work&)> toFeedback;
  };

  ClampActionServer(ros::NodeHandle& node, const std::string& clamp, const std::string& name,
                    Converter converter, SimulationThread& simulation);
  ~ClampActionServer() { goals_->gate.close(); }
  ClampActionServer(const ClampActionServer&) = delete;
  ClampActionServer& operator=(const ClampActionServer&) = delete;

 private:
  using Server = actionlib::ActionServer<Action>;
  using Handle = typename Server::GoalHandle;

  /// Goals under way, by goal id; answers may come when the action is gone.
  struct Goals {
    struct Entry {
      Handle handle;
      Work work;
      bool hasBegun = false;  ///< there is progress to tell
    };
    Gate gate;  ///< of all calls of handles from other threads
    std::mutex mutex;
    std::map<std::string, Entry> entries;
    Converter converter;
  };

  void accept(Handle handle);
  void cancel(const Handle& handle);
  void tellProgress();
  static void begin(Handle handle, Goals& goals);
  static void finish(Handle handle, const ClampJobResult& end, Goals& goals);
  static void answer(Handle& handle, const ClampJobResult& end, bool succeeded,
                     const Result& result);

  std::string clamp_;
  SimulationThread& simulation_;
  std::shared_ptr<Goals> goals_;
  Server server_;
  ros::WallTimer timer_;
};

/// The actions and the trajectory topic of one clamp.
class ClampActions {
 public:
  /// All references must outlive this. \param node  of a SerialQueue.
  ClampActions(ros::NodeHandle& node, const std::string& clamp, const RequestChecker& checker,
               SimulationThread& simulation);

 private:
  ClampActionServer<gripper_msgs::GripperCommandAction> gripper_;
  ClampActionServer<GraspClothAction> graspCloth_;
  ClampActionServer<MoveClampAction> move_;
  ros::Subscriber trajectory_;
};

}  // namespace cloth_sim
