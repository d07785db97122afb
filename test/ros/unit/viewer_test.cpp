/// \file What is drawn from messages is what is drawn from the simulation, to the float.

#include "ros/viewer.h"

#include <gtest/gtest.h>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "ros/unit/received.h"

namespace cloth_sim {
namespace {

Simulation cutCloth() {
  Simulation simulation(parseScene(R"(
cloth: {size: [0.2, 0.2], particles: [5, 5], pins: [corner_00, corner_10]}
obstacles: {ball: {type: sphere, radius: 0.05, position: [0, 0, -0.3]}}
clamps: {left: {pose: {position: [0.0, 0.0, 0.5]}, plate_size: [0.03, 0.04]}}
)",
                                   "test"));
  for (int k = 0; k < 3; ++k) simulation.step();
  const Stroke middle =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.02, 0.0)}, Vec3::UnitZ(), 1.0);
  EXPECT_TRUE(simulation.apply(CutAlong{middle}).success);
  return simulation;
}

TEST(Viewer, DrawsTheSame) {
  Simulation simulation = cutCloth();
  Observation observation;
  observation.snapshot = observation.whole = simulation.snapshot();
  const std_msgs::Header header;
  ClothFrame frame;
  fillFrame(*observation.snapshot, header, frame);

  Snapshot seen;
  seen.topology = fromTopologyMessage(toTopologyMessage(*observation.snapshot->topology, header));
  ASSERT_NE(seen.topology, nullptr);
  ASSERT_TRUE(fromFrameMessage(frame, seen));
  fromStateMessage(toStateMessage(observation, header), simulation.scene(), seen);
  seen.obstacles = simulation.scene().obstacles;

  MarkerBuilder first{MarkerStyle()};
  MarkerBuilder second{MarkerStyle()};
  const auto meant =
      received(first.build(*observation.snapshot, *observation.snapshot->figures, ros::Time(1)));
  const auto drawn = received(second.build(seen, *seen.figures, ros::Time(1)));
  ASSERT_EQ(drawn.markers.size(), meant.markers.size());
  for (std::size_t k = 0; k < meant.markers.size(); ++k) {
    EXPECT_EQ(drawn.markers[k].ns, meant.markers[k].ns);
    EXPECT_EQ(drawn.markers[k].action, meant.markers[k].action);
    EXPECT_EQ(drawn.markers[k].text, meant.markers[k].text);
    ASSERT_EQ(drawn.markers[k].points.size(), meant.markers[k].points.size());
    for (std::size_t p = 0; p < meant.markers[k].points.size(); ++p) {
      EXPECT_NEAR(drawn.markers[k].points[p].x, meant.markers[k].points[p].x, 1e-5);
      EXPECT_NEAR(drawn.markers[k].points[p].z, meant.markers[k].points[p].z, 1e-5);
    }
  }
}

TEST(Viewer, LeavesOutWhatDoesNotBelongTogether) {
  Simulation simulation = cutCloth();
  const auto snapshot = simulation.snapshot();
  const std_msgs::Header header;
  ClothFrame frame;
  fillFrame(*snapshot, header, frame);
  Snapshot seen;
  EXPECT_FALSE(fromFrameMessage(frame, seen)) << "no topology yet";
  ClothTopology topology = toTopologyMessage(*snapshot->topology, header);
  seen.topology = fromTopologyMessage(topology);
  ClothFrame wrong = frame;
  ++wrong.revision;
  EXPECT_FALSE(fromFrameMessage(wrong, seen));
  wrong = frame;
  wrong.positions.pop_back();
  EXPECT_FALSE(fromFrameMessage(wrong, seen));
  EXPECT_TRUE(fromFrameMessage(frame, seen));
  topology.triangles[0] = 100000;
  EXPECT_EQ(fromTopologyMessage(topology), nullptr);
}

}  // namespace
}  // namespace cloth_sim
