/// \file The length monitor finds exactly the springs beyond their limits, though it checks few.

#include "cloth_sim/surgery/spring_length_monitor.h"

#include <gtest/gtest.h>

#include <limits>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A cloth whose springs are monitored.
struct MonitoredCloth {
  MonitoredCloth(double ratio, Generator& random) : model(buildModel(clothOf(9, 7, 0.01))) {
    for (const Spring& spring : model.springs.slots()) {
      // Limits differ by a factor of up to two, and some springs have none.
      const double strain = random() % 20 == 0 ? kInfinity : ratio * uniform(random, 0.5, 1.0);
      limits.push_back((1.0 + strain) * spring.restLength);
      monitor.add(spring, limits.back());
    }
  }
  std::vector<std::int32_t> allBeyondLimit(const State& state) const {
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
  SpringLengthMonitor monitor;
};

TEST(SpringLengthMonitor, FindsAllWhileParticlesMoveLittleAndMuchAndAllTogether) {
  Generator random(3);
  std::size_t found = 0;
  for (const double ratio : {0.02, 0.3, 9.0}) {
    for (const double distance : {0.001, 0.03, 1.0}) {
      MonitoredCloth cloth(ratio, random);
      State state = flatState(cloth.model);
      for (int step = 0; step < 200; ++step) {
        const Vec3 together = randomVector(random, 0.1);
        for (Vec3& x : state.x) x += together + randomVector(random, distance * ratio * 0.01);
        const std::vector<std::int32_t> expected = cloth.allBeyondLimit(state);
        ASSERT_EQ(cloth.monitor.find(state.x), expected) << "ratio " << ratio << ", step " << step;
        found += expected.size();
      }
    }
  }
  EXPECT_GT(found, 10000U);
}

/// A cloth whose springs are replaced, and whose particles are created and moved.
struct EditedSprings {
  struct Limited {
    Spring spring;
    double limit = 0.0;
  };

  EditedSprings() : model(buildModel(clothOf(9, 7, 0.01))), state(flatState(model)) {
    for (const Spring& spring : model.springs.slots()) add(spring, 1.3 * spring.restLength);
  }

  Limited anySpring(Generator& random) const {
    const int last = static_cast<int>(state.x.size()) - 1;
    Spring spring;
    spring.a = whole(random, 0, last);
    spring.b = (spring.a + whole(random, 1, last)) % (last + 1);
    spring.restLength = 0.01;
    return {spring, uniform(random, 0.9, 1.5) * (state.x[spring.b] - state.x[spring.a]).norm()};
  }
  void add(const Spring& spring, double limit) {
    all.push_back({spring, limit});
    monitor.add(spring, limit);
  }
  void replaceSome(Generator& random) {
    const auto k = whole(random, 0, static_cast<int>(all.size()) - 1);
    all[static_cast<std::size_t>(k)] = anySpring(random);
    monitor.replace(k, all[static_cast<std::size_t>(k)].spring,
                    all[static_cast<std::size_t>(k)].limit);
    const auto gone = whole(random, 0, static_cast<int>(all.size()) - 1);
    all[static_cast<std::size_t>(gone)].limit = kInfinity;
    monitor.remove(gone);
  }
  void addParticle(Generator& random) {
    VertexEdit edit;
    edit.id = static_cast<VertexId>(state.x.size());
    edit.from[0] = whole(random, 0, edit.id - 1);
    state.x.apply(edit);
    monitor.noteEdited(edit.id);
    for (int k = 0; k < 3; ++k) {
      Limited some = anySpring(random);
      some.spring.b = edit.id;
      add(some.spring, some.limit);
    }
  }
  void moveParticle(Generator& random) {
    const VertexId v = whole(random, 0, static_cast<int>(state.x.size()) - 1);
    state.x[v] += randomVector(random, 0.01);
    monitor.noteEdited(v);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const bool ends = all[k].spring.a == v || all[k].spring.b == v;
      if (ends) monitor.addCandidate(static_cast<std::int32_t>(k));
    }
  }
  std::vector<std::int32_t> allBeyondLimit() const {
    std::vector<std::int32_t> found;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto& [spring, limit] = all[k];
      const double length = (state.x[spring.b] - state.x[spring.a]).norm();
      if (length > limit) found.push_back(static_cast<std::int32_t>(k));
    }
    return found;
  }

  Model model;
  State state;
  std::vector<Limited> all;
  SpringLengthMonitor monitor;
};

TEST(SpringLengthMonitor, FindsAllWhileSpringsAndParticlesChange) {
  Generator random(4);
  for (const double distance : {1e-5, 1e-4, 1e-3}) {
    EditedSprings cloth;
    std::size_t found = 0;
    for (int step = 0; step < 300; ++step) {
      for (Vec3& x : cloth.state.x) x += randomVector(random, distance);
      if (step % 3 == 0) cloth.replaceSome(random);
      if (step % 20 == 0) cloth.addParticle(random);
      if (step % 5 == 0) cloth.moveParticle(random);
      const std::vector<std::int32_t> expected = cloth.allBeyondLimit();
      ASSERT_EQ(cloth.monitor.find(cloth.state.x), expected)
          << "distance " << distance << ", step " << step;
      found += expected.size();
    }
    EXPECT_GT(found, 1000U);
  }
}

TEST(SpringLengthMonitor, FindsNoneWithoutSpringsOrWithoutLimits) {
  const Model model = buildModel(clothOf(4, 4, 0.01));
  State state = flatState(model);
  SpringLengthMonitor monitor;
  EXPECT_TRUE(monitor.find(state.x).empty());
  for (const Spring& spring : model.springs.slots()) monitor.add(spring, kInfinity);
  for (int k = 0; k < 20; ++k) monitor.addUnlimited();
  state.x[3].setConstant(1e6);
  EXPECT_TRUE(monitor.find(state.x).empty());
  monitor.clear();
  monitor.add(model.springs[0], 0.0);
  EXPECT_EQ(monitor.find(state.x), std::vector<std::int32_t>{0});
}

TEST(SpringLengthMonitor, ChecksAllIfThereAreFewerThanParticles) {
  const Model model = buildModel(clothOf(4, 4, 0.01));
  State state = flatState(model);
  SpringLengthMonitor monitor;
  const Spring& spring = model.springs[0];
  monitor.add(spring, 1.5 * spring.restLength);
  EXPECT_TRUE(monitor.find(state.x).empty());
  state.x[spring.b] += state.x[spring.b] - state.x[spring.a];
  EXPECT_EQ(monitor.find(state.x), std::vector<std::int32_t>{0});
}

}  // namespace
}  // namespace cloth_sim
