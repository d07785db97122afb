/// \file Tests of WarningLog, which tells the warnings that are new.

#include "ros/warning_log.h"

#include <gtest/gtest.h>

namespace cloth_sim {
namespace {

TEST(WarningLog, TellsEachDoubtOnceUntilItIsGone) {
  WarningLog log;
  EXPECT_TRUE(log.takeNew({}).empty());
  const std::vector<ResultWarning> first = log.takeNew({{2, "heavier by 0.3"}});
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].text, "heavier by 0.3");
  EXPECT_TRUE(log.takeNew({{2, "heavier by 0.4"}}).empty()) << "other figures, the same doubt";
  const std::vector<ResultWarning> second = log.takeNew({{0, "stretched"}, {2, "heavier by 0.4"}});
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].about, 0U);
  EXPECT_TRUE(log.takeNew({}).empty());
  EXPECT_EQ(log.takeNew({{2, "heavier by 0.3"}}).size(), 1U) << "again, after a reset";
}

}  // namespace
}  // namespace cloth_sim
