#pragma once
/// \file The topics and actions of the clamps; they open and close as clamps are added and removed.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "clamp_actions.h"
#include "parameters.h"
#include "pose_tracker.h"
#include "requests.h"
#include "serial_queue.h"
#include "simulation_thread.h"
#include "wrench_filter.h"

namespace cloth_sim {

/// The command topics, the actions, the tracker and the wrench topic of every clamp. Thread-safe.
class ClampPorts {
 public:
  /// All arguments must outlive this.
  ClampPorts(ros::NodeHandle& node, const NodeParameters& parameters, const RequestChecker& checker,
             const WorldFrame& world, SimulationThread& simulation);
  ~ClampPorts() { actionQueue_.stop(); }
  ClampPorts(const ClampPorts&) = delete;
  ClampPorts& operator=(const ClampPorts&) = delete;

  /// Opens topics of new clamps and closes those of removed ones. Ignores an observation older than
  /// one seen before.
  void update(const Observation& observation);
  /// Has clamps follow their sources again, after a reset.
  void repeat();

  /// Replaces the source that a clamp tracks; PoseSource::Kind::kNothing ends tracking.
  CommandResult track(const std::string& clamp, const PoseSource& source);
  /// The status of every clamp that tracks a source.
  std::vector<TrackingStatus> statuses() const;

  /// Publishes the wrench of every clamp whose topic has subscribers.
  /// \param nodeName  prefix of the clamps' tf frames.
  void sendWrenches(const Snapshot& snapshot, const ros::Time& stamp, const std::string& nodeName);
  std::uint32_t wrenchSubscribers() const;

 private:
  struct Port {
    explicit Port(double cutoff) : filter(cutoff) {}
    std::vector<ros::Subscriber> commands;
    ros::Publisher wrench;
    WrenchFilter filter;
    std::shared_ptr<PoseTracker> tracker;  ///< null while the clamp tracks nothing
    ros::Subscriber width;                 ///< of the hand
    std::shared_ptr<ClampActions> actions;
  };

  void open(const std::string& clamp);
  void close(Port& port);
  void attach(const std::string& clamp, const PoseSource& source, Port& port);
  template <typename Message, typename Check>
  ros::Subscriber listen(const std::string& topic, std::uint32_t queue, const Check& check);

  ros::NodeHandle& node_;
  const NodeParameters& parameters_;
  const RequestChecker& checker_;
  const WorldFrame& world_;
  SimulationThread& simulation_;
  SerialQueue actionQueue_;
  ros::NodeHandle actionNode_;  ///< of that queue
  mutable std::mutex mutex_;
  std::map<std::string, Port> ports_;  ///< by clamp name
  std::uint64_t seen_ = 0;             ///< number of the newest observation
};

}  // namespace cloth_sim
