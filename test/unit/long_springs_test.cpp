/// \file Which springs are long is known exactly, though most are not looked at.

#include "cloth_sim/surgery/long_springs.h"

#include <gtest/gtest.h>

#include <limits>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A cloth whose springs are watched.
struct WatchedCloth {
  WatchedCloth(double ratio, Generator& random) : model(buildModel(clothOf(9, 7, 0.01))) {
    for (const Spring& spring : model.springs.slots()) {
      // Some are much shorter before they are long, and some never are.
      const double one = random() % 20 == 0 ? kInfinity : ratio * uniform(random, 0.5, 1.0);
      limits.push_back((1.0 + one) * spring.restLength);
      springs.watch(spring, limits.back());
    }
  }
  std::vector<std::int32_t> allLong(const State& state) const {
    std::vector<std::int32_t> found;
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(limits.size()); ++k) {
      const Spring& spring = model.springs[k];
      const double length = (state.x[spring.b] - state.x[spring.a]).norm();
      if (length > limits[static_cast<std::size_t>(k)]) found.push_back(k);
    }
    return found;
  }

  Model model;
  std::vector<double> limits;
  LongSprings springs;
};

TEST(LongSprings, AreFoundWhileParticlesDriftLittleAndMuchAndAllTogether) {
  Generator random(3);
  std::size_t found = 0;
  for (const double ratio : {0.02, 0.3, 9.0}) {
    for (const double stride : {0.001, 0.03, 1.0}) {
      WatchedCloth cloth(ratio, random);
      State state = flatState(cloth.model);
      for (int step = 0; step < 200; ++step) {
        const Vec3 together = randomVector(random, 0.1);
        for (Vec3& x : state.x) x += together + randomVector(random, stride * ratio * 0.01);
        const std::vector<std::int32_t> expected = cloth.allLong(state);
        ASSERT_EQ(cloth.springs.find(state.x), expected) << "ratio " << ratio << ", step " << step;
        found += expected.size();
      }
    }
  }
  EXPECT_GT(found, 10000U);
}

TEST(LongSprings, AreNoneWhereNothingIsWatchedOrNoneIsEverLong) {
  const Model model = buildModel(clothOf(4, 4, 0.01));
  State state = flatState(model);
  LongSprings springs;
  EXPECT_TRUE(springs.find(state.x).empty());
  for (const Spring& spring : model.springs.slots()) springs.watch(spring, kInfinity);
  for (int k = 0; k < 20; ++k) springs.watchNothing();
  state.x[3].setConstant(1e6);
  EXPECT_TRUE(springs.find(state.x).empty());
  springs.clear();
  springs.watch(model.springs[0], 0.0);
  EXPECT_EQ(springs.find(state.x), std::vector<std::int32_t>{0});
}

TEST(LongSprings, OfFewerThanThereAreParticlesAreAllLookedAt) {
  const Model model = buildModel(clothOf(4, 4, 0.01));
  State state = flatState(model);
  LongSprings springs;
  const Spring& spring = model.springs[0];
  springs.watch(spring, 1.5 * spring.restLength);
  EXPECT_TRUE(springs.find(state.x).empty());
  state.x[spring.b] += state.x[spring.b] - state.x[spring.a];
  EXPECT_EQ(springs.find(state.x), std::vector<std::int32_t>{0});
}

}  // namespace
}  // namespace cloth_sim
