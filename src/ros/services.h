#pragma once
/// \file The node's services: check, hand over, wait for the answer.

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <vector>

#include "clamp_ports.h"
#include "cloth_sim/AddClamp.h"
#include "cloth_sim/Cut.h"
#include "cloth_sim/Follow.h"
#include "cloth_sim/GetState.h"
#include "cloth_sim/Grasp.h"
#include "cloth_sim/LoadState.h"
#include "cloth_sim/Pause.h"
#include "cloth_sim/Refine.h"
#include "cloth_sim/RemoveClamp.h"
#include "cloth_sim/ResetScene.h"
#include "cloth_sim/SaveState.h"
#include "cloth_sim/SetClampPose.h"
#include "cloth_sim/SetRealTimeFactor.h"
#include "cloth_sim/StartPhase.h"
#include "cloth_sim/Step.h"
#include "requests.h"
#include "simulation_thread.h"
#include "state_directory.h"

namespace cloth_sim {

/// What ~get_state tells beside the state: it does not change while the node lives.
struct SceneFacts {
  std::string scene;
  std::string solver;
  double dt = 0.0;  ///< [s]
  std::string worldFrame;
  std::string stateDirectory;
};

/// Every service replies `true` to ROS; whether the request was carried out is in the reply.
class Services {
 public:
  Services(ros::NodeHandle& privateNode, SceneFacts facts, const RequestChecker& checker,
           SimulationThread& simulation, ClampPorts& clamps);

 private:
  template <typename Service>
  void advertise(ros::NodeHandle& node, const std::string& name,
                 void (Services::*handler)(const typename Service::Request&,
                                           typename Service::Response&));
  template <typename Reply>
  void carryOut(const Request& request, const std::string& done, Reply& reply);

  void setClampPose(const SetClampPose::Request& request, SetClampPose::Response& reply);
  void grasp(const Grasp::Request& request, Grasp::Response& reply);
  void addClamp(const AddClamp::Request& request, AddClamp::Response& reply);
  void removeClamp(const RemoveClamp::Request& request, RemoveClamp::Response& reply);
  void track(const Follow::Request& request, Follow::Response& reply);
  void cut(const Cut::Request& request, Cut::Response& reply);
  void refine(const Refine::Request& request, Refine::Response& reply);
  void setPhase(const StartPhase::Request& request, StartPhase::Response& reply);
  void pause(const Pause::Request& request, Pause::Response& reply);
  void step(const Step::Request& request, Step::Response& reply);
  void setRealTimeFactor(const SetRealTimeFactor::Request& request,
                         SetRealTimeFactor::Response& reply);
  void reset(const ResetScene::Request& request, ResetScene::Response& reply);
  void saveState(const SaveState::Request& request, SaveState::Response& reply);
  void loadState(const LoadState::Request& request, LoadState::Response& reply);
  void getState(const GetState::Request& request, GetState::Response& reply);

  SceneFacts facts_;
  StateDirectory states_;
  const RequestChecker& checker_;
  SimulationThread& simulation_;
  ClampPorts& clamps_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace cloth_sim
