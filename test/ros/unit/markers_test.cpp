/// \file Snapshot -> markers, without a node and without a master.

#include "cloth_sim/ros/markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/shading.h"
#include "ros/unit/received.h"

namespace cloth_sim {
namespace {

using visualization_msgs::Marker;

/// A flat n x n cloth of 1 m at z = 1, pulled to `stretch` along x.
Snapshot flatCloth(int n, double stretch = 1.0) {
  auto topology = std::make_shared<Topology>();
  Snapshot snapshot;
  const double h = 1.0 / (n - 1);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      topology->material.emplace_back(i * h, j * h);
      snapshot.positions.emplace_back(stretch * i * h, j * h, 1.0);
    }
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      const VertexId v = j * n + i;
      topology->faces.push_back({v, v + 1, v + n + 1});
      topology->faces.push_back({v, v + n + 1, v + n});
      topology->strainLines.push_back({v, v + 1, h});
      topology->strainLines.push_back({v, v + n, h});
    }
  }
  snapshot.topology = topology;
  snapshot.phase = "pull";
  snapshot.particles = n * n;
  return snapshot;
}

visualization_msgs::MarkerArray sent(MarkerBuilder& builder, const Snapshot& snapshot,
                                     const ros::Time& stamp) {
  return received(builder.build(snapshot, Figures(), stamp));
}

const Marker* find(const visualization_msgs::MarkerArray& array, const std::string& space) {
  for (const Marker& marker : array.markers) {
    if (marker.ns == space) return &marker;
  }
  return nullptr;
}

int count(const visualization_msgs::MarkerArray& array, const std::string& space) {
  int result = 0;
  for (const Marker& marker : array.markers) result += marker.ns == space ? 1 : 0;
  return result;
}

TEST(Markers, ClothHasThreeColouredCornersPerFaceOnBothSides) {
  MarkerStyle style;
  style.twoSided = true;
  MarkerBuilder builder(style);
  const auto array = sent(builder, flatCloth(5), ros::Time(1.0));
  for (const char* side : {"cloth", "cloth_back"}) {
    const Marker* cloth = find(array, side);
    ASSERT_NE(cloth, nullptr) << side;
    EXPECT_EQ(cloth->type, Marker::TRIANGLE_LIST);
    EXPECT_EQ(cloth->action, Marker::ADD);
    EXPECT_EQ(cloth->points.size(), 4u * 4u * 2u * 3u);
    EXPECT_EQ(cloth->colors.size(), cloth->points.size());
    EXPECT_EQ(cloth->header.frame_id, "world");
  }
}

TEST(Markers, EachCornerOfAFaceIsWhereItsVertexIs) {
  MarkerBuilder builder{MarkerStyle()};
  const Snapshot snapshot = flatCloth(4);
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  std::size_t corner = 0;
  for (const Face& face : snapshot.topology->faces) {
    for (const VertexId v : face) {
      const geometry_msgs::Point& point = find(array, "cloth")->points[corner++];
      EXPECT_EQ(Vec3(point.x, point.y, point.z), snapshot.positions[v]);
    }
  }
}

TEST(Markers, ALargeClothHasOneColourPerFaceByItsNormalAndTheStrainOfItsCorners) {
  MarkerStyle style;
  style.twoSided = true;
  MarkerBuilder builder(style);
  Snapshot snapshot = flatCloth(80);
  for (std::size_t v = 0; v < snapshot.positions.size(); ++v) {
    Vec3& position = snapshot.positions[v];
    position.x() *= 1.05;
    position.z() += 0.3 * std::sin(0.1 * static_cast<double>(v % 80));  // so that shades differ
  }
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  const std::vector<Face>& faces = snapshot.topology->faces;
  const Marker* front = find(array, "cloth");
  const Marker* back = find(array, "cloth_back");
  for (const Marker* side : {front, back}) {
    ASSERT_EQ(side->colors.size(), faces.size());
    EXPECT_EQ(side->points.size(), 3 * faces.size());
  }
  const StrainColours colours(style.strainRange);
  std::vector<double> stretches(snapshot.positions.size(), 1.0);
  for (const StrainLine& line : snapshot.topology->strainLines) {
    const double length = (snapshot.positions[line.b] - snapshot.positions[line.a]).norm();
    for (const VertexId v : {line.a, line.b}) {
      stretches[v] = std::max(stretches[v], length / line.restLength);
    }
  }
  for (std::size_t f = 0; f < faces.size(); f += 7) {
    double stretch = 1.0;
    for (const VertexId v : faces[f]) stretch = std::max(stretch, stretches[v]);
    const Vec3 normal =
        (snapshot.positions[faces[f][1]] - snapshot.positions[faces[f][0]])
            .cross(snapshot.positions[faces[f][2]] - snapshot.positions[faces[f][0]])
            .normalized();
    // The map has steps: a strain at the border of two has either colour.
    float nearest = 1.0f;
    for (const double strain : {stretch - 1.0 - 1e-5, stretch - 1.0 + 1e-5}) {
      const auto wanted = shaded(colours(static_cast<float>(std::max(0.0, strain))),
                                 brightness(normal.cast<float>()));
      const auto& found = front->colors[f];
      nearest =
          std::min(nearest, std::max({std::abs(found.r - wanted.r), std::abs(found.g - wanted.g),
                                      std::abs(found.b - wanted.b)}));
    }
    EXPECT_LT(nearest, 1e-5f) << f;
    EXPECT_EQ(front->colors[f].a, 1.0f);
  }
}

