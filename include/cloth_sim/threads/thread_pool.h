#pragma once
/// \file Worker threads that spin between the parallel loops of a step.

#include <cstdint>
#include <memory>
#include <vector>

namespace cloth_sim {

/// Tasks of a parallel loop and their dependencies: a directed acyclic graph. Tasks are numbered
/// from 0 and divided into groups of consecutive ones. A task depends on tasks of earlier groups
/// only. Both lists of lists are in compressed form: list k ends at `...Ends[k]` and begins where
/// list k - 1 ends.
struct TaskGraph {
  std::vector<std::int32_t> groupEnds;        ///< tasks, by group
  std::vector<std::int32_t> predecessorEnds;  ///< entries of `predecessors`, by task
  std::vector<std::int32_t> predecessors;     ///< tasks that are complete before a task begins
};

/// Runs parallel loops on the calling thread and worker threads, as many as ThreadLimit allows.
///
/// A step consists of a few dozen loops of tens of microseconds each, and waking a thread takes as
/// long as such a loop. Worker threads are therefore woken once for each ParallelRegion, by its
/// first parallel loop, and spin from then on until the region ends; after some ten microseconds
/// they yield the processor between polls. A loop never waits for a worker thread that is not
/// running: the other threads take over its tasks.
/// docs/decisions/011-own-thread-pool.md compares this with libraries.
class ThreadPool {
 public:
  ThreadPool();
  ~ThreadPool();
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  /// Parallel loops of the current thread run on `pool` for the lifetime of the object. Has no
  /// effect inside another region of the same thread.
  class ParallelRegion {
   public:
    explicit ParallelRegion(ThreadPool& pool);
    ~ParallelRegion();
    ParallelRegion(const ParallelRegion&) = delete;
    ParallelRegion& operator=(const ParallelRegion&) = delete;

   private:
    ThreadPool* pool_;
  };

  /// The pool of the current thread's region. Null outside of a region, inside of a task, and if
  /// the region has one thread only.
  static ThreadPool* ofThisThread();

  /// Threads of the region, the calling one included.
  std::int32_t size() const;
  /// Tasks that worker threads have run since the pool was made, for tests and profiles.
  std::int64_t workerTasks() const;

  /// Runs the task with index `task`.
  using Body = void (*)(const void* context, std::int32_t task);

  /// Calls `body(context, task)` once for each task in [0, tasks) and returns when all calls have
  /// returned. The body must not throw and must not write what another task reads or writes.
  /// Parallel loops inside of a task run in its thread. Every thread has a fixed range of the
  /// tasks, so that its caches keep their data from loop to loop; when it has run those, it steals
  /// from the other threads.
  void run(std::int32_t tasks, Body body, const void* context);
  /// The same for tasks with dependencies. A task may read and write what its predecessors write.
  /// There is no barrier between the groups. In each group a thread first runs the tasks at the
  /// ends of its range, because the other threads are likely to depend on them.
  void run(const TaskGraph& graph, Body body, const void* context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cloth_sim
