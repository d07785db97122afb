/// \file The node; see docs/ros_api.md for its topics, services and parameters.

#include "cloth_sim/ros/node.h"

int main(int argc, char** argv) { return cloth_sim::runNode(argc, argv); }