TEST(Markers, FacesWithoutAreaAndClothFarAwayLookLikeSomething) {
  Snapshot snapshot = flatCloth(80);
  for (Vec3& position : snapshot.positions) position = Vec3(1e6, 1e6, 1e6);
  MarkerBuilder builder{MarkerStyle()};
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  for (const std_msgs::ColorRGBA& colour : find(array, "cloth")->colors) {
    EXPECT_GE(colour.g, 0.0f);  // not NaN
  }
}

TEST(Markers, SidesLieOnEitherSideOfTheParticlesAndDifferInColour) {
  MarkerStyle style;
  style.twoSided = true;
  style.surfaceOffset = 0.001;
  MarkerBuilder builder(style);
  const auto array = sent(builder, flatCloth(5), ros::Time(1.0));
  const Marker* front = find(array, "cloth");
  const Marker* back = find(array, "cloth_back");
  EXPECT_NEAR(front->points[0].z, 1.001, 1e-9);  // the faces' normals point up
  EXPECT_NEAR(back->points[0].z, 0.999, 1e-9);
  EXPECT_GT(front->colors[0].g / front->colors[0].r, 1.2 * back->colors[0].g / back->colors[0].r);
}

TEST(Markers, OneSideIsSentUnlessBothAreAskedFor) {
  MarkerBuilder builder{MarkerStyle()};
  const auto array = sent(builder, flatCloth(5), ros::Time(1.0));
  EXPECT_EQ(find(array, "cloth_back"), nullptr);
  EXPECT_EQ(find(array, "cloth")->points[0].z, 1.0);
}

TEST(Markers, StrainChangesTheColour) {
  MarkerBuilder builder{MarkerStyle()};
  const float atRest = find(sent(builder, flatCloth(5), ros::Time(1.0)), "cloth")->colors[0].r;
  const auto stretched = sent(builder, flatCloth(5, 1.2), ros::Time(1.0));
  EXPECT_GT(find(stretched, "cloth")->colors[0].r, 2.0f * atRest);  // yellow, from blue
}

TEST(Markers, StrainMapIsMonotoneInBrightnessAndClamped) {
  const auto brightness = [](double fraction) {
    const std_msgs::ColorRGBA c = strainColour(fraction);
    return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;  // Rec. 709 luma
  };
  for (double f = 0.0; f < 0.99; f += 0.01) EXPECT_LT(brightness(f), brightness(f + 0.01));
  EXPECT_EQ(brightness(-5.0), brightness(0.0));
  EXPECT_EQ(brightness(7.0), brightness(1.0));
}

TEST(Markers, EmptyListsAreDeletedAndComeBack) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(5);
  EXPECT_EQ(find(sent(builder, snapshot, ros::Time(1.0)), "torn_edges")->action, Marker::DELETE);

  auto torn = std::make_shared<Topology>(*snapshot.topology);
  torn->tornEdges = {{0, 1}, {1, 2}};
  snapshot.topology = torn;
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  const Marker* edges = find(array, "torn_edges");
  EXPECT_EQ(edges->action, Marker::ADD);
  EXPECT_EQ(edges->type, Marker::LINE_LIST);
  EXPECT_EQ(edges->points.size(), 4u);

  Snapshot nothing;
  nothing.topology = std::make_shared<Topology>();
  for (const Marker& marker : sent(builder, nothing, ros::Time(1.0)).markers) {
    const bool list = marker.type == Marker::TRIANGLE_LIST || marker.type == Marker::LINE_LIST;
    if (list) {
      EXPECT_EQ(marker.action, Marker::DELETE) << marker.ns;
    }
  }
}

