#pragma once
/// \file The node's services: convert, hand over to the simulation thread, wait for the answer.
///
/// Each family of services is a file of its own with a function `advertise...Services`. A new
/// service is a .srv file and a handler in one of them; a new family is a row in services.cpp.

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>

#include <vector>

#include "clamp_ports.h"
#include "requests.h"
#include "simulation_thread.h"
#include "state_directory.h"

namespace cloth_sim {

/// Facts for ~get_state that do not change while the node lives.
struct SceneFacts {
  std::string scene;
  std::string solver;
  double dt = 0.0;  ///< length of a step [s]
  std::string worldFrame;
  std::string stateDirectory;
};

/// All services of the node. Every call succeeds for ROS; whether the request was carried out is in
/// `success` and `message` of the reply.
class Services {
 public:
  /// All references must outlive this.
  Services(ros::NodeHandle& privateNode, SceneFacts facts, const RequestChecker& checker,
           SimulationThread& simulation, ClampPorts& clamps);

  const SceneFacts& facts() const { return facts_; }
  const RequestChecker& checker() const { return checker_; }
  const StateDirectory& states() const { return states_; }
  SimulationThread& simulation() { return simulation_; }
  ClampPorts& clamps() { return clamps_; }

  /// Advertises a service.
  /// \tparam Service  the generated class of the .srv file.
  /// \param handler   called as handler(const Service::Request&, Service::Response&).
  template <typename Service, typename Handler>
  void advertise(const std::string& name, Handler handler);

  /// Advertises a service whose handler does not wait for the simulation, or hardly: threads of its
  /// own answer it, also while requests that wait hold all others.
  template <typename Service, typename Handler>
  void advertisePrompt(const std::string& name, Handler handler);

  /// Has the command carried out and waits for it, or passes on why there is none.
  /// \param done  message of success, where the command itself has none.
  template <typename Reply>
  void execute(const Request& request, const std::string& done, Reply& reply);

 private:
  template <typename Service, typename Handler>
  void advertiseAt(ros::NodeHandle& node, const std::string& name, Handler handler);
  CommandResult execute(const Request& request);

  ros::NodeHandle& node_;
  SceneFacts facts_;
  StateDirectory states_;
  const RequestChecker& checker_;
  SimulationThread& simulation_;
  ClampPorts& clamps_;
  ros::CallbackQueue promptQueue_;
  ros::NodeHandle promptNode_;
  std::vector<ros::ServiceServer> servers_;
  ros::AsyncSpinner promptSpinner_;  // last: its threads use everything above
};

void advertiseClampServices(Services& services);  ///< set_clamp_pose, grasp, add_clamp, ...
void advertiseMeshServices(Services& services);   ///< cut, refine
void advertiseRunServices(Services& services);    ///< pause, step, set_phase, reset, ...
void advertiseStateServices(Services& services);  ///< save_state, load_state, get_state

template <typename Service, typename Handler>
void Services::advertise(const std::string& name, Handler handler) {
  advertiseAt<Service>(node_, name, handler);
}

template <typename Service, typename Handler>
void Services::advertisePrompt(const std::string& name, Handler handler) {
  advertiseAt<Service>(promptNode_, name, handler);
}

template <typename Service, typename Handler>
void Services::advertiseAt(ros::NodeHandle& node, const std::string& name, Handler handler) {
  using Arguments = typename Service::Request;
  using Reply = typename Service::Response;
  const boost::function<bool(Arguments&, Reply&)> callback = [handler](Arguments& request,
                                                                       Reply& reply) {
    handler(request, reply);
    return true;
  };
  servers_.push_back(node.advertiseService<Arguments, Reply>(name, callback));
}

template <typename Reply>
void Services::execute(const Request& request, const std::string& done, Reply& reply) {
  const CommandResult result = execute(request);
  reply.success = result.success;
  reply.message = result.success && result.message.empty() ? done : result.message;
}

}  // namespace cloth_sim
