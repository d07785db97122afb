#pragma once
/// \file Calls that may be made until something is gone.

#include <condition_variable>
#include <mutex>

namespace cloth_sim {

/// Lets calls of any thread pass until it is closed. No lock is held while one is under way.
class Gate {
 public:
  /// Calls `body`, unless the gate is closed.
  template <typename Body>
  void pass(const Body& body) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (isClosed_) return;
      ++inside_;
    }
    body();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--inside_ == 0) isEmpty_.notify_all();
  }
  /// Lets no more calls pass, and waits for those under way.
  void close() {
    std::unique_lock<std::mutex> lock(mutex_);
    isClosed_ = true;
    isEmpty_.wait(lock, [this] { return inside_ == 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable isEmpty_;
  bool isClosed_ = false;
  int inside_ = 0;
};

}  // namespace cloth_sim
