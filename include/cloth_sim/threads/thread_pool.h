#pragma once
/// \file Threads that stay at hand for as long as a step takes.

#include <cstdint>
#include <memory>
#include <vector>

namespace cloth_sim {

/// Which parts of a loop wait for which others.
struct TaskGraph {
  /// By group of consecutive parts, none of which waits for one of its own group: the end of it.
  std::vector<std::int32_t> groupEnds;
  /// By part: the end of its list in `waits`, which begins where that of the part before it ends.
  std::vector<std::int32_t> waitEnds;
  std::vector<std::int32_t> waits;  ///< parts of earlier groups
};

/// During its shifts, parallel loops of the thread that began the shift are shared with helpers, at
/// most as many as ThreadLimit allows. A step is a few dozen loops of tens of microseconds each,
/// and to wake a thread takes as long: so helpers are called once a shift, by the first loop that
/// is worth it, and then wait for the next loop without going to sleep (after some microseconds
/// they let others run first). A loop does not wait for helpers: who is not there gets nothing to
/// do.
///
/// See docs/decisions/011.
class ThreadPool {
 public:
  ThreadPool();
  ~ThreadPool();
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  /// While it lives, `pool` helps this thread; nothing happens if another one does already.
  class ParallelRegion {
   public:
    explicit ParallelRegion(ThreadPool& pool);
    ~ParallelRegion();
    ParallelRegion(const ParallelRegion&) = delete;
    ParallelRegion& operator=(const ParallelRegion&) = delete;

   private:
    ThreadPool* pool_;
  };

  /// That which helps this thread, or null: also where there are no helpers.
  static ThreadPool* ofThisThread();

  /// Helpers that the shift may have, and the thread itself.
  std::int32_t size() const;

  /// The part `part` of a loop's `parts`.
  using Body = void (*)(const void* context, std::int32_t part);

  /// Calls `body(context, part)` for each part in [0, parts), which must not throw and must write
  /// nothing that another part reads; loops in it are not shared. Each member begins with parts of
  /// its own, which are the same in every loop of as many parts, and then takes what is left of
  /// others'.
  void run(std::int32_t parts, Body body, const void* context);
  /// The same where a part is called after those that it waits for, and may read and write what
  /// they write. Members do not wait for each other between groups: of its parts of a group each
  /// does those first that others may wait for, the ones at the ends.
  void run(const TaskGraph& order, Body body, const void* context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cloth_sim
