/// \file Random operations with steps in between, with every method. Needs no RapidCheck, so that
/// it runs everywhere; property_test.cpp draws more sequences, and shrinks those that fail.

#include <gtest/gtest.h>

#include "surgery/cloth_fixture.h"

namespace cloth_sim {
namespace {

using namespace surgery_support;

ClothCase drawCloth(Generator& random) {
  ClothCase cloth;
  cloth.columns = whole(random, 4, 8);
  cloth.rows = whole(random, 4, 8);
  cloth.aspect = whole(random, 6, 15);
  cloth.shake = 10 * whole(random, 0, 2);
  cloth.crumple = whole(random, 0, 1);
  cloth.heldRadius = whole(random, -1, 1);
  cloth.shear = random() % 4 != 0;
  cloth.bend = random() % 4 != 0;
  cloth.raw = random() % 4 == 0;
  cloth.ownMasses = random() % 4 == 0;
  cloth.seed = whole(random, 0, 999);
  return cloth;
}

Operation drawOperation(Generator& random) {
  Operation operation;
  operation.kind = static_cast<Kind>(whole(random, 0, 4));
  for (int k = whole(random, 2, 5); k > 0; --k) {
    operation.path.push_back({whole(random, -3, 32), whole(random, -3, 32)});
  }
  operation.skew = whole(random, -2, 2);
  operation.onVertices = random() % 4 == 0;
  operation.closed = random() % 3 == 0;
  operation.option = random() % 3 == 0;
  operation.size = whole(random, 1, 6);
  operation.generations = random() % 3 == 0 ? whole(random, 1, 3) : 0;
  return operation;
}

class RandomEdits : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Seeds, RandomEdits, testing::Range(1, 9));

TEST_P(RandomEdits, KeepWhatMustBeKeptWhileTheClothMoves) {
  Generator random(static_cast<std::uint64_t>(GetParam()));
  for (int sequence = 0; sequence < 25; ++sequence) {
    const ClothCase cloth = drawCloth(random);
    ClothFixture fixture(cloth, true);
    std::ostringstream done;
    for (int edit = whole(random, 2, 6); edit > 0; --edit) {
      const Operation operation = drawOperation(random);
      done << "\n" << operation;
      ASSERT_EQ(fixture.operate(operation), "") << cloth << done.str();
      ASSERT_EQ(fixture.step(whole(random, 0, 2)), "") << cloth << done.str();
    }
  }
}

}  // namespace
}  // namespace cloth_sim
