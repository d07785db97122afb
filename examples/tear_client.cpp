// Grasps a strip of cloth, lifts it, tears it and waits for two pieces:
// `roslaunch cloth_sim cloth.launch scene:=strip`, then `rosrun cloth_sim tear_client`.
#include <cloth_sim/GetState.h>
#include <cloth_sim/Grasp.h>
#include <cloth_sim/SetClampPose.h>
#include <ros/ros.h>

template <typename Service>
void call(const std::string& name, Service& service) {
  ros::service::waitForService("/cloth/" + name);
  if (ros::service::call("/cloth/" + name, service) && service.response.success) return;
  ROS_FATAL_STREAM(name << ": " << service.response.message);
  std::exit(1);
}
void waitUntil(bool (*holds)(const cloth_sim::ClothState&)) {
  cloth_sim::GetState now;
  for (call("get_state", now); !holds(now.response.state); call("get_state", now)) usleep(20000);
}
int main(int argc, char** argv) {
  ros::init(argc, argv, "tear_client");
  const ros::NodeHandle node;
  cloth_sim::Grasp grasp;
  grasp.request.clamp = "hand";
  grasp.request.grasp = true;
  call("grasp", grasp);
  waitUntil([](const auto& state) { return state.clamps[0].held > 0; });
  cloth_sim::SetClampPose move;
  move.request.clamp = "hand";
  move.request.pose.header.frame_id = "world";
  move.request.pose.pose.orientation.w = 1.0;
  move.request.pose.pose.position.x = 0.12;  // [m]
  move.request.pose.pose.position.z = 0.2;
  call("set_clamp_pose", move);
  waitUntil([](const auto& state) { return state.clamps[0].pose.position.z > 0.199; });
  move.request.pose.pose.position.x = 0.5;
  call("set_clamp_pose", move);
  waitUntil([](const auto& state) { return state.pieces == 2; });
  ROS_INFO("two pieces");
}
