#include "study/pareto.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(ParetoFront, OfNothingIsEmpty) { EXPECT_THAT(paretoFront({}), IsEmpty()); }

TEST(ParetoFront, KeepsWhatNothingBeatsByAscendingCost) {
  // 3 costs more than 0 for the same error; 4 costs more and errs more than 1.
  EXPECT_THAT(paretoFront({{1.0, 0.5}, {2.0, 0.1}, {4.0, 0.01}, {1.5, 0.5}, {3.0, 0.2}}),
              ElementsAre(0, 1, 2));
}

TEST(ParetoFront, OfEqualCostKeepsTheSmallerError) {
  EXPECT_THAT(paretoFront({{1.0, 0.5}, {1.0, 0.4}}), ElementsAre(1));
}

TEST(ParetoFront, OfEqualPointsKeepsTheFirst) {
  EXPECT_THAT(paretoFront({{1.0, 0.5}, {1.0, 0.5}}), ElementsAre(0));
}

TEST(ParetoFront, LeavesOutWhatIsNoNumber) {
  EXPECT_THAT(paretoFront({{1.0, kNan}, {kNan, 0.1}, {0.5, kInfinity}, {2.0, 0.3}}),
              ElementsAre(3));
}

TEST(ParetoFront, IsExactlyWhatASearchThroughAllPairsFinds) {
  testing_support::Generator random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<CostAndError> points;
    // Few different values, so that there are ties.
    for (int k = 0; k < 12; ++k) {
      points.push_back(
          {1.0 * testing_support::whole(random, 1, 6), 1.0 * testing_support::whole(random, 1, 6)});
    }
    const std::vector<std::size_t> front = paretoFront(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      bool beaten = false;
      for (std::size_t j = 0; j < points.size(); ++j) {
        const bool noWorse = points[j].cost <= points[k].cost && points[j].error <= points[k].error;
        const bool better = points[j].cost < points[k].cost || points[j].error < points[k].error;
        beaten = beaten || (noWorse && (better || j < k));
      }
      EXPECT_EQ(std::count(front.begin(), front.end(), k), beaten ? 0 : 1);
    }
  }
}

}  // namespace
}  // namespace cloth_sim
