/// \file The certificate that faces do not pass through each other, and the set of their pairs.

#include "contact/face_pairs.h"

#include <gtest/gtest.h>

#include <vector>

#include "contact/face_pair_set.h"
#include "layer_support.h"

namespace cloth_sim {
namespace {

/// Two triangles that move from a place where they are apart to any other one.
struct MovingPair {
  std::vector<Vec3> start;
  std::vector<Vec3> end;
  Face a{0, 1, 2};
  Face b{3, 4, 5};
};

MovingPair movingPair(int shared, RandomPoints& random) {
  MovingPair pair;
  for (int k = 0; k < shared; ++k) pair.b[k] = pair.a[k];
  do {
    pair.start.clear();
    for (int v = 0; v < 6; ++v) pair.start.push_back(random.point());
  } while (!areApart(pair.a, pair.b, pair.start));
  pair.end = pair.start;
  for (Vec3& x : pair.end) x += 1.5 * random.point();
  return pair;
}

/// No vertex is stopped by an obstacle or a holder.
const std::vector<std::uint8_t> kNobody(6, 0);

class Certificate : public testing::TestWithParam<int> {};

TEST_P(Certificate, FacesDoNotMeetAtAnyTimeOfTheSubstep) {
  RandomPoints random(5);
  int changed = 0;
  for (int k = 0; k < 1500; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    std::vector<double> mass(6, 1.0);
    if (k % 3 == 0) mass[0] = 0.0;
    std::vector<std::uint8_t> truncated(6, 0);
    const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
    const std::vector<Vec3> wanted = pair.end;
    const PairOutcome outcome =
        pairs.keepApart({{pair.start, pair.end, mass, all}, truncated, kNobody});
    EXPECT_EQ(outcome.unproven, 0);
    changed += outcome.changed ? 1 : 0;
    if (!outcome.changed) {
      EXPECT_EQ(pair.end, wanted);
    }
    std::vector<Vec3> x(6);
    for (int part = 0; part <= 64; ++part) {
      const double t = part / 64.0;
      for (int v = 0; v < 6; ++v) x[v] = (1.0 - t) * pair.start[v] + t * pair.end[v];
      ASSERT_FALSE(meet(pair.a, pair.b, x)) << k << " at " << t;
    }
  }
  EXPECT_GT(changed, 100);
  EXPECT_LT(changed, 1500);
}

/// Faces that would part far, but whose motion is taken back, have not parted.
TEST_P(Certificate, MotionThatIsTakenBackDoesNotCount) {
  RandomPoints random(8);
  const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
  const std::vector<double> mass(6, 1.0);
  int changed = 0;
  for (int k = 0; k < 300; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    std::vector<std::uint8_t> truncated(6, 0);
    const std::vector<Vec3> wanted = pair.end;
    Vec3 fromBToA = Vec3::Zero();
    for (int v = 0; v < 3; ++v) fromBToA += pair.start[pair.a[v]] - pair.start[pair.b[v]];
    pair.end = pair.start;
    for (int v = GetParam(); v < 3; ++v) pair.end[pair.a[v]] += 100.0 * fromBToA.normalized();
    pairs.keepApart({{pair.start, pair.end, mass, all}, truncated, kNobody});
    pairs.stop({{pair.start, pair.end, mass, all}, truncated, kNobody});
    EXPECT_EQ(pair.end, pair.start);
    pair.end = wanted;
    changed +=
        pairs.keepApart({{pair.start, pair.end, mass, all}, truncated, kNobody}).changed ? 1 : 0;
    ASSERT_FALSE(meet(pair.a, pair.b, pair.end)) << k;
  }
  EXPECT_GT(changed, 20);
}

/// Corners that are held and pressed together for many substeps, and are then carried on. Without a
/// least distance they approach by a part of what is left in each substep, until round-off hides
/// the direction between them, and the pair stays where it is for ever.
TEST_P(Certificate, FacesThatArePressedTogetherCanBeToldApartForEver) {
  RandomPoints random(7);
  const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
  std::vector<std::uint8_t> truncated(6, 0);
  for (int k = 0; k < 20; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    const std::vector<double> held(6, 0.0);
    for (int substep = 0; substep < 200; ++substep) {
      Vec3 fromBToA = Vec3::Zero();
      for (int v = 0; v < 3; ++v) fromBToA += pair.start[pair.a[v]] - pair.start[pair.b[v]];
      const Vec3 push = 0.02 * fromBToA.normalized();
      for (int v = GetParam(); v < 3; ++v) {
        pair.end[pair.a[v]] = pair.start[pair.a[v]] - push;
        pair.end[pair.b[v]] = pair.start[pair.b[v]] + push;
      }
      const PairOutcome outcome =
          pairs.keepApart({{pair.start, pair.end, held, all}, truncated, kNobody});
      ASSERT_EQ(outcome.unproven, 0) << k << " in " << substep;
      ASSERT_FALSE(meet(pair.a, pair.b, pair.end)) << k << " in " << substep;
      pair.start = pair.end;
    }
    for (Vec3& x : pair.end) x.x() += 1.0;
    const std::vector<Vec3> wanted = pair.end;
    const std::vector<double> mass(6, 1.0);
    pairs.keepApart({{pair.start, pair.end, mass, all}, truncated, kNobody});
    for (const VertexId v : all) EXPECT_NEAR(pair.end[v].x(), wanted[v].x(), 1e-6) << k;
  }
}

/// Corners wander by little in each substep, so that a pair is looked at now and then only.
TEST_P(Certificate, FacesThatWanderForManySubstepsDoNotMeet) {
  RandomPoints random(9);
  const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
  const std::vector<double> mass(6, 1.0);
  std::vector<std::uint8_t> truncated(6, 0);
  int changed = 0;
  for (int k = 0; k < 300; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    for (int substep = 0; substep < 100; ++substep) {
      for (const VertexId v : all) pair.end[v] = pair.start[v] + 0.1 * random.point();
      const PairOutcome outcome =
          pairs.keepApart({{pair.start, pair.end, mass, all}, truncated, kNobody});
      ASSERT_EQ(outcome.unproven, 0) << k << " in " << substep;
      changed += outcome.changed ? 1 : 0;
      ASSERT_FALSE(meet(pair.a, pair.b, pair.end)) << k << " in " << substep;
      pair.start = pair.end;
    }
  }
  EXPECT_GT(changed, 100);
  EXPECT_LT(changed, 15000);
}

INSTANTIATE_TEST_SUITE_P(SharedCorners, Certificate, testing::Values(0, 1, 2));

/// A clamp pulls a corner of a fold that is pressed flat. If all stayed where it is, it would do so
/// in each substep.
TEST(FacePairs, AFoldGivesWayToACornerThatIsHeld) {
  const std::vector<Face> faces{{0, 1, 2}, {0, 3, 4}};
  const std::vector<VertexId> all{0, 1, 2, 3, 4};
  const std::vector<double> mass{1.0, 1.0, 0.0, 1.0, 1.0};
  RandomPoints random(3);
  int folds = 0;
  int stopped = 0;
  while (folds < 500) {
    std::vector<Vec3> start(5);
    for (Vec3& x : start) x = 5e-3 * random.point().cwiseProduct(Vec3(1.0, 1.0, 2e-5));
    if (!areApart(faces[0], faces[1], start)) continue;
    ++folds;
    std::vector<Vec3> end = start;
    end[2] += 1e-5 * random.point();
    const Vec3 wanted = end[2];
    std::vector<std::uint8_t> truncated(5, 0);
    FacePairs pairs;
    pairs.assign({{0, 1}}, faces, 1e-4);
    pairs.keepApart({{start, end, mass, all}, truncated, kNobody});
    if ((end[2] - wanted).norm() > 0.5 * (wanted - start[2]).norm()) ++stopped;
  }
  EXPECT_LT(stopped, 5);  // 12, where the common corner never moved
}

TEST(FacePairSet, KnowsWhatWasInserted) {
  FacePairSet pairs;
  pairs.clear(10);
  EXPECT_TRUE(pairs.isEmpty());
  EXPECT_TRUE(pairs.insert({1, 2}));
  EXPECT_TRUE(pairs.insert({1, 3}));
  EXPECT_TRUE(pairs.insert({2, 3}));
  EXPECT_FALSE(pairs.insert({1, 2}));
  EXPECT_FALSE(pairs.isEmpty());
  pairs.clear(10);
  EXPECT_TRUE(pairs.insert({1, 2}));
}

}  // namespace
}  // namespace cloth_sim
