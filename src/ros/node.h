#pragma once
/// \file The node as a function.

namespace cloth_sim {

/// Runs the node until ROS shuts down.
/// \return 0; or 2 after one line on stderr if a parameter or the scene is bad.
int runNode(int argc, char** argv);

}  // namespace cloth_sim
