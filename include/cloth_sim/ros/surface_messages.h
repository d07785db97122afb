#pragma once
/// \file The cloth in the messages that everybody has a reader for. Pure functions; no node.

#include <sensor_msgs/PointCloud2.h>
#include <shape_msgs/Mesh.h>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// One point for each particle, in float32: x, y, z [m], strain (largest of the springs at it [-]),
/// normal_x, normal_y, normal_z (unit vector to the front of the cloth).
sensor_msgs::PointCloud2 toPointCloud(const Snapshot& snapshot, const std_msgs::Header& header);

/// Triangles and vertices [m]. The message has no header: it is in the world frame.
shape_msgs::Mesh toMeshMessage(const Snapshot& snapshot);

}  // namespace cloth_sim
