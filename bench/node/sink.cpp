/// \file Subscribes to a topic of any type and drops its messages: `sink <topic>`. Prints their
/// number when it ends. bench/node_overhead runs it.

#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <iostream>

int main(int argc, char** argv) {
  ros::init(argc, argv, "sink", ros::init_options::AnonymousName);
  if (argc < 2) return 2;
  ros::NodeHandle node;
  long count = 0;
  const boost::function<void(const topic_tools::ShapeShifter::ConstPtr&)> take =
      [&](const topic_tools::ShapeShifter::ConstPtr&) { ++count; };
  const ros::Subscriber subscriber = node.subscribe<topic_tools::ShapeShifter>(argv[1], 10, take);
  ros::spin();
  std::cout << count << std::endl;
  return 0;
}