TEST(Markers, ContactsAreLinesAcrossTheLayersInTheColourOfTheirForce) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(4);
  EXPECT_EQ(find(sent(builder, snapshot, ros::Time(1.0)), "contacts"), nullptr)
      << "layers do not touch in this scene";
  snapshot.layers.emplace();
  EXPECT_EQ(find(sent(builder, snapshot, ros::Time(1.0)), "contacts")->action, Marker::DELETE);
  snapshot.contactPoints = {{Vec3(1.0, 2.0, 3.0), Vec3::UnitZ(), 1e-5},
                            {Vec3(0.0, 2.0, 3.0), Vec3::UnitX(), 1.0}};
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  const Marker* contacts = find(array, "contacts");
  ASSERT_NE(contacts, nullptr);
  EXPECT_EQ(contacts->type, Marker::LINE_LIST);
  EXPECT_EQ(contacts->action, Marker::ADD);
  ASSERT_EQ(contacts->points.size(), 4U);
  ASSERT_EQ(contacts->colors.size(), 4U);
  EXPECT_EQ(fromPoint(contacts->points[0]), Vec3(1.0, 2.0, 3.0 - kContactReach));
  EXPECT_EQ(fromPoint(contacts->points[1]), Vec3(1.0, 2.0, 3.0 + kContactReach));
  EXPECT_EQ(fromPoint(contacts->points[3]), Vec3(kContactReach, 2.0, 3.0));
  EXPECT_EQ(contacts->colors[0].r, 0.0f) << "cyan";
  EXPECT_EQ(contacts->colors[2].g, 0.0f) << "magenta";
}

TEST(Markers, TheColourOfAContactGoesWithItsForceAndEndsInMagenta) {
  for (double force = 1e-5; force < 0.006; force *= 1.5) {
    EXPECT_LT(contactColour(1.5 * force).g, contactColour(force).g) << force;
  }
  EXPECT_EQ(contactColour(0.0).g, contactColour(1e-5).g);
  EXPECT_EQ(contactColour(1e3).g, contactColour(0.2).g);
}

TEST(Markers, ClothMayGrowAndShrink) {
  MarkerBuilder builder{MarkerStyle()};
  for (const std::size_t n : {5u, 9u, 3u}) {
    const auto array = sent(builder, flatCloth(static_cast<int>(n)), ros::Time(1.0));
    const Marker* cloth = find(array, "cloth");
    EXPECT_EQ(cloth->points.size(), (n - 1) * (n - 1) * 2 * 3);
    EXPECT_EQ(cloth->colors.size(), cloth->points.size());
  }
}

TEST(Markers, NamespaceAndIdStayTheSameFromCallToCall) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(5);
  snapshot.clamps.resize(2);
  const visualization_msgs::MarkerArray first = sent(builder, snapshot, ros::Time(1.0));
  const visualization_msgs::MarkerArray second = sent(builder, snapshot, ros::Time(2.0));
  ASSERT_EQ(first.markers.size(), second.markers.size());
  for (std::size_t i = 0; i < first.markers.size(); ++i) {
    EXPECT_EQ(first.markers[i].ns, second.markers[i].ns);
    EXPECT_EQ(first.markers[i].id, second.markers[i].id);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(first.markers[i].id, first.markers[j].id);
  }
}

TEST(Markers, ClampPlatesStandAtTheirGap) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(3);
  ClampSnapshot clamp;
  clamp.pose.position = Vec3(0.1, 0.2, 0.3);
  clamp.plateSize = Vec2(0.06, 0.04);
  clamp.gap = 0.12;
  snapshot.clamps = {clamp};
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  ASSERT_EQ(count(array, "clamps"), 2);
  const Marker* lower = find(array, "clamps");
  const Marker* upper = lower + 1;
  // The inner faces are the gap apart.
  EXPECT_NEAR(upper->pose.position.z - lower->pose.position.z, 0.12 + lower->scale.z, 1e-12);
  EXPECT_NEAR(0.5 * (upper->pose.position.z + lower->pose.position.z), 0.3, 1e-12);
  EXPECT_EQ(lower->scale.x, 0.06);
}

