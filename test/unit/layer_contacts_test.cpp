/// \file Projection of contacts between layers.

#include "contact/layer_contacts.h"

#include <gtest/gtest.h>

#include <numeric>

#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

/// Held corners of a face come down on another face, a thousandth of its edge from a held corner.
TEST(LayerContacts, APushThrowsNoLightVertexBesideAHeldOne) {
  ClothSpec cloth;
  cloth.columns = cloth.rows = 4;
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  const FaceId last = model.mesh.faceCount() - 1;
  const Face above = model.mesh.face(0);
  const Face below = model.mesh.face(last);
  std::vector<Vec3> start(static_cast<std::size_t>(model.particleCount()), Vec3(9.0, 9.0, 9.0));
  std::vector<double> mass(start.size(), 1e-6);
  start[below[0]] = Vec3::Zero();
  start[below[1]] = Vec3(0.1, 0.0, 0.0);
  start[below[2]] = Vec3(0.0, 0.1, 0.0);
  mass[below[0]] = 0.0;
  std::vector<Vec3> end = start;
  for (int k = 0; k < 3; ++k) {
    start[above[k]] = Vec3(1e-4, 1e-5 * k, 0.001);
    end[above[k]] = Vec3(1e-4, 1e-5 * k, 0.0005);
    mass[above[k]] = 0.0;
  }
  LayerContacts contacts;
  contacts.build(model, {{0.001, 0.3}});
  std::vector<QuickBox> corners;
  for (const Vec3& x : start) corners.emplace_back(Box{x.array() - 0.0005, x.array() + 0.0005});
  std::vector<QuickBox> faces(model.mesh.faces().size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const VertexId v : model.mesh.faces()[f]) faces[f].add(corners[v]);
  }
  const std::vector<FaceIds> pairs{{0, last}};
  const std::vector<FaceId> paired{0, last};
  const NearFaces near{pairs, paired, {corners, faces}};
  contacts.assign(near);
  std::vector<VertexId> all(start.size());
  std::iota(all.begin(), all.end(), 0);
  contacts.project({start, end, mass, all}, 1e-3, near);
  EXPECT_GT(contacts.active(), 0);
  EXPECT_LT((end[below[1]] - start[below[1]]).norm(), 0.02);
}

TEST(LayerContacts, PointsAndLeastDistanceAreOfContactsThatCarryLoad) {
  const std::string yaml = R"(
cloth:
  - {name: lower, size: [0.1, 0.1], particles: [9, 9], fabric: cotton, thickness: 0.001}
  - {name: upper, size: [0.1, 0.1], particles: [9, 9], fabric: cotton, thickness: 0.001,
     pose: {position: [0, 0, 0.01]}}
self_contact: true
drag: 2
solver: {method: line_xpbd, error: 0.01}
obstacles: {table: {type: board, size: [1, 1, 0.1], position: [0, 0, -0.0505]}}
)";
  Simulation simulation(parseScene(yaml, "two"));
  simulation.step();
  ASSERT_TRUE(simulation.layerReport().has_value());
  EXPECT_EQ(simulation.layerReport()->contacts, 0) << "the upper cloth is still in the air";
  EXPECT_TRUE(std::isinf(simulation.layerReport()->leastDistance));
  for (int k = 0; k < 60; ++k) simulation.step();
  const auto snapshot = simulation.snapshot(Detail::kShape, ContactDetail::kPoints);
  EXPECT_NEAR(simulation.layerReport()->leastDistance, 0.001, 2e-5);
  ASSERT_TRUE(snapshot->contactPoints.has_value());
  double force = 0.0;
  for (const LayerContactPoint& contact : *snapshot->contactPoints) {
    EXPECT_NEAR(contact.place.z(), 0.0005, 1e-4) << "in the middle between the cloths";
    EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-12);
    EXPECT_GT(contact.force, 0.0);
    force += contact.force * std::abs(contact.normal.z());
  }
  const double weight = 9.81 * 0.5 * totalMass(simulation.model());
  EXPECT_NEAR(force, weight, 0.05 * weight) << "the lower cloth carries the upper one";
  EXPECT_FALSE(simulation.snapshot(Detail::kShape)->contactPoints) << "not asked for";
}

}  // namespace
}  // namespace cloth_sim
