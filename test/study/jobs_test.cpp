#include "study/jobs.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>

namespace cloth_sim {
namespace {

TEST(RunJobs, DoesEachJobOnce) {
  for (const int threads : {1, 3, 64}) {
    std::vector<std::atomic<int>> done(20);
    Jobs jobs;
    for (std::atomic<int>& count : done) jobs.emplace_back([&count] { ++count; });
    runJobs(jobs, threads);
    for (const std::atomic<int>& count : done) EXPECT_EQ(count, 1) << threads;
  }
}

TEST(RunJobs, OfOneThreadKeepsTheOrder) {
  std::vector<int> order;
  Jobs jobs;
  for (int k = 0; k < 5; ++k) jobs.emplace_back([&order, k] { order.push_back(k); });
  runJobs(jobs, 1);
  EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 3, 4));
}

TEST(RunJobs, PassesOnWhatAJobThrowsAndBeginsNoMore) {
  std::atomic<int> done{0};
  const Jobs jobs{[&] { ++done; }, [] { throw std::runtime_error("no"); }, [&] { ++done; }};
  EXPECT_THROW(runJobs(jobs, 1), std::runtime_error);
  EXPECT_EQ(done, 1);
  EXPECT_THROW(runJobs(jobs, 3), std::runtime_error);
}

}  // namespace
}  // namespace cloth_sim
