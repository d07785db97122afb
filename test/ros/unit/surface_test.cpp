/// \file Topology and frame -> vertices and colours, without a node, a master and rviz.

#include "ros/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

/// One cell of 1 m, its front up, its second triangle's right edge torn.
ClothTopology cell() {
  ClothTopology topology;
  topology.revision = 7;
  topology.triangles = {0, 1, 3, 0, 3, 2};
  topology.uv = {0, 0, 1, 0, 0, 1, 1, 1};
  topology.torn_edges = {1, 3};
  return topology;
}

/// The cell pulled to `stretch` along x, at z = 2.
ClothFrame pulled(float stretch) {
  ClothFrame frame;
  frame.revision = 7;
  frame.positions = {0, 0, 2, stretch, 0, 2, 0, 1, 2, stretch, 1, 2};
  return frame;
}

Surface::Packed bytes(const std_msgs::ColorRGBA& colour) {
  const auto byte = [](float x) { return static_cast<std::uint8_t>(std::lround(255.0f * x)); };
  return {byte(colour.r), byte(colour.g), byte(colour.b), 255};
}

TEST(Surface, StrainIsThatOfTheMostStretchedEdge) {
  Surface surface;
  ASSERT_EQ(surface.setTopology(cell()), "");
  ASSERT_EQ(surface.setFrame(pulled(1.1f), SurfaceStyle()), "");
  // Every corner has an edge along x, which is stretched more than the diagonal.
  EXPECT_THAT(surface.strain(), testing::Each(testing::FloatNear(0.1f, 1e-6f)));
}

/// A receiver of messages derives the springs that the simulation has, also where it was cut and
/// refined.
TEST(Surface, ShowsTheStrainOfTheSimulation) {
  Simulation simulation(parseScene(R"(
cloth: {size: [0.3, 0.3], particles: [12, 12], pins: [corner_00, corner_10, corner_01],
        raw_springs: {structural: 20.0, shear: 5.0}, particle_mass: 0.01}
wind: {velocity: [3.0, 2.0, 5.0]}
)",
                                   "test"));
  for (int k = 0; k < 20; ++k) simulation.step();
  const Stroke middle =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.05, 0.0)}, Vec3::UnitZ(), 1.0);
  ASSERT_TRUE(simulation.apply(CutAlong{middle}).success);
  for (int k = 0; k < 10; ++k) simulation.step();
  const auto snapshot = simulation.snapshot();
  std::vector<float> wanted;
  vertexStrains(snapshot->topology->strainLines, snapshot->positions, wanted);

  const std_msgs::Header header;
  ClothFrame frame;
  fillFrame(*snapshot, header, frame);
  Surface surface;
  ASSERT_EQ(surface.setTopology(toTopologyMessage(*snapshot->topology, header)), "");
  ASSERT_EQ(surface.setFrame(frame, SurfaceStyle()), "");
  EXPECT_THAT(surface.strain(), testing::Pointwise(testing::FloatNear(1e-4f), wanted));
  const float largest = *std::max_element(surface.strain().begin(), surface.strain().end());
  EXPECT_GT(largest, 0.01f);
  EXPECT_NEAR(largest, strainOfStretch(snapshot->figures->maxStretch), 1e-4);
}

TEST(Surface, WhatIsPushedTogetherHasNoStrain) {
  Surface surface;
  ASSERT_EQ(surface.setTopology(cell()), "");
  ClothFrame frame = pulled(0.5f);
  for (float& x : frame.positions) x *= 0.9f;
  ASSERT_EQ(surface.setFrame(frame, SurfaceStyle()), "");
  EXPECT_THAT(surface.strain(), testing::Each(0.0f));
}

TEST(Surface, FrontAndBackAreShadedByTheirOwnNormals) {
  Surface surface;
  SurfaceStyle style;
  ASSERT_EQ(surface.setTopology(cell()), "");
  ASSERT_EQ(surface.setFrame(pulled(1.0f), style), "");
  for (const Eigen::Vector3f& normal : surface.normals()) {
    EXPECT_NEAR((normal - Eigen::Vector3f::UnitZ()).norm(), 0.0f, 1e-6f);
  }
  const float up = brightness(Eigen::Vector3f::UnitZ());
  const float down = brightness(-Eigen::Vector3f::UnitZ());
  EXPECT_GT(up, down);
  EXPECT_THAT(surface.frontColours(), testing::Each(bytes(shaded(strainColour(0.0), up))));
  EXPECT_THAT(surface.backColours(), testing::Each(bytes(shaded(style.back, down))));
  style.strain = false;
  ASSERT_EQ(surface.setFrame(pulled(1.0f), style), "");
  EXPECT_THAT(surface.frontColours(), testing::Each(bytes(shaded(style.front, up))));
}

