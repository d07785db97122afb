/// \file The cloth as a point cloud and a mesh.

#include "cloth_sim/ros/surface_messages.h"

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

namespace cloth_sim {
namespace {

/// One triangle in the plane z = 2, whose first edge is pulled to 1.25 times its length.
Snapshot triangle() {
  auto topology = std::make_shared<Topology>();
  topology->faces = {{0, 1, 2}};
  topology->strainLines = {{0, 1, 0.8}, {1, 2, 2.0}};
  Snapshot snapshot;
  snapshot.positions = {Vec3(0.0, 0.0, 2.0), Vec3(1.0, 0.0, 2.0), Vec3(0.0, 1.0, 2.0)};
  snapshot.topology = topology;
  return snapshot;
}

TEST(SurfaceMessages, PointsHavePlaceStrainAndNormal) {
  std_msgs::Header header;
  header.frame_id = "world";
  const sensor_msgs::PointCloud2 cloud = toPointCloud(triangle(), header);
  EXPECT_EQ(cloud.header.frame_id, "world");
  EXPECT_EQ(cloud.width * cloud.height, 3u);
  EXPECT_EQ(cloud.data.size(), 3u * 7u * sizeof(float));
  sensor_msgs::PointCloud2ConstIterator<float> y(cloud, "y"), strain(cloud, "strain"),
      normal(cloud, "normal_z");
  const float expectedY[] = {0.0f, 0.0f, 1.0f};
  const float expectedStrain[] = {0.25f, 0.25f, 0.0f};  // what is slack has none
  for (int v = 0; v < 3; ++v, ++y, ++strain, ++normal) {
    EXPECT_EQ(*y, expectedY[v]);
    EXPECT_NEAR(*strain, expectedStrain[v], 1e-6f);
    EXPECT_EQ(*normal, 1.0f);
  }
}

TEST(SurfaceMessages, AMeshHasTheTriangles) {
  const shape_msgs::Mesh mesh = toMeshMessage(triangle());
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0].vertex_indices[2], 2u);
  ASSERT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.vertices[1].x, 1.0);
}

}  // namespace
}  // namespace cloth_sim
