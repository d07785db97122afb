#include "services.h"

#include <utility>

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kTimeout{5000};  ///< for a command between two steps
constexpr int kPromptThreads = 2;  ///< each may wait some 50 ms for the figures of ~get_state

}  // namespace

Services::Services(ros::NodeHandle& privateNode, SceneFacts facts, const RequestChecker& checker,
                   SimulationThread& simulation, ClampPorts& clamps)
    : node_(privateNode),
      facts_(std::move(facts)),
      states_(facts_.stateDirectory),
      checker_(checker),
      simulation_(simulation),
      clamps_(clamps),
      promptNode_(privateNode),
      promptSpinner_(kPromptThreads, &promptQueue_) {
  promptNode_.setCallbackQueue(&promptQueue_);
  advertiseClampServices(*this);
  advertiseMeshServices(*this);
  advertiseRunServices(*this);
  advertiseStateServices(*this);
  promptSpinner_.start();
}

CommandResult Services::execute(const Request& request) {
  if (const auto* refusal = std::get_if<Refusal>(&request)) return refuse(refusal->message);
  return simulation_.execute(std::get<Command>(request), kTimeout);
}

}  // namespace cloth_sim
