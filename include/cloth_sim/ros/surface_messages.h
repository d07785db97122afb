#pragma once
/// \file The cloth as standard messages: a point cloud and a mesh. Pure functions; no node.

#include <sensor_msgs/PointCloud2.h>
#include <shape_msgs/Mesh.h>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// Returns one point for each particle, in float32: x, y, z [m], strain of the vertex [-] (see
/// cloth/strain.h), normal_x, normal_y, normal_z (unit vector to the front of the cloth).
sensor_msgs::PointCloud2 toPointCloud(const Snapshot& snapshot, const std_msgs::Header& header);

/// Returns triangles and vertices [m]. The message has no header; it is in the world frame.
shape_msgs::Mesh toMeshMessage(const Snapshot& snapshot);

}  // namespace cloth_sim
