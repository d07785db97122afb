/// \file Scenes with other numbers of particles.

#include "cloth_sim/scene/resolution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;

/// A banner that hangs from its upper side and from two particles further down, and a scarf.
const char* const kScene = R"(
cloth:
  - {name: banner, size: [0.6, 0.3], particles: [13, 7], pins: [last_row, [0, 3], [12, 3]]}
  - {name: scarf, size: [0.2, 0.4], particles: [5, 9], pose: {position: [1, 0, 0]}}
clamps:
  hand: {patch: {cloth: scarf, particle: [2, 8], radius: 1}}
)";

Scene scene() { return parseScene(kScene, "test"); }

std::string refusal(const Scene& of, int columns) {
  try {
    withColumns(of, columns);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::vector<std::array<int, 2>> pinsOf(const ClothSpec& cloth) {
  std::vector<std::array<int, 2>> pins;
  for (const PinSpec& pin : cloth.pins) pins.push_back({pin.column, pin.row});
  return pins;
}

TEST(Resolution, SidesStayInProportion) {
  EXPECT_EQ(gridsText(withColumns(scene(), 25)), "25 x 13, 9 x 17");
  EXPECT_EQ(gridsText(withColumns(scene(), 7)), "7 x 4, 3 x 5");
  EXPECT_EQ(gridsText(withColumns(scene(), 2)), "2 x 2, 2 x 2") << "a side has two at least";
}

TEST(Resolution, IsThatOfTheSceneAgainWhateverWasBefore) {
  const Scene coarse = withColumns(scene(), 2);
  EXPECT_EQ(gridsText(withColumns(coarse, 25)), "25 x 13, 9 x 17");
  EXPECT_EQ(pinsOf(withColumns(coarse, 13).cloths[0]).size(), 15U);
  const Scene again = withColumns(withColumns(coarse, 40), 0);
  EXPECT_EQ(gridsText(again), gridsText(scene()));
  EXPECT_EQ(pinsOf(again.cloths[0]), pinsOf(scene().cloths[0]));
  EXPECT_EQ(again.original, nullptr);
}

TEST(Resolution, PinsStayInTheirPlaces) {
  // The upper row stays whole, and the single pins single.
  const std::vector<std::array<int, 2>> fine = pinsOf(withColumns(scene(), 25).cloths[0]);
  ASSERT_EQ(fine.size(), 27U);
  EXPECT_EQ(fine[0], (std::array<int, 2>{0, 6}));
  EXPECT_EQ(fine[1], (std::array<int, 2>{24, 6}));
  for (int column = 0; column < 25; ++column) {
    EXPECT_EQ(fine[static_cast<std::size_t>(column) + 2], (std::array<int, 2>{column, 12}));
  }
  EXPECT_EQ(pinsOf(withColumns(scene(), 7).cloths[0]).size(), 9U);
  EXPECT_TRUE(withColumns(scene(), 25).cloths[1].pins.empty());
}

TEST(Resolution, PatchesStayInTheirPlacesAndAsWide) {
  const ClampPatch fine = *withColumns(scene(), 25).clamps[0].patch;
  EXPECT_EQ(fine.column, 4);
  EXPECT_EQ(fine.row, 16);
  EXPECT_EQ(fine.radius, 2);
  EXPECT_EQ(withColumns(scene(), 7).clamps[0].patch->radius, 1);
  EXPECT_EQ(withColumns(scene(), 4).clamps[0].patch->radius, 0);
}

TEST(Resolution, OutOfBoundsIsRefused) {
  for (const int columns : {-1, 1, 2049}) {
    EXPECT_THAT(refusal(scene(), columns), HasSubstr("columns: expected 2 to 2048"));
  }
  EXPECT_THAT(refusal(scene(), 2048), HasSubstr("cloth 'banner' would have 2048 x 1025"));
  const Scene fromFile = loadScene(testing_support::shipped("round_tablecloth"));
  EXPECT_EQ(refusal(fromFile, 20), "cloth 'cloth' is from a file, which gives its particles");
}

TEST(SetResolution, BeginsAnewAsTheSceneWithThatManyParticles) {
  const std::string file = testing_support::shipped("hang");
  Simulation simulation(loadScene(file));
  for (int k = 0; k < 3; ++k) simulation.step();
  const CommandResult result = simulation.apply(SetResolution{17});
  EXPECT_TRUE(result.success) << result.message;
  EXPECT_EQ(result.message, "begins anew with 17 x 17 particles");
  Simulation other(loadScene(file, {"cloth.particles=[17, 17]"}));
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(stateHash(simulation.model(), simulation.state()),
              stateHash(other.model(), other.state()));
    simulation.step();
    other.step();
  }
  // A later reset keeps the number, and a refused command everything.
  EXPECT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_EQ(simulation.model().particleCount(), 17 * 17);
  EXPECT_FALSE(simulation.apply(SetResolution{1}).success);
  EXPECT_EQ(simulation.model().particleCount(), 17 * 17);
  EXPECT_TRUE(simulation.apply(SetResolution{}).success);
  EXPECT_EQ(simulation.model().particleCount(), 64 * 64);
}

}  // namespace
}  // namespace cloth_sim
