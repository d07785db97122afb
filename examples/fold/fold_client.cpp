// Folds a towel in half with an arm of three joints and a gripper, as the driver of the arm would:
// `roslaunch cloth_sim fold.launch client:=cpp`. It sends joint states, of which
// robot_state_publisher makes tf; the links and the clamp of the simulation follow tf.
#include <cloth_sim/ClothState.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <vector>

constexpr double kLink = 0.34;      // length of the upper arm, and of the forearm [m]
constexpr double kShoulder = 0.58;  // height [m]
constexpr double kHand = 0.115;     // from the wrist to the tips of the fingers [m]
constexpr double kSide = 0.18;      // of the towel, from the fold to the edge in the fingers [m]
constexpr double kLift = 0.10;      // of that edge above the fold: the towel stays slack [m]
constexpr double kDepth = 0.012;    // of the edge between the fingers [m]
constexpr double kLeap = 0.05;      // most time on the path between messages: late, not faster [s]

struct Key {
  double time;   // [s]
  double angle;  // about the fold [rad]
  double back;   // from the grasp [m]
  double gap;    // between the fingers [m]
};

const std::vector<Key> kPath{
    {0.0, 0.0, 0.05, 0.024},   // in front of the edge
    {1.0, 0.0, 0.00, 0.024},   // the edge is between the fingers
    {1.5, 0.0, 0.00, 0.004},   // they hold it
    {4.5, M_PI, 0.00, 0.004},  // over, around the fold
    {5.0, M_PI, 0.00, 0.024},  // they let go
    {6.0, M_PI, 0.06, 0.024},  // and back, to the other side
};

Key sample(double time) {
  for (std::size_t k = 1; k < kPath.size(); ++k) {
    const Key &a = kPath[k - 1], &b = kPath[k];
    if (time >= b.time) continue;
    const double fraction = std::max(0.0, time - a.time) / (b.time - a.time);
    const double s = fraction * fraction * (3.0 - 2.0 * fraction);  // no speed at either end
    return {time, a.angle + s * (b.angle - a.angle), a.back + s * (b.back - a.back),
            a.gap + s * (b.gap - a.gap)};
  }
  return kPath.back();
}

// Inverse kinematics: of the wrist by two links of one length, then of the hand.
std::vector<double> joints(const Key& key) {
  const double reach = kHand - kDepth + key.back;           // from the edge to the wrist
  const double height = -0.002 + 0.017 * key.angle / M_PI;  // by the table, then on two layers
  const double x = (kSide + reach) * std::cos(key.angle);
  const double z = (kLift + reach) * std::sin(key.angle) + height - kShoulder;
  const double elbow = -2.0 * std::acos(std::hypot(x, z) / (2.0 * kLink));
  const double shoulder = std::atan2(z, x) - elbow / 2.0;
  return {shoulder, elbow, key.angle - M_PI - shoulder - elbow, key.gap / 2.0};
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "fold_client");
  ros::NodeHandle node;
  ros::Publisher publisher = node.advertise<sensor_msgs::JointState>("joint_states", 1);
  ros::topic::waitForMessage<cloth_sim::ClothState>("/cloth/state");
  ros::Time last = ros::Time::now();
  double path = 0.0;  // time on the path [s]
  for (ros::Rate rate(60.0); ros::ok(); rate.sleep()) {
    const ros::Time now = ros::Time::now();
    if (now == last) continue;  // simulated time goes in steps
    sensor_msgs::JointState state;
    state.header.stamp = now;
    state.name = {"shoulder", "elbow", "wrist", "finger"};
    const double before = path;
    path += std::min((now - last).toSec(), kLeap);
    last = now;
    state.position = joints(sample(path));
    publisher.publish(state);
    if (before < kPath.back().time && path >= kPath.back().time) ROS_INFO("folded");
  }
}
