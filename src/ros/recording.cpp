#include "recording.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "cloth_sim/ClothCommand.h"
#include "cloth_sim/ClothState.h"
#include "cloth_sim/sim/saved_state.h"
#include "sim/command_text.h"
#include "support/hash.h"
#include "support/input_file.h"

namespace cloth_sim {
namespace {

constexpr const char* kState = "/state";
constexpr std::uint64_t kMaxBagSize = 1ULL << 40;  ///< [bytes]; it is read in parts

/// Returns the name of the recorded node: "/cloth" for the topic "/cloth/state".
std::string nodeOf(rosbag::Bag& bag, const std::string& file) {
  std::set<std::string> nodes;
  const std::string type = ros::message_traits::DataType<ClothState>::value();
  rosbag::View view(bag, rosbag::TypeQuery(type));
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    const std::string& topic = connection->topic;
    const std::size_t node = topic.size() - std::min(topic.size(), std::string(kState).size());
    if (topic.substr(node) == kState) nodes.insert(topic.substr(0, node));
  }
  if (nodes.size() != 1) {
    throw std::runtime_error(file + ": expected the ~state of one cloth (got " +
                             std::to_string(nodes.size()) + ")");
  }
  return *nodes.begin();
}

CommandRecord toRecord(const ClothCommand& message) {
  const std::string bytes(message.data.begin(), message.data.end());
  return {message.number, message.step, message.time, unpackCommand(bytes)};
}

void read(rosbag::Bag& bag, const std::string& node, Recording& recording) {
  const std::vector<std::string> topics{node + "/scene", node + "/commands", node + kState};
  for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery(topics))) {
    if (const auto text = message.instantiate<std_msgs::String>()) {
      recording.scene = text->data;
    } else if (const auto command = message.instantiate<ClothCommand>()) {
      recording.commands.push_back(toRecord(*command));
    } else if (const auto state = message.instantiate<ClothState>()) {
      recording.states.push_back({state->step, state->time, state->state_hash});
    }
  }
}

void check(const Recording& recording, const std::string& file) {
  if (recording.scene.empty()) throw std::runtime_error(file + ": there is no scene in it");
  if (recording.states.empty()) throw std::runtime_error(file + ": there is no state in it");
  for (std::size_t k = 0; k < recording.commands.size(); ++k) {
    if (recording.commands[k].number == k) continue;
    throw std::runtime_error(file + ": command " + std::to_string(k) +
                             " is missing: it was not recorded from the start, or not completely");
  }
}

/// Collects the hashes of the states of a simulation.
class Trace {
 public:
  explicit Trace(const Simulation& simulation) : simulation_(simulation) { note(); }

  void note() { seen_.insert(hashText(stateHash(simulation_.model(), simulation_.state()))); }
  bool has(const std::string& hash) const { return seen_.count(hash) != 0; }

 private:
  const Simulation& simulation_;
  std::set<std::string> seen_;
};

}  // namespace

Recording readRecording(const std::string& file) {
  Recording recording;
  checkInputFile(file, {kMaxBagSize, Links::kFollowed});
  try {
    rosbag::Bag bag(file, rosbag::bagmode::Read);
    read(bag, nodeOf(bag, file), recording);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(file + ": no bag that can be read (" + error.what() + ")");
  } catch (const StateError& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
  const auto byNumber = [](const auto& a, const auto& b) { return a.number < b.number; };
  std::sort(recording.commands.begin(), recording.commands.end(), byNumber);
  check(recording, file);
  return recording;
}

Replay replay(const Recording& recording, Simulation& simulation,
              const std::function<bool()>& onStep) {
  Trace trace(simulation);
  bool goesOn = true;
  const auto stepTo = [&](std::uint64_t step) {
    while (goesOn && !simulation.failed() && simulation.stepCount() < step) {
      simulation.step();
      trace.note();
      goesOn = onStep();
    }
  };
  for (const CommandRecord& record : recording.commands) {
    stepTo(record.step);
    if (!goesOn) break;
    simulation.apply(record.command);
    trace.note();
  }
  stepTo(recording.states.back().step);

  Replay result;
  for (const Recording::State& state : recording.states) {
    if (trace.has(state.hash)) {
      ++result.same;
    } else if (result.difference.empty()) {
      result.difference = "the state of step " + std::to_string(state.step) +
                          " (t = " + std::to_string(state.time) + " s, hash " + state.hash +
                          ") was not reproduced";
    }
  }
  return result;
}

}  // namespace cloth_sim
