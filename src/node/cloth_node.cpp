/// \file The node; see docs/ros_api.md for its topics, services and parameters.

#include "ros/node.h"

int main(int argc, char** argv) { return cloth_sim::runNode(argc, argv); }
