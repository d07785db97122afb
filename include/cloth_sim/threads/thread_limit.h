#pragma once
/// \file Limit on the number of threads that the library uses.

namespace cloth_sim {

/// Limits the threads of parallel loops that the current thread starts, for the lifetime of the
/// object. The current thread counts as one of them, so with a limit of 1 loops run in it alone.
/// Limits nest: the innermost holds. Without a limit, loops use one thread per processor. Results
/// do not depend on the limit.
class ThreadLimit {
 public:
  /// \param threads  0: one per processor
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  /// The limit that holds in the current thread, at least 1.
  static int ofThisThread();

 private:
  int before_;
};

}  // namespace cloth_sim
