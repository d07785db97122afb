/// \file Spring networks of grids: their springs.

#include "cloth_sim/cloth/spring_network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

TEST(SpringNetwork, OfAGridHasFewDifferentSpringsAndKeepsEachOnce) {
  // Otherwise a cloth of a million particles takes half as much memory again.
  for (const char* fabric : {"cotton", "silk", "denim"}) {
    for (const int side : {33, 64, 128}) {
      const SpringNetwork springs(makeGridMesh({side, side, 1.0, 1.0}), fabricPreset(fabric), {});
      EXPECT_LT(springs.slots().typeCount(), springs.slots().size() / 20)
          << fabric << ", " << side << " particles a side";
    }
  }
}

TEST(SpringNetwork, DoesNotDependOnTheDiagonalsOfTheCells) {
  using Key = std::tuple<SpringKind, VertexId, VertexId>;
  const auto constants = [](Diagonals diagonals) {
    ClothSpec cloth = clothOf(6, 7, 0.1, fabricPreset("cotton"));
    cloth.springs.bend = false;  // their areas follow the masses, which do depend
    cloth.diagonals = diagonals;
    const Model model = buildModel(cloth);
    std::map<Key, double> all;
    for (const Spring& spring : model.springs.slots()) {
      all[{spring.kind, std::min(spring.a, spring.b), std::max(spring.a, spring.b)}] =
          spring.stiffness;
    }
    return all;
  };
  const std::map<Key, double> oneWay = constants(Diagonals::kOneWay);
  const std::map<Key, double> alternating = constants(Diagonals::kAlternating);
  ASSERT_EQ(oneWay.size(), alternating.size());
  for (const auto& [spring, stiffness] : oneWay) {
    ASSERT_EQ(alternating.count(spring), 1u);
    EXPECT_NEAR(alternating.at(spring), stiffness, 1e-12 * stiffness);
  }
}

TEST(SpringNetwork, GridHasTheClassicStencil) {
  const int n = 7;
  const Model model = buildModel(clothOf(n, n, 0.1));
  EXPECT_EQ(model.springs.count(SpringKind::kStructural), 2 * n * (n - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kShear), 2 * (n - 1) * (n - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kBend), 2 * n * (n - 2));
  EXPECT_EQ(model.springs.count(), 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2));

  // Offsets, in columns and rows, at which the particle in the middle has neighbours.
  std::map<SpringKind, std::vector<std::pair<int, int>>> offsets;
  const VertexId middle = model.cloths[0].grid->vertex(3, 3);
  for (const Spring& spring : model.springs.slots()) {
    if (spring.a != middle && spring.b != middle) continue;
    const VertexId other = spring.a == middle ? spring.b : spring.a;
    offsets[spring.kind].emplace_back(other % n - 3, other / n - 3);
  }
  using Offsets = std::vector<std::pair<int, int>>;
  EXPECT_THAT(offsets[SpringKind::kStructural],
              testing::UnorderedElementsAreArray(Offsets{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}));
  EXPECT_THAT(offsets[SpringKind::kShear],
              testing::UnorderedElementsAreArray(Offsets{{1, 1}, {-1, -1}, {-1, 1}, {1, -1}}));
  EXPECT_THAT(offsets[SpringKind::kBend],
              testing::UnorderedElementsAreArray(Offsets{{2, 0}, {-2, 0}, {0, 2}, {0, -2}}));
}

TEST(SpringNetwork, CountsOnARectangle) {
  const int c = 6, r = 4;
  const Model model = buildModel(clothOf(c, r, 0.1));
  EXPECT_EQ(model.springs.count(SpringKind::kStructural), (c - 1) * r + c * (r - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kShear), 2 * (c - 1) * (r - 1));
  EXPECT_EQ(model.springs.count(SpringKind::kBend), (c - 2) * r + c * (r - 2));
}

TEST(SpringNetwork, KnowsDirectionsAndRestLengths) {
  const Model model = buildModel(clothOf(5, 5, 0.2));
  for (const Spring& spring : model.springs.slots()) {
    const Vec2 d = model.mesh.material(spring.b) - model.mesh.material(spring.a);
    const bool alongU = std::abs(d.y()) < 1e-12;
    const bool alongV = std::abs(d.x()) < 1e-12;
    const ThreadDirection expected = alongU   ? ThreadDirection::kWarp
                                     : alongV ? ThreadDirection::kWeft
                                              : ThreadDirection::kBias;
    EXPECT_EQ(spring.direction, expected);
    EXPECT_EQ(spring.kind == SpringKind::kShear, expected == ThreadDirection::kBias);
    EXPECT_DOUBLE_EQ(spring.restLength, d.norm());
    EXPECT_GT(spring.stiffness, 0.0);
  }
}

TEST(SpringNetwork, LeavesOutWhatIsNotAskedFor) {
  const TriangleMesh mesh = makeGridMesh({5, 5, 1.0, 1.0});
  const SpringNetwork bare(mesh, fabricPreset("silk"), {false, false});
  EXPECT_EQ(bare.count(SpringKind::kShear), 0);
  EXPECT_EQ(bare.count(SpringKind::kBend), 0);
  EXPECT_EQ(bare.count(), 2 * 5 * 4);
}

TEST(SpringNetwork, DashpotsAreTheRetardationTimeTimesTheStiffness) {
  Fabric fabric = fabricPreset("denim");
  fabric.damping = 2.5e-3;
  const SpringNetwork springs(makeGridMesh({4, 4, 1.0, 1.0}), fabric, {});
  for (const Spring& spring : springs.slots()) {
    EXPECT_DOUBLE_EQ(spring.damping, 2.5e-3 * spring.stiffness);
  }
}

TEST(SpringNetwork, BendSpringsMayBeDampedMore) {
  Fabric fabric = fabricPreset("denim");
  fabric.damping = 1e-3;
  fabric.bendingDamping = 0.02;
  const SpringNetwork springs(makeGridMesh({4, 4, 1.0, 1.0}), fabric, {});
  ASSERT_GT(springs.count(SpringKind::kBend), 0);
  for (const Spring& spring : springs.slots()) {
    const double time = spring.kind == SpringKind::kBend ? 0.021 : 1e-3;
    EXPECT_DOUBLE_EQ(spring.damping, time * spring.stiffness);
  }
}

}  // namespace
}  // namespace cloth_sim
