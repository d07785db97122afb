/// \file Measures the time from a command to a clamp until ~frame shows its effect:
/// `command_latency <number of commands>` prints one wall time per line [s]. bench/node_overhead
/// runs it with the scene beside this file, in which a clamp "hand" holds particle 0.

#include <geometry_msgs/PoseStamped.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>

#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/GetState.h"

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSway = 0.005;     ///< amplitude of the commanded pose [m]
constexpr double kVisible = 1e-5;   ///< smallest displacement that counts as motion [m]
constexpr int kStillFrames = 12;    ///< consecutive frames without motion before the next command
constexpr double kMaxPause = 0.05;  ///< largest random pause after them: three frames [s]
constexpr double kMaxWait = 10.0;   ///< longest wait for the effect [s]

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Moves the clamp to and fro and watches when particle 0 begins to move.
class Probe {
 public:
  explicit Probe(ros::NodeHandle& node)
      : pose_(node.advertise<geometry_msgs::PoseStamped>("/cloth/clamps/hand/command", 1)),
        frame_(node.subscribe("/cloth/frame", 10, &Probe::onFrame, this,
                              ros::TransportHints().tcpNoDelay())) {}

  /// \return true once the clamp holds the cloth and the middle of its path is known.
  bool begin(ros::NodeHandle& node) {
    cloth_sim::GetState state;
    if (!ros::service::waitForService("/cloth/get_state", 20000)) return false;
    do {
      if (!node.serviceClient<cloth_sim::GetState>("/cloth/get_state").call(state)) return false;
    } while (state.response.state.clamps.at(0).held == 0);
    command_.header.frame_id = "world";
    command_.pose = state.response.state.clamps[0].pose;
    middle_ = command_.pose.position.y;
    return waitFor([this] { return pose_.getNumSubscribers() > 0; });
  }

  /// \return the time from sending a command to its effect [s]; negative: there was no effect.
  double measure(double pause) {
    still_ = 0;
    if (!waitFor([this] { return still_ >= kStillFrames; })) return -1.0;
    const Clock::time_point rested = Clock::now();
    waitFor([&] { return since(rested) >= pause; });
    side_ = -side_;
    command_.pose.position.y = middle_ + side_ * kSway;
    still_ = 1;
    const Clock::time_point sent = Clock::now();
    pose_.publish(command_);
    return waitFor([this] { return still_ == 0; }) ? since(sent) : -1.0;
  }

 private:
  void onFrame(const cloth_sim::ClothFrame::ConstPtr& frame) {
    const double y = frame->positions[1];
    still_ = std::abs(y - seen_) > kVisible ? 0 : still_ + 1;
    seen_ = y;
  }

  template <typename Condition>
  static bool waitFor(Condition condition) {
    const Clock::time_point start = Clock::now();
    while (!condition()) {
      if (!ros::ok() || since(start) > kMaxWait) return false;
      ros::getGlobalCallbackQueue()->callOne(ros::WallDuration(0.0005));
    }
    return true;
  }

  ros::Publisher pose_;
  ros::Subscriber frame_;
  geometry_msgs::PoseStamped command_;
  double middle_ = 0.0;  ///< y of the middle of the path [m]
  double side_ = 1.0;
  double seen_ = 0.0;  ///< y of particle 0 in the last frame [m]
  int still_ = 0;      ///< consecutive frames without motion
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "command_latency");
  ros::NodeHandle node;
  const int commands = argc > 1 ? std::atoi(argv[1]) : 200;
  Probe probe(node);
  if (!probe.begin(node)) return EXIT_FAILURE;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> pause(0.0, kMaxPause);
  for (int k = 0; k < commands; ++k) {
    const double latency = probe.measure(pause(random));
    if (latency < 0.0) return EXIT_FAILURE;
    std::cout << latency << std::endl;
  }
  return EXIT_SUCCESS;
}
