#include "study/simplify.h"

#include <gmock/gmock.h>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

Scene sceneOf(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parseScene(text, "t.yaml", overrides);
}

TEST(Coarser, CarriesPinsAndPatchesOver) {
  const std::string text =
      "cloth: {particles: [13, 9], pins: [last_row, [4, 2]]}\n"
      "clamps: {left: {patch: {particle: [2, 4], radius: 2}}}";
  const Simplification half = coarser(sceneOf(text), 2.0);
  EXPECT_THAT(half.overrides, ElementsAre("cloth.particles=[7, 5]", "cloth.pins=[last_row, [2, 1]]",
                                          "clamps.left.patch={particle: [1, 2], radius: 1}"));
  const Scene coarse = sceneOf(text, half.overrides);
  EXPECT_EQ(coarse.cloths[0].columns, 7);
  EXPECT_EQ(coarse.cloths[0].pins.size(), 8U);
}

TEST(Coarser, SaysWhatItCannotCarryOver) {
  EXPECT_THAT(coarser(sceneOf("cloth: {particles: [13, 9], pins: [[5, 2]]}"), 2.0).obstacle,
              HasSubstr("[5, 2]"));
  EXPECT_THAT(
      coarser(sceneOf("cloth: {particles: [13, 9], raw_springs: {structural: 1}}"), 2.0).obstacle,
      HasSubstr("raw_springs"));
  EXPECT_THAT(coarser(sceneOf("cloth: {particles: [5, 5]}"), 4.0).obstacle, HasSubstr("no cloth"));
}

TEST(Simplifications, AreOfWhatTheSceneNames) {
  const auto overridesOf = [](const std::string& text) {
    std::vector<std::string> all;
    for (const Simplification& change : simplificationsOf(sceneOf(text))) {
      all.insert(all.end(), change.overrides.begin(), change.overrides.end());
    }
    return all;
  };
  EXPECT_THAT(overridesOf("cloth: {particles: [9, 9]}"), testing::Not(Contains("drag=null")));
  const std::string text =
      "cloth: {particles: [9, 9], fabric: {damping: 0.1}}\ndrag: 1\nwind: {velocity: [1, 0, 0]}";
  const std::vector<std::string> all = overridesOf(text);
  for (const char* override : {"drag=null", "wind=null", "cloth.bending=none", "cloth.shear=false",
                               "cloth.fabric.damping=0"}) {
    EXPECT_THAT(all, Contains(override));
    EXPECT_NO_THROW(sceneOf(text, {override}));
  }
}

TEST(OnGrid, InterpolatesBilinearly) {
  const Grid coarse{3, 2, 2.0, 1.0}, fine{5, 3, 2.0, 1.0};
  const auto place = [](double u, double v) { return Vec3(u, v, 1.0 + 2.0 * u - v + u * v); };
  Trajectory trajectory{{0.5}, {{}}};
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 3; ++i) trajectory.positions[0].push_back(place(i, j));
  }
  const Trajectory result = onGrid(trajectory, coarse, fine);
  ASSERT_EQ(result.positions[0].size(), 15U);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 5; ++i) {
      EXPECT_LT((result.positions[0][fine.vertex(i, j)] - place(0.5 * i, 0.5 * j)).norm(), 1e-14);
    }
  }
  trajectory.positions[0].pop_back();  // it was cut
  EXPECT_TRUE(onGrid(trajectory, coarse, fine).positions.empty());
}

}  // namespace
}  // namespace cloth_sim
