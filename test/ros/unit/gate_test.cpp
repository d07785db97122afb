#include "ros/gate.h"  // private: the race that it prevents lasts microseconds

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

namespace cloth_sim {
namespace {

constexpr std::chrono::seconds kDeadline{20};
constexpr std::chrono::milliseconds kMoment{50};

TEST(Gate, LetsCallsPassUntilItIsClosed) {
  Gate gate;
  int calls = 0;
  gate.pass([&] { ++calls; });
  gate.close();
  gate.pass([&] { ++calls; });
  EXPECT_EQ(calls, 1);
}

TEST(Gate, LetsACallPassWithinAnother) {
  Gate gate;
  int calls = 0;
  gate.pass([&] { gate.pass([&] { ++calls; }); });
  gate.close();
  EXPECT_EQ(calls, 1);
}

TEST(Gate, ClosesWhenCallsUnderWayHaveEnded) {
  Gate gate;
  std::promise<void> begun, mayEnd;
  std::atomic<bool> hasEnded = false;
  std::thread caller([&] {
    gate.pass([&] {
      begun.set_value();
      mayEnd.get_future().wait();
      hasEnded = true;
    });
  });
  begun.get_future().wait();
  std::future<bool> closed = std::async(std::launch::async, [&] {
    gate.close();
    return hasEnded.load();
  });
  EXPECT_EQ(closed.wait_for(kMoment), std::future_status::timeout);
  mayEnd.set_value();
  ASSERT_EQ(closed.wait_for(kDeadline), std::future_status::ready);
  EXPECT_TRUE(closed.get());
  caller.join();
}

}  // namespace
}  // namespace cloth_sim
