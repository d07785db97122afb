#include "cloth_sim/ros/surface_messages.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include "cloth_sim/ros/conversions.h"
#include "vertex_normals.h"

namespace cloth_sim {

sensor_msgs::PointCloud2 toPointCloud(const Snapshot& snapshot, const std_msgs::Header& header) {
  using sensor_msgs::PointField;
  std::vector<Eigen::Vector3f> normals;
  vertexNormals(snapshot.topology->faces, snapshot.positions, normals);
  std::vector<float> strains;
  vertexStrains(snapshot.topology->strainLines, snapshot.positions, strains);
  sensor_msgs::PointCloud2 cloud;
  cloud.header = header;
  cloud.is_dense = 1;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2Fields(7, "x", 1, PointField::FLOAT32, "y", 1, PointField::FLOAT32, "z", 1,
                                PointField::FLOAT32, "strain", 1, PointField::FLOAT32, "normal_x",
                                1, PointField::FLOAT32, "normal_y", 1, PointField::FLOAT32,
                                "normal_z", 1, PointField::FLOAT32);
  modifier.resize(snapshot.positions.size());
  sensor_msgs::PointCloud2Iterator<float> out(cloud, "x");
  for (std::size_t v = 0; v < snapshot.positions.size(); ++v, ++out) {
    const Eigen::Vector3f place = snapshot.positions[v].cast<float>();
    for (int k = 0; k < 3; ++k) out[k] = place[k];
    out[3] = strains[v];
    for (int k = 0; k < 3; ++k) out[4 + k] = normals[v][k];
  }
  return cloud;
}

shape_msgs::Mesh toMeshMessage(const Snapshot& snapshot) {
  shape_msgs::Mesh mesh;
  mesh.vertices.reserve(snapshot.positions.size());
  for (const Vec3& position : snapshot.positions) mesh.vertices.push_back(toPoint(position));
  mesh.triangles.resize(snapshot.topology->faces.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Face& face = snapshot.topology->faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.triangles[f].vertex_indices[k] = static_cast<std::uint32_t>(face[k]);
    }
  }
  return mesh;
}

}  // namespace cloth_sim
