#pragma once
/// \file How many threads the core may use.

namespace cloth_sim {

/// Bounds the threads of the parallel loops of the thread that made it, itself among them, while it
/// lives (1: all loops run in the calling thread); an inner one counts. Without one: processors().
/// Results do not depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  static int ofThisThread();
  /// That this thread may run on, as `taskset` has it.
  static int processors();

 private:
  int before_;
};

}  // namespace cloth_sim
