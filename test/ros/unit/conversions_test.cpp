/// \file Core values -> messages, without a node and without a master.

#include "cloth_sim/ros/conversions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace cloth_sim {
namespace {

Observation observe(const Snapshot& snapshot) {
  Observation observation;
  observation.snapshot = observation.whole = std::make_shared<Snapshot>(snapshot);
  return observation;
}

/// A cloth in two pieces, of which some scraps were taken away.
Snapshot cutCloth() {
  Snapshot snapshot;
  auto topology = std::make_shared<Topology>();
  topology->shortestEdge = 0.004;
  topology->stableStep = 1e-4;
  snapshot.topology = topology;
  snapshot.figures.emplace();
  snapshot.figures->pieces = {{6, 0.3, 0.6, Vec3(1.0, 2.0, 3.0)},
                              {2, 0.1, 0.2, Vec3(0.0, 0.0, 1.0)}};
  snapshot.dropped = {5, 0.01, 0.02};
  snapshot.figures->mass = 0.4;
  snapshot.figures->restArea = 0.8;
  return snapshot;
}

TEST(StateMessage, HasEveryPieceInTheOrderOfTheSnapshot) {
  const ClothState state = toStateMessage(observe(cutCloth()), std_msgs::Header());
  EXPECT_EQ(state.pieces, 2u);
  ASSERT_EQ(state.piece.size(), 2u);
  EXPECT_EQ(state.piece[0].faces, 6u);
  EXPECT_EQ(state.piece[0].mass, 0.3);
  EXPECT_EQ(state.piece[0].rest_area, 0.6);
  EXPECT_EQ(fromPoint(state.piece[0].centre_of_mass), Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(state.piece[1].faces, 2u);
}

TEST(StateMessage, HasTheDroppedScrapsAndTheFiguresOfTheMesh) {
  const ClothState state = toStateMessage(observe(cutCloth()), std_msgs::Header());
  EXPECT_EQ(state.dropped_pieces, 5u);
  EXPECT_EQ(state.dropped_mass, 0.01);
  EXPECT_EQ(state.dropped_area, 0.02);
  EXPECT_EQ(state.shortest_edge, 0.004);
  EXPECT_EQ(state.stable_step, 1e-4);
  EXPECT_EQ(state.mass, 0.4);
  EXPECT_EQ(state.rest_area, 0.8);
}

TEST(StateMessage, HasNoPieceOfACompletelyDroppedCloth) {
  Snapshot snapshot = cutCloth();
  snapshot.figures->pieces.clear();
  const ClothState state = toStateMessage(observe(snapshot), std_msgs::Header());
  EXPECT_EQ(state.pieces, 0u);
  EXPECT_TRUE(state.piece.empty());
}

TEST(StateMessage, SaysWhetherLayersTouchAndHow) {
  Snapshot snapshot = cutCloth();
  EXPECT_FALSE(toStateMessage(observe(snapshot), std_msgs::Header()).contact.on);
  snapshot.layers.emplace();
  snapshot.layers->pairs = 7;
  snapshot.layers->truncated = 1;
  snapshot.layers->moves = 4;
  snapshot.layers->blocked = 2;
  ContactInfo contact = toStateMessage(observe(snapshot), std_msgs::Header()).contact;
  EXPECT_TRUE(contact.on);
  EXPECT_EQ(contact.pairs, 7U);
  EXPECT_EQ(contact.truncated, 0.25);
  EXPECT_EQ(contact.smallest_distance, 0.0) << "infinite without contacts, which stays inside";
  EXPECT_EQ(contact.blocked, 2U);
  snapshot.layers->contacts = 3;
  snapshot.layers->leastDistance = 0.001;
  contact = toStateMessage(observe(snapshot), std_msgs::Header()).contact;
  EXPECT_EQ(contact.contacts, 3U);
  EXPECT_EQ(contact.smallest_distance, 0.001);
}

TEST(ContactsMessage, ListsPlacesNormalsAndForcesOfThoseThatWereAskedFor) {
  Snapshot snapshot = cutCloth();
  snapshot.time = 2.0;
  EXPECT_TRUE(toContactsMessage(snapshot, std_msgs::Header()).forces.empty());
  snapshot.contactPoints = {{Vec3(1.0, 2.0, 3.0), Vec3::UnitZ(), 0.5},
                            {Vec3(4.0, 5.0, 6.0), Vec3::UnitX(), 0.25}};
  const ClothContacts message = toContactsMessage(snapshot, std_msgs::Header());
  EXPECT_EQ(message.time, 2.0);
  EXPECT_THAT(message.positions, testing::ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(message.normals, testing::ElementsAre(0, 0, 1, 1, 0, 0));
  EXPECT_THAT(message.forces, testing::ElementsAre(0.5F, 0.25F));
}

TEST(TopologyMessage, SaysWhichParticlesAreOfWhichCloth) {
  Topology topology;
  topology.cloths = {{"scarf", 0, 12, 0.0, {}}, {"banner", 12, 6, 2.0, {}}};
  const ClothTopology message = toTopologyMessage(topology, std_msgs::Header());
  ASSERT_EQ(message.cloths.size(), 2U);
  EXPECT_EQ(message.cloths[1].name, "banner");
  EXPECT_EQ(message.cloths[1].first_particle, 12U);
  EXPECT_EQ(message.cloths[1].particles, 6U);
  EXPECT_EQ(message.cloths[1].material_offset, 2.0);
}

TEST(EventsMessage, TellsWhereAndWhy) {
  FailureEvent event;
  event.time = 0.5;
  event.kind = SpringKind::kShear;
  event.cause = FailureCause::kCut;
  event.stretch = 1.25;
  event.position = Vec3(1.0, 2.0, 3.0);
  event.material = Vec2(0.25, 0.75);
  const TearEvents message = toEventsMessage({event}, std_msgs::Header());
  ASSERT_EQ(message.events.size(), 1u);
  EXPECT_EQ(message.events[0].time, 0.5);
  EXPECT_EQ(message.events[0].kind, TearEvent::SHEAR);
  EXPECT_EQ(message.events[0].cause, TearEvent::CUT);
  EXPECT_EQ(message.events[0].strain, 0.25);
  EXPECT_EQ(fromPoint(message.events[0].position), Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(message.events[0].material[1], 0.75);
}

TEST(Conversions, WrenchOfAnObstacleIsInItsFrame) {
  Obstacle obstacle;
  obstacle.name = "flap";
  obstacle.pose = {Vec3(1.0, 2.0, 3.0), Quat(Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitX()))};
  const Wrench wrench{Vec3(0.0, 0.0, -2.0), Vec3(0.5, 0.0, 0.0)};
  const auto message = toWrenchMessage(obstacle, wrench, ros::Time(3.0), "/robots/cloth");
  EXPECT_EQ(message.header.frame_id, "robots/cloth/obstacle_flap");
  // Its y axis is the world's z axis.
  EXPECT_NEAR(message.wrench.force.y, -2.0, 1e-15);
  EXPECT_NEAR(message.wrench.force.z, 0.0, 1e-15);
  EXPECT_NEAR(message.wrench.torque.x, 0.5, 1e-15);
}

}  // namespace
}  // namespace cloth_sim
