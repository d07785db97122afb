/// \file A client that commands a clamp of /cloth at 10 kHz: `flooder <seconds>`. Prints how many
/// commands it sent and how many a second. For test/ros/faults.test.

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

namespace {

constexpr double kRate = 10000.0;  ///< commands [1/s]
constexpr int kQueue = 100000;     ///< of each publisher: it shall not drop what the node should
constexpr double kMaxWait = 20.0;  ///< for the node to listen [s]
constexpr double kPause = 0.0005;  ///< between two looks at the clock [s]
constexpr double kStep = 1e-6;     ///< between two poses, so that no two are the same [m]

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void nap() { std::this_thread::sleep_for(std::chrono::duration<double>(kPause)); }

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "flooder");
  ros::NodeHandle node;
  const double seconds = argc > 1 ? std::atof(argv[1]) : 3.0;
  const auto poses =
      node.advertise<geometry_msgs::PoseStamped>("/cloth/clamps/right/command", kQueue);
  const auto grasps = node.advertise<std_msgs::Bool>("/cloth/clamps/right/grasp", kQueue);
  Clock::time_point start = Clock::now();
  while (poses.getNumSubscribers() == 0 || grasps.getNumSubscribers() == 0) {
    if (since(start) > kMaxWait) return EXIT_FAILURE;
    nap();
  }
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "world";
  pose.pose.orientation.w = 1.0;
  std_msgs::Bool grasp;
  int sent = 0;
  for (start = Clock::now(); ros::ok() && since(start) < seconds; nap()) {
    for (const int due = static_cast<int>(since(start) * kRate); sent < due; sent += 2) {
      pose.pose.position.z = 0.5 + kStep * sent;
      grasp.data = static_cast<unsigned char>(sent / 2 % 2);
      poses.publish(pose);
      grasps.publish(grasp);
    }
  }
  std::cout << sent << ' ' << sent / since(start) << std::endl;
  return EXIT_SUCCESS;
}
