#pragma once
/// \file The main function of the node.

namespace cloth_sim {

/// Runs the node until ROS shuts down.
/// \return 0, or 2 after one line on stderr if a parameter or the scene is invalid.
int runNode(int argc, char** argv);

}  // namespace cloth_sim
