#include "cloth_sim/ros/surface_messages.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {

void vertexNormals(const Snapshot& snapshot, std::vector<Eigen::Vector3f>& out) {
  out.assign(snapshot.positions.size(), Eigen::Vector3f::Zero());
  for (const Face& face : snapshot.topology->faces) {
    const Vec3& a = snapshot.positions[face[0]];
    const Vec3 normal = (snapshot.positions[face[1]] - a).cross(snapshot.positions[face[2]] - a);
    for (const VertexId v : face) out[v] += normal.cast<float>();
  }
  for (Eigen::Vector3f& normal : out) {
    const float length = normal.norm();
    normal = length > 0.0f ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::UnitZ();
  }
}

void vertexStrains(const Snapshot& snapshot, std::vector<float>& out) {
  out.assign(snapshot.positions.size(), 0.0f);
  for (const Topology::Link& link : snapshot.topology->links) {
    const double length = (snapshot.positions[link.b] - snapshot.positions[link.a]).norm();
    const auto strain = static_cast<float>(length / link.restLength - 1.0);
    out[link.a] = std::max(out[link.a], strain);
    out[link.b] = std::max(out[link.b], strain);
  }
}

sensor_msgs::PointCloud2 toPointCloud(const Snapshot& snapshot, const std_msgs::Header& header) {
  using sensor_msgs::PointField;
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> strains;
  vertexNormals(snapshot, normals);
  vertexStrains(snapshot, strains);
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
