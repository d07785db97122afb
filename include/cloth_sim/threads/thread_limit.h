#pragma once
/// \file How many threads the core may use.

namespace cloth_sim {

/// Bounds the threads of the parallel loops of the thread that made it, itself among them, while it
/// lives (1: all loops run in the calling thread); an inner one counts. Without one it is one per
/// processor. Results do not depend on it.
class ThreadLimit {
 public:
  /// \param threads  0: one per processor.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  static int ofThisThread();

 private:
  int before_;
};

}  // namespace cloth_sim
