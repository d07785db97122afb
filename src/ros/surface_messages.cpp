#include "cloth_sim/ros/surface_messages.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {

namespace {

Eigen::Vector4f padded(const Vec3& value) {
  return {static_cast<float>(value.x()), static_cast<float>(value.y()),
          static_cast<float>(value.z()), 0.0f};
}

}  // namespace

void vertexNormals(const Snapshot& snapshot, std::vector<Eigen::Vector4f>& out) {
  out.assign(snapshot.positions.size(), Eigen::Vector4f::Zero());
  for (const Face& face : snapshot.topology->faces) {
    const Vec3& a = snapshot.positions[face[0]];
    const Eigen::Vector4f normal =
        padded(snapshot.positions[face[1]] - a).cross3(padded(snapshot.positions[face[2]] - a));
    for (const VertexId v : face) out[v] += normal;
  }
  for (Eigen::Vector4f& normal : out) {
    // In double: the square of a flat cloth's rounding errors is a subnormal float, which is slow.
    const double length = normal.cast<double>().norm();
    normal = length > 0.0 ? Eigen::Vector4f(normal * static_cast<float>(1.0 / length))
                          : Eigen::Vector4f::Unit(2);
  }
}

void vertexStrains(const Snapshot& snapshot, std::vector<float>& out) {
  out.assign(snapshot.positions.size(), 1.0f);  // of squared lengths, for now
  for (const Topology::Link& link : snapshot.topology->links) {
    const double square = (snapshot.positions[link.b] - snapshot.positions[link.a]).squaredNorm();
    const auto stretch = static_cast<float>(square / (link.restLength * link.restLength));
    out[link.a] = std::max(out[link.a], stretch);
    out[link.b] = std::max(out[link.b], stretch);
  }
  for (float& strain : out) strain = std::sqrt(strain) - 1.0f;
}

sensor_msgs::PointCloud2 toPointCloud(const Snapshot& snapshot, const std_msgs::Header& header) {
  using sensor_msgs::PointField;
  std::vector<Eigen::Vector4f> normals;
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
