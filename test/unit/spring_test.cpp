/// \file Compact storage of springs: slots return what was stored, and equal springs share a type.

#include "cloth_sim/cloth/spring.h"

#include <gtest/gtest.h>

#include <sstream>

#include "constraints/spring_parameters.h"
#include "sim/archive.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// Draws a spring of one of a few types, one of a type of its own, or an empty one.
Spring randomSpring(Generator& random) {
  Spring spring;
  if (random() % 5 == 0) return spring;
  spring.a = whole(random, 0, 99);
  spring.b = whole(random, 0, 99);
  spring.kind = static_cast<SpringKind>(random() % 3);
  spring.direction = static_cast<ThreadDirection>(random() % 3);
  spring.support = {whole(random, 0, 99), random() % 2 == 0 ? kNone : whole(random, 0, 99)};
  const bool usual = random() % 2 == 0;
  spring.restLength = usual ? 0.1 : uniform(random, 0.05, 0.2);
  spring.stiffness =
      usual ? 100.0 * static_cast<double>(random() % 3) : uniform(random, 0.0, 300.0);
  spring.damping = random() % 3 == 0 ? 0.01 : 0.0;
  return spring;
}

TEST(SpringSlots, HoldWhatWasPutThere) {
  Generator random(5);
  SpringSlots slots;
  std::vector<Spring> expected;
  for (int change = 0; change < 20000; ++change) {
    const Spring spring = randomSpring(random);
    if (expected.empty() || (expected.size() < 3000 && random() % 3 == 0)) {
      slots.append(spring);
      expected.push_back(spring);
    } else {
      const int slot = whole(random, 0, static_cast<int>(expected.size()) - 1);
      slots.set(slot, spring);
      expected[static_cast<std::size_t>(slot)] = spring;
    }
  }
  EXPECT_TRUE(std::vector<Spring>(slots) == expected);
  std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
  StateWriter writer(file);
  writer(slots);
  SpringSlots read;
  StateReader reader(file.str());
  reader(read);
  EXPECT_TRUE(std::vector<Spring>(read) == expected);
}

TEST(SpringParameterTable, HaveDampingFromTheFirstDashpotOn) {
  SpringParameterTable parameters;
  parameters.append({0.1, 20.0, 0.0});
  EXPECT_FALSE(parameters.damped());
  EXPECT_TRUE(parameters.damping().empty());
  parameters.append({0.2, 30.0, 0.5});
  parameters.append({0.3, 40.0, 0.0});
  EXPECT_TRUE(parameters.damped());
  EXPECT_TRUE((parameters[0] == SpringParameters{0.1, 20.0, 0.0}));
  EXPECT_TRUE((parameters[1] == SpringParameters{0.2, 30.0, 0.5}));
  EXPECT_TRUE((parameters[2] == SpringParameters{0.3, 40.0, 0.0}));
  parameters.set(1, {0.2, 30.0, 0.0});
  EXPECT_TRUE((parameters[1] == SpringParameters{0.2, 30.0, 0.0}));
  parameters.resize(1);
  EXPECT_EQ(parameters.damping().size(), 1U);
}

}  // namespace
}  // namespace cloth_sim
