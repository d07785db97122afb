#include "study/bisection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace cloth_sim {
namespace {

TEST(BisectLimit, FindsALimitToItsResolution) {
  for (const double limit : {0.03, 1.0, 2.0, 2.0 * M_SQRT2, 999.0}) {
    const Bisection found =
        bisectLimit({0.02, 1000.0, 0.005}, [limit](double value) { return value <= limit; });
    // The limit lies in the last bracket, whose geometric middle is the answer: half of it away.
    EXPECT_NEAR(found.limit / limit, 1.0, 0.0025 + 1e-4);
    // Two ends, then halvings of ln(50000) = 10.8 down to ln(1.005) = 0.005: 2^12 of them.
    EXPECT_LE(found.probes.size(), 14U);
    for (const Probe& probe : found.probes) EXPECT_EQ(probe.holds, probe.value <= limit);
  }
}

TEST(BisectLimit, SaysZeroWhereItNeverHolds) {
  const Bisection found = bisectLimit({0.02, 1000.0, 0.005}, [](double) { return false; });
  EXPECT_EQ(found.limit, 0.0);
  EXPECT_EQ(found.probes.size(), 1U);
}

TEST(BisectLimit, SaysInfinityWhereItAlwaysHolds) {
  const Bisection found = bisectLimit({0.02, 1000.0, 0.005}, [](double) { return true; });
  EXPECT_TRUE(std::isinf(found.limit));
  EXPECT_EQ(found.probes.size(), 2U);
}

TEST(BisectLimit, RefusesWhatIsNoRange) {
  const auto any = [](double) { return true; };
  EXPECT_THROW(bisectLimit({0.0, 1.0, 0.1}, any), std::invalid_argument);
  EXPECT_THROW(bisectLimit({2.0, 1.0, 0.1}, any), std::invalid_argument);
  EXPECT_THROW(bisectLimit({1.0, 2.0, 0.0}, any), std::invalid_argument);
}

}  // namespace
}  // namespace cloth_sim
