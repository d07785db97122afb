/// \file Pairs of faces that are not listed do not touch.

#include "contact/pair_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "contact/closest_points.h"

namespace cloth_sim {
namespace {

constexpr int kFaces = 40;

/// Small triangles that wander and drift together.
struct Swarm {
  std::vector<Face> faces;
  std::vector<Vec3> start;
  std::vector<Vec3> end;
  std::vector<double> mass;
  std::vector<VertexId> all;
  std::mt19937 random{3};

  Swarm() : mass(3 * kFaces, 1.0), all(3 * kFaces) {
    std::iota(all.begin(), all.end(), 0);
    for (int f = 0; f < kFaces; ++f) {
      faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
      const Vec3 at = 0.12 * any();
      for (int k = 0; k < 3; ++k) start.push_back(at + 0.02 * any());
    }
    end = start;
  }
  Vec3 any() {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const double x = number(random);
    const double y = number(random);
    return {x, y, number(random)};
  }
  /// A substep in which a few faces move far.
  void move() {
    start = end;
    const Vec3 drift = 0.1 * any();
    for (int f = 0; f < kFaces; ++f) {
      const double length = f % 8 == 0 ? 0.02 : 0.002;
      for (int k = 0; k < 3; ++k) end[3 * f + k] += drift + length * any();
    }
  }
  double apart(const FaceIds& ids) const {
    const auto corners = [&](FaceId f) {
      return Corners{end[3 * f], end[3 * f + 1], end[3 * f + 2]};
    };
    return separate(corners(ids.first), corners(ids.second)).distance;
  }
};

std::vector<FaceIds> allPairs() {
  std::vector<FaceIds> pairs;
  for (FaceId f = 0; f < kFaces; ++f) {
    for (FaceId g = f + 1; g < kFaces; ++g) pairs.push_back({f, g});
  }
  return pairs;
}

/// Number of pairs that are added later, so that boxes are tried on all new pairs or on none.
class Watch : public testing::TestWithParam<std::size_t> {};

TEST_P(Watch, PairsThatAreNotListedAreApart) {
  Swarm swarm;
  PairWatch watch;
  watch.begin(swarm.faces);
  std::vector<FaceIds> pairs = allPairs();
  std::vector<FaceIds> first(pairs.begin(), pairs.end() - static_cast<std::ptrdiff_t>(GetParam()));
  watch.append(first, 0);
  std::size_t listed = 0;
  std::size_t most = 0;
  int touching = 0;
  std::vector<std::uint32_t> due;
  for (int substep = 0; substep < 200; ++substep) {
    if (substep == 5) watch.append(pairs, first.size());
    swarm.move();
    watch.follow({swarm.start, swarm.end, swarm.mass, swarm.all});
    watch.listDue(due);
    EXPECT_TRUE(std::is_sorted(due.begin(), due.end()));
    std::vector<std::uint8_t> isDue(watch.count(), 0);
    for (const std::uint32_t k : due) isDue[k] = 1;
    for (std::size_t k = 0; k < watch.count(); ++k) {
      const double apart = swarm.apart(watch.ids(k));
      if (isDue[k] == 0) {
        ASSERT_GT(apart, 0.0) << "pair " << k << " in substep " << substep;
      } else {
        touching += apart > 0.0 ? 0 : 1;
        watch.setDue(k, std::max(0.0, apart));
      }
    }
    listed += due.size();
    most += watch.count();
  }
  EXPECT_EQ(watch.count(), pairs.size());
  EXPECT_GT(touching, 20) << "the test would say nothing";
  EXPECT_LT(listed, most / 3) << "few are to be looked at";
}

INSTANTIATE_TEST_SUITE_P(AddedLater, Watch, testing::Values(0U, 3U, 400U));

TEST(PairWatch, APairThatMayTouchIsListedAgain) {
  Swarm swarm;
  PairWatch watch;
  watch.begin(swarm.faces);
  watch.append({{0, 1}}, 0);
  std::vector<std::uint32_t> due;
  swarm.end = swarm.start;
  for (int substep = 0; substep < 3; ++substep) {
    watch.follow({swarm.start, swarm.end, swarm.mass, swarm.all});
    watch.listDue(due);
    ASSERT_EQ(due.size(), 1U);
    watch.setDue(0, 0.0);
  }
  watch.clear();
  EXPECT_EQ(watch.count(), 0U);
  watch.listDue(due);
  EXPECT_TRUE(due.empty());
}

/// Two faces with a common corner move far together, away from a third one.
TEST(PairWatch, FacesWithACommonCornerAreDueByTheChangesOfTheirEdges) {
  const std::vector<Face> faces{{0, 1, 2}, {0, 3, 4}, {5, 6, 7}};
  const std::vector<VertexId> all{0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<double> mass(8, 1.0);
  std::vector<Vec3> start(8, Vec3::Zero());
  std::vector<Vec3> end = start;
  PairWatch watch;
  watch.begin(faces);
  watch.append({{0, 1}, {0, 2}}, 0);
  std::vector<std::uint32_t> due;
  const auto listAfter = [&](const Vec3& together, double change) {
    start = end;
    for (VertexId v = 0; v < 5; ++v) end[v] += together;
    end[1].z() += change;
    watch.follow({start, end, mass, all});
    watch.listDue(due);
    return due;
  };
  EXPECT_EQ(listAfter(Vec3::Zero(), 0.0), (std::vector<std::uint32_t>{0, 1}));
  watch.setDue(0, 0.1);
  watch.setDue(1, 0.1);
  EXPECT_EQ(listAfter(Vec3::UnitX(), 0.0), std::vector<std::uint32_t>{1});
  watch.setDue(1, 100.0);
  EXPECT_EQ(listAfter(Vec3::UnitX(), 0.06), std::vector<std::uint32_t>{});
  EXPECT_EQ(listAfter(Vec3::UnitX(), 0.06), std::vector<std::uint32_t>{0});
}

}  // namespace
}  // namespace cloth_sim
