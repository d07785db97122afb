#pragma once
/// \file The topics of each clamp, which come and go with it.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "parameters.h"
#include "pose_follower.h"
#include "requests.h"
#include "simulation_thread.h"
#include "wrench_filter.h"

namespace cloth_sim {

/// For each clamp that there is: its command topics, what it follows, and its wrench. Its methods
/// may be called from any thread.
class ClampPorts {
 public:
  /// All must outlive this.
  ClampPorts(ros::NodeHandle& node, const NodeParameters& parameters, const RequestChecker& checker,
             const WorldFrame& world, SimulationThread& simulation);

  /// Opens and closes topics so that they are those of the clamps that there are. An observation
  /// older than one that was seen changes nothing.
  void update(const Observation& observation);

  /// Has a clamp follow something else than before.
  CommandResult follow(const std::string& clamp, const FollowSource& source);
  /// Of every clamp that follows something.
  std::vector<FollowStatus> followers() const;

  /// Sends the wrench of every clamp that somebody listens to. \param nodeName  for the frames.
  void sendWrenches(const Snapshot& snapshot, const ros::Time& stamp, const std::string& nodeName);
  std::uint32_t wrenchSubscribers() const;

 private:
  struct Port {
    explicit Port(double cutoff) : filter(cutoff) {}
    std::vector<ros::Subscriber> commands;
    ros::Publisher wrench;
    WrenchFilter filter;
    std::unique_ptr<PoseFollower> follower;
    ros::Subscriber width;
  };

  void open(const std::string& clamp);
  void attach(const std::string& clamp, const FollowSource& source, Port& port);
  template <typename Message, typename Check>
  ros::Subscriber listen(const std::string& topic, std::uint32_t queue, const Check& check);

  ros::NodeHandle& node_;
  const NodeParameters& parameters_;
  const RequestChecker& checker_;
  const WorldFrame& world_;
  SimulationThread& simulation_;
  mutable std::mutex mutex_;
  std::map<std::string, Port> ports_;  ///< by the name of the clamp
  std::uint64_t seen_ = 0;             ///< number of the newest observation
};

}  // namespace cloth_sim
