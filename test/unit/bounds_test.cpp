/// \file Bounds of what comes from outside: numbers, names, the work of a request.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "scene/names.h"
#include "unit/core_support.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The error of a scene; "" if it has none.
std::string errorOf(const std::string& yaml) {
  return sceneErrorOf([&] { parseScene(yaml, "it.yaml"); });
}

TEST(Bounds, AbsurdNumbersAreRefusedWithFileKeyValueAndBound) {
  const std::string cloth = "cloth: {size: [1, 1], particles: [4, 4]";
  EXPECT_THAT(errorOf(cloth + ", pose: {position: [0, 0, 1e308]}}"),
              AllOf(HasSubstr("it.yaml:1: cloth.pose.position.2: "), HasSubstr("at most 1e9"),
                    HasSubstr("got 1e308")));
  EXPECT_THAT(errorOf(cloth + ", fabric: {tensile_warp: 1e300}}"),
              AllOf(HasSubstr("cloth.fabric.tensile_warp: "), HasSubstr("at most 1e9")));
  EXPECT_THAT(errorOf(cloth + "}\ngravity: [0, 0, -1e300]"),
              AllOf(HasSubstr("it.yaml:2: gravity.2: "), HasSubstr("at most 1e9 in size")));
  EXPECT_THAT(errorOf(cloth + "}\nsolver: {dt: 1e-300}"),
              AllOf(HasSubstr("solver.dt: "), HasSubstr("at least 1e-12")));
  EXPECT_EQ(errorOf(cloth + ", fabric: {tensile_warp: 1e6}}"), "");
}

TEST(Bounds, NamesHaveALengthAndAreNotEchoed) {
  const std::string name(1000000, 'a');
  EXPECT_THAT(nameError(name), HasSubstr("at most 100 characters"));
  EXPECT_EQ(nameError(std::string(100, 'a')), "");
  EXPECT_LT(unknownName("clamp", name, {name, name}).size(), 250u);
  EXPECT_LT(errorOf("cloth: {size: [1, 1], " + name + ": 1}").size(), 600u);
  EXPECT_LT(errorOf("cloth: {size: [1, " + std::string(100000, '1') + "]}").size(), 300u);
}

TEST(Bounds, ListsEndAfterTenNames) {
  std::vector<std::string> names;
  for (int k = 0; k < 25; ++k) names.push_back("clamp" + std::to_string(k));
  EXPECT_THAT(joinNames(names), AllOf(HasSubstr("clamp9 and 15 more"), Not(HasSubstr("clamp10"))));
}

TEST(Bounds, MessagesAreASCII) {
  for (const std::string& text : {unknownName("phase", "\xff\xc3", {"\xe2\x82"}),
                                  errorOf("cloth: {\xc3\xa4: 1}"), errorOf("gravity: \xc3\xa4")}) {
    ASSERT_FALSE(text.empty());
    for (const char c : text) EXPECT_LT(static_cast<unsigned char>(c), 0x80) << text;
  }
}

/// A square metre of cotton with `side` particles along each side.
Scene squareOf(int side) {
  Scene scene;
  scene.cloths[0] = clothOf(side, side, 1.0 / (side - 1), fabricPreset("cotton"));
  scene.solver.method = "verlet";
  scene.solver.parameters = completeParameters(findSolver("verlet"), {});
  return scene;
}

TEST(Bounds, AScribbleBeyondReasonIsRefusedBeforeTheWork) {
  Simulation simulation(squareOf(128));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  std::vector<Vec3> path;
  for (int k = 0; k < 10000; ++k) path.emplace_back(place(random), place(random), 0.0);
  const auto before = std::chrono::steady_clock::now();
  const CommandResult result = simulation.apply(CutAlong{strokeAlong(path, Vec3::UnitZ(), 0.5)});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
  EXPECT_FALSE(result.success);
  EXPECT_THAT(result.message, HasSubstr("the stroke is too long for this mesh"));
  // The work took 23 s; the bound costs a pass over points and particles.
  EXPECT_LT(took.count(), 0.5);
  EXPECT_EQ(simulation.pieces(), 1);
}

TEST(Bounds, ALongStrokeBesideTheClothIsNotCounted) {
  Simulation simulation(squareOf(32));
  std::vector<Vec3> path;
  for (int k = 0; k < 5000; ++k) path.emplace_back(k % 2 == 0 ? -5.0 : 5.0, 3.0, 0.0);
  EXPECT_TRUE(simulation.apply(CutAlong{strokeAlong(path, Vec3::UnitZ(), 0.5)}).success);
}

}  // namespace
}  // namespace cloth_sim
