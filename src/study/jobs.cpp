#include "jobs.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace cloth_sim {
namespace {

/// The jobs and the next one to run, for all threads.
class Queue {
 public:
  explicit Queue(const Jobs& jobs) : jobs_(jobs) {}

  void work() {
    while (true) {
      const std::size_t k = next_++;
      if (k >= jobs_.size()) return;
      try {
        jobs_[k]();
      } catch (...) {
        stop(std::current_exception());
      }
    }
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void stop(std::exception_ptr failure) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
    next_ = jobs_.size();
  }

  const Jobs& jobs_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;
  std::exception_ptr failure_;  ///< guarded by `mutex_` while threads run
};

}  // namespace

void runJobs(const Jobs& jobs, int threads) {
  Queue queue(jobs);
  const auto others = static_cast<std::size_t>(std::max(threads, 1)) - 1;
  std::vector<std::thread> pool;
  for (std::size_t k = 0; k < std::min(others, jobs.size()); ++k) {
    pool.emplace_back([&queue] { queue.work(); });
  }
  queue.work();
  for (std::thread& thread : pool) thread.join();
  queue.rethrow();
}

}  // namespace cloth_sim