TEST(Surface, TheLastColourIsThatOfTheRangeAndOfAllBeyond) {
  Surface surface;
  SurfaceStyle style;
  style.strainRange = 0.1;
  const auto last = bytes(shaded(strainColour(1.0), brightness(Eigen::Vector3f::UnitZ())));
  ASSERT_EQ(surface.setTopology(cell()), "");
  for (const float stretch : {1.1f, 1.5f, 100.0f}) {
    ASSERT_EQ(surface.setFrame(pulled(stretch), style), "");
    EXPECT_THAT(surface.frontColours(), testing::Each(last)) << stretch;
  }
}

TEST(Surface, TornEdgesGetTwoCrossedRibbonsOfTheirWidth) {
  Surface surface;
  SurfaceStyle style;
  style.tornWidth = 0.02;
  ASSERT_EQ(surface.setTopology(cell()), "");
  ASSERT_EQ(surface.setFrame(pulled(1.0f), style), "");
  ASSERT_EQ(surface.torn().positions().size(), 3u * 8u);
  ASSERT_EQ(surface.torn().triangles().size(), 3u * 4u);
  for (std::size_t v = 0; v < 8; ++v) {
    const Eigen::Map<const Eigen::Vector3f> p(&surface.torn().positions()[3 * v]);
    EXPECT_NEAR(std::hypot(p.x() - 1.0f, p.z() - 2.0f), 0.01f, 1e-6f) << v;
  }
  ClothTopology whole = cell();
  whole.torn_edges.clear();
  ASSERT_EQ(surface.setTopology(whole), "");
  ASSERT_EQ(surface.setFrame(pulled(1.0f), style), "");
  EXPECT_TRUE(surface.torn().positions().empty());
  EXPECT_TRUE(surface.torn().triangles().empty());
}

TEST(Surface, BordersAreTheEdgesOfOneFaceThatAreNotTorn) {
  Surface surface;
  SurfaceStyle style;
  style.borderWidth = 0.01;
  ASSERT_EQ(surface.setTopology(cell()), "");
  EXPECT_THAT(surface.border().edges(), testing::ElementsAre(0, 1, 0, 2, 2, 3));
  ASSERT_EQ(surface.setFrame(pulled(1.0f), style), "");
  ASSERT_EQ(surface.border().positions().size(), 3u * 3u * 8u);
  for (std::size_t v = 0; v < 8; ++v) {  // of the edge 0, 1, which lies along x
    const Eigen::Map<const Eigen::Vector3f> p(&surface.border().positions()[3 * v]);
    EXPECT_NEAR(std::hypot(p.y(), p.z() - 2.0f), 0.005f, 1e-6f) << v;
  }
}

TEST(Surface, FramesOfAnotherRevisionAreNotTaken) {
  Surface surface;
  ASSERT_EQ(surface.setTopology(cell()), "");
  ASSERT_EQ(surface.setFrame(pulled(1.0f), SurfaceStyle()), "");
  ClothFrame other = pulled(1.3f);
  other.revision = 8;
  EXPECT_FALSE(surface.fits(other));
  EXPECT_NE(surface.setFrame(other, SurfaceStyle()), "");
  EXPECT_THAT(surface.strain(), testing::Each(0.0f));
  ClothTopology next = cell();
  next.revision = 8;
  ASSERT_EQ(surface.setTopology(next), "");
  EXPECT_TRUE(surface.positions().empty()) << "nothing to show until a frame of it comes";
  EXPECT_EQ(surface.setFrame(other, SurfaceStyle()), "");
}

TEST(Surface, BadMessagesAreRefused) {
  Surface surface;
  ASSERT_EQ(surface.setTopology(cell()), "");
  for (const std::uint32_t number : {4u, 4000000000u}) {
    ClothTopology bad = cell();
    bad.triangles[4] = number;
    EXPECT_NE(surface.setTopology(bad), "");
    bad = cell();
    bad.torn_edges[1] = number;
    EXPECT_NE(surface.setTopology(bad), "");
  }
  ClothTopology bad = cell();
  bad.triangles.pop_back();
  EXPECT_NE(surface.setTopology(bad), "");
  EXPECT_EQ(surface.triangles(), cell().triangles) << "the last good one stays";
  ClothFrame frame = pulled(1.0f);
  frame.positions.pop_back();
  EXPECT_NE(surface.setFrame(frame, SurfaceStyle()), "");
  frame.positions.push_back(std::numeric_limits<float>::quiet_NaN());
  EXPECT_NE(surface.setFrame(frame, SurfaceStyle()), "");
}

TEST(Surface, AnEmptyClothIsDrawnAsNothing) {
  Surface surface;
  ClothTopology empty;
  ClothFrame frame;
  ASSERT_EQ(surface.setTopology(empty), "");
  EXPECT_EQ(surface.setFrame(frame, SurfaceStyle()), "");
  EXPECT_TRUE(surface.positions().empty());
}

}  // namespace
}  // namespace cloth_sim
