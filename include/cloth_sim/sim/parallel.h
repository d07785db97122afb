#pragma once
/// \file How many threads the core may use.

#include <memory>

namespace cloth_sim {

/// Bounds the threads of every parallel loop of this process while it lives (1: all loops run in
/// the calling thread). Results do not depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cloth_sim