TEST(Markers, ObstaclesHaveTheirShapes) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(3);
  Obstacle sphere, board, plane, bounds, rod;
  rod.shape = CapsuleShape{0.05, 0.3};
  rod.pose.position = Vec3(1.0, 0.0, 0.0);
  sphere.shape = SphereShape{0.1};
  board.shape = BoxShape{Vec3(1.6, 1.6, 0.05)};
  plane.shape = PlaneShape{};
  bounds.shape = BoundsShape{Vec3(2.0, 2.0, 2.0)};
  snapshot.obstacles = {sphere, board, plane, bounds};
  const auto array = sent(builder, snapshot, ros::Time(1.0));
  EXPECT_EQ(count(array, "obstacles"), 3);
  EXPECT_EQ(find(array, "obstacles")->scale.x, 0.2);
  EXPECT_EQ(find(array, "bounds")->points.size(), 24u);  // twelve edges

  snapshot.obstacles = {rod};
  const auto round = sent(builder, snapshot, ros::Time(2.0));
  EXPECT_EQ(count(round, "obstacles"), 3) << "a cylinder and two balls";
  const Marker* cylinder = find(round, "obstacles");
  EXPECT_EQ(cylinder->type, Marker::CYLINDER);
  EXPECT_EQ(cylinder->scale.x, 0.1);
  EXPECT_EQ(cylinder->scale.z, 0.3);
  EXPECT_EQ((cylinder + 1)->pose.position.z, -0.15);
  EXPECT_EQ((cylinder + 1)->type, Marker::SPHERE);
}

TEST(Markers, AMeshIsListedUnlessItIsLargeAndHasAFile) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(3);
  MeshShape mesh;
  mesh.scale = Vec3(Vec3::Constant(0.001));
  mesh.file.path = "/somewhere/part.stl";
  snapshot.obstacles.resize(1);
  snapshot.obstacles[0].shape = mesh;
  const auto small = sent(builder, snapshot, ros::Time(1.0));
  EXPECT_EQ(find(small, "obstacles")->type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(find(small, "obstacles")->points.size(), 36u);  // a cube
  EXPECT_EQ(find(small, "obstacles")->scale.x, 1.0);        // its points are in metres

  const std::vector<Vec3> sheet{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  mesh.file.surface =
      std::make_shared<TriangleSurface>(sheet, std::vector<TriangleSurface::Triangle>{{0, 1, 2}});
  snapshot.obstacles[0].shape = mesh;
  const auto open = sent(builder, snapshot, ros::Time(1.5));
  ASSERT_EQ(find(open, "obstacles")->points.size(), 6u) << "either side is lit";
  EXPECT_GT(find(open, "obstacles")->points[0].z, 0.0);
  EXPECT_LT(find(open, "obstacles")->points[3].z, 0.0);

  std::vector<Vec3> corners;
  std::vector<TriangleSurface::Triangle> triangles;
  for (int k = 0; k < 20001; ++k) {
    for (const Vec3& corner : {Vec3(0.0, 0.0, k), Vec3(1.0, 0.0, k), Vec3(0.0, 1.0, k)}) {
      corners.push_back(corner);
    }
    triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  mesh.file.surface = std::make_shared<TriangleSurface>(corners, triangles);
  snapshot.obstacles[0].shape = mesh;
  const auto large = sent(builder, snapshot, ros::Time(2.0));
  EXPECT_EQ(find(large, "obstacles")->type, Marker::MESH_RESOURCE);
  EXPECT_EQ(find(large, "obstacles")->mesh_resource, "file:///somewhere/part.stl");
  EXPECT_EQ(find(large, "obstacles")->scale.x, 0.001);
  EXPECT_TRUE(find(large, "obstacles")->points.empty());
}

TEST(Markers, EveryShapeIsDrawn) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(3);
  for (const Shape& shape : allShapes()) {
    snapshot.obstacles.resize(1);
    snapshot.obstacles[0].shape = shape;
    const auto array = sent(builder, snapshot, ros::Time(1.0));
    EXPECT_EQ(count(array, "obstacles") + count(array, "bounds"),
              static_cast<int>(drawing(shape).size()))
        << typeNames(shape).front();
  }
}

TEST(Markers, OfAClampThatWentAreDeleted) {
  MarkerBuilder builder{MarkerStyle()};
  Snapshot snapshot = flatCloth(3);
  snapshot.clamps.resize(2);
  const std::size_t both = sent(builder, snapshot, ros::Time(1.0)).markers.size();
  snapshot.clamps.pop_back();
  const auto array = sent(builder, snapshot, ros::Time(2.0));
  ASSERT_EQ(array.markers.size(), both);
  EXPECT_EQ(array.markers[both - 1].action, Marker::DELETE);
  EXPECT_EQ(array.markers[both - 2].action, Marker::DELETE);
  EXPECT_EQ(array.markers[both - 3].action, Marker::ADD);
}

TEST(Markers, TextTellsPhaseCountsAndTime) {
  Snapshot snapshot = flatCloth(3);
  snapshot.time = 7.25;
  Figures figures;
  figures.pieces.resize(2);
  snapshot.broken.total = 14;
  const std::string text = statusLine(snapshot, figures);
  for (const char* part : {"pull", "7.25", "pieces 2", "broken 14"}) {
    EXPECT_THAT(text, testing::HasSubstr(part));
  }
}

}  // namespace
}  // namespace cloth_sim
