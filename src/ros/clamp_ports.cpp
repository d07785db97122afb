#include "clamp_ports.h"

#include <geometry_msgs/WrenchStamped.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "submit.h"

namespace cloth_sim {
namespace {

// Queue lengths.
constexpr std::uint32_t kNewest = 1;  ///< of poses and widths: a newer one replaces an older one
constexpr std::uint32_t kEvery = 10;  ///< of grasps: each one counts

}  // namespace

ClampPorts::ClampPorts(ros::NodeHandle& node, const NodeParameters& parameters,
                       const RequestChecker& checker, const WorldFrame& world,
                       SimulationThread& simulation)
    : node_(node),
      parameters_(parameters),
      checker_(checker),
      world_(world),
      simulation_(simulation),
      actionNode_(actionQueue_.handle(node)) {
  update(simulation.observe());
}

template <typename Message, typename Check>
ros::Subscriber ClampPorts::listen(const std::string& topic, std::uint32_t queue,
                                   const Check& check) {
  const boost::function<void(const Message&)> callback = [this, topic,
                                                          check](const Message& message) {
    for (const Request& request : check(message)) submit(topic, request, simulation_);
  };
  // Nagle's algorithm would hold back small messages sent in quick succession.
  return node_.subscribe<Message, const Message&>(topic, queue, callback, ros::VoidConstPtr(),
                                                  ros::TransportHints().tcpNoDelay());
}

void ClampPorts::update(const Observation& observation) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (observation.number < seen_) return;
  seen_ = observation.number;
  const std::vector<ClampSnapshot>& clamps = observation.snapshot->clamps;
  for (auto port = ports_.begin(); port != ports_.end();) {
    const auto named = [&](const ClampSnapshot& clamp) { return clamp.name == port->first; };
    if (std::any_of(clamps.begin(), clamps.end(), named)) {
      ++port;
      continue;
    }
    close(port->second);
    port = ports_.erase(port);
  }
  for (const ClampSnapshot& clamp : clamps) {
    if (ports_.count(clamp.name) == 0) open(clamp.name);
  }
}

void ClampPorts::repeat() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [clamp, port] : ports_) {
    if (port.tracker) port.tracker->repeat();
  }
}

void ClampPorts::open(const std::string& clamp) {
  using Requests = std::vector<Request>;
  Port& port = ports_.emplace(clamp, Port(parameters_.wrenchCutoff)).first->second;
  const std::string base = "clamps/" + clamp;
  port.wrench = node_.advertise<geometry_msgs::WrenchStamped>(base + "/wrench", 10);
  port.commands.push_back(listen<geometry_msgs::PoseStamped>(
      base + "/command", kNewest, [this, clamp](const geometry_msgs::PoseStamped& pose) {
        return Requests{checker_.clampPose(clamp, pose)};
      }));
  port.commands.push_back(
      listen<std_msgs::Bool>(base + "/grasp", kEvery, [this, clamp](const std_msgs::Bool& grasp) {
        return Requests{checker_.grasp(clamp, grasp.data)};
      }));
  port.commands.push_back(listen<GripperCommand>(
      base + "/gripper_command", kNewest,
      [this, clamp](const GripperCommand& command) { return checker_.gripper(clamp, command); }));
  actionQueue_.run([&] {
    port.actions = std::make_shared<ClampActions>(actionNode_, clamp, checker_, simulation_);
  });
  const auto source = parameters_.clampSources.find(clamp);
  if (source != parameters_.clampSources.end()) attach(clamp, source->second, port);
}

/// Closes the actions of a clamp that is gone.
void ClampPorts::close(Port& port) {
  actionQueue_.run([&] { port.actions.reset(); });
}

void ClampPorts::attach(const std::string& clamp, const PoseSource& source, Port& port) {
  port.tracker.reset();
  port.width.shutdown();
  if (source.kind != PoseSource::Kind::kNothing) {
    const PoseTracker::Sink sink = [this, clamp](const MovingPose& target) {
      submit("follow/" + clamp, Command{GuideClamp{clamp, target}}, simulation_);
    };
    port.tracker =
        PoseTracker::track(node_, "clamp " + clamp, source, world_, parameters_.rateTracking, sink);
  }
  if (source.graspWidth.empty()) return;
  port.width = listen<std_msgs::Float64>(
      source.graspWidth, kNewest, [this, clamp](const std_msgs::Float64& width) {
        return std::vector<Request>{checker_.gripWidth(clamp, width.data)};
      });
}

CommandResult ClampPorts::track(const std::string& clamp, const PoseSource& source) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto port = ports_.find(clamp);
  if (port == ports_.end()) return {false, "unknown clamp '" + clamp + "'"};
  attach(clamp, source, port->second);
  return {true, "clamp " + clamp + " follows " + toString(source)};
}

std::vector<TrackingStatus> ClampPorts::statuses() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<TrackingStatus> result;
  for (const auto& [clamp, port] : ports_) {
    if (port.tracker) result.push_back(port.tracker->status());
  }
  return result;
}

void ClampPorts::sendWrenches(const Snapshot& snapshot, const ros::Time& stamp,
                              const std::string& nodeName) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const ClampSnapshot& clamp : snapshot.clamps) {
    const auto found = ports_.find(clamp.name);
    if (found == ports_.end() || found->second.wrench.getNumSubscribers() == 0) continue;
    Port& port = found->second;
    geometry_msgs::WrenchStamped message;
    message.header.stamp = stamp;
    message.header.frame_id = clampFrameId(nodeName, clamp.name);
    message.wrench = clampFrameWrench(clamp, port.filter.filter(snapshot.time, clamp.wrench));
    port.wrench.publish(message);
  }
}

std::uint32_t ClampPorts::wrenchSubscribers() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::uint32_t count = 0;
  for (const auto& [clamp, port] : ports_) count += port.wrench.getNumSubscribers();
  return count;
}

}  // namespace cloth_sim
