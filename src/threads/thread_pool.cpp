#include "cloth_sim/threads/thread_pool.h"

#if defined(__x86_64__) || defined(__i386__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "cloth_sim/threads/thread_limit.h"

namespace cloth_sim {
namespace {

/// Threads of a region; a step does not gain from more.
constexpr std::int32_t kMaxThreads = 16;
/// Polls of a spin wait before it yields the processor: some ten microseconds.
constexpr int kSpins = 500;

/// Memory that different threads write lies in different cache lines.
constexpr std::size_t kCacheLine = 64;

thread_local ThreadPool* poolOfThisThread = nullptr;
/// Tasks that this thread has run, in any pool.
thread_local std::int64_t tasksOfThisThread = 0;

/// Tells the processor that this is a spin wait.
void pauseProcessor() {
#if defined(__x86_64__) || defined(__i386__)
  _mm_pause();
#endif
}

}  // namespace

/// The parts of the pool. Members of ThreadPool::Impl need types with linkage where several files
/// are compiled together.
namespace thread_pool_parts {

/// Back-off of a spin wait: pauses at first, yields the processor from kSpins polls on.
class Backoff {
 public:
  void wait() { ++polls_ < kSpins ? pauseProcessor() : std::this_thread::yield(); }
  void reset() { polls_ = 0; }

 private:
  int polls_ = 0;
};

/// Number of a loop since the pool was made, from 1 on.
using Epoch = std::uint64_t;

/// State of the tasks with one index in successive loops: 2 e once the task has been claimed in the
/// loop of epoch e, 2 e + 1 once it is complete. As epochs ascend, a new loop resets nothing.
class alignas(kCacheLine) TaskState {
 public:
  bool isClaimed(Epoch epoch) const { return word_.load(std::memory_order_relaxed) >= 2 * epoch; }
  bool isComplete(Epoch epoch) const { return word_.load(std::memory_order_acquire) > 2 * epoch; }
  /// \return false if another thread has claimed the task.
  bool claim(Epoch epoch) {
    std::uint64_t before = word_.load(std::memory_order_relaxed);
    return before < 2 * epoch &&
           word_.compare_exchange_strong(before, 2 * epoch, std::memory_order_relaxed);
  }
  void setComplete(Epoch epoch) { word_.store(2 * epoch + 1, std::memory_order_release); }

 private:
  std::atomic<std::uint64_t> word_{0};
};

/// Publishes a loop to the worker threads and counts those that are running it. One word holds the
/// epoch, whether the loop is open, and the count (from high to low bits), so that a worker enters
/// with one atomic addition. The loop must not change or go while a worker is inside.
class alignas(kCacheLine) LoopGate {
 public:
  /// Begins the next epoch: everything written before is visible to those who enter.
  void open() { word_.fetch_add(kEpoch + kOpen, std::memory_order_release); }
  /// Lets no more workers enter and waits until all have left.
  void close() {
    word_.fetch_sub(kOpen, std::memory_order_relaxed);
    Backoff backoff;
    while (word_.load(std::memory_order_acquire) % kOpen > 0) backoff.wait();
  }
  /// \return the epoch of the open loop; 0 if none is open, or only that of epoch `last`. A worker
  ///         that gets an epoch has to leave().
  Epoch tryEnter(Epoch last) {
    const Word before = word_.load(std::memory_order_relaxed);
    if (!isOpen(before) || before / kEpoch == last) return 0;
    const Word entered = word_.fetch_add(1, std::memory_order_acquire);
    if (isOpen(entered)) return entered / kEpoch;
    leave();
    return 0;
  }
  void leave() { word_.fetch_sub(1, std::memory_order_release); }
  std::int32_t workersInside() const {
    return static_cast<std::int32_t>(word_.load(std::memory_order_relaxed) % kOpen);
  }
  /// Returns the epoch now. To be called only by the thread that opens and closes the gate.
  Epoch epoch() const { return word_.load(std::memory_order_relaxed) / kEpoch; }

 private:
  using Word = std::uint64_t;
  static constexpr Word kOpen = Word{1} << 15;
  static constexpr Word kEpoch = Word{1} << 16;

  static bool isOpen(Word word) { return word / kOpen % 2 == 1; }

  std::atomic<Word> word_{0};
};

}  // namespace thread_pool_parts

using namespace thread_pool_parts;

/// Thread 0 is the one that calls the loops; the others are worker threads.
struct ThreadPool::Impl {
  struct Loop {
    const std::int32_t* groupEnds = nullptr;
    std::int32_t groups = 0;
    const TaskGraph* graph = nullptr;  ///< null: independent tasks
    Body body = nullptr;
    const void* context = nullptr;
  };

  ~Impl();

  void beginRegion();
  void endRegion();
  void run(const Loop& next, std::int32_t tasks);

  std::int32_t threads = 1;                  ///< of the region
  std::atomic<std::int64_t> workerTasks{0};  ///< run by worker threads since the pool was made

 private:
  void wakeWorkers();
  void workerMain(std::int32_t thread);
  void runLoopsOfRegion(std::int32_t thread);
  void runLoop(std::int32_t thread, Epoch epoch);
  void runTasksOf(std::int32_t owner, bool isStealing, Epoch epoch);
  void runTask(std::int32_t task, Epoch epoch);
  void runPredecessors(std::int32_t task, Epoch epoch);
  template <typename Condition>
  void spinWhileAllRun(const Condition& isOver) const;

  Loop loop_;
  std::vector<TaskState> states_;  ///< by task
  LoopGate gate_;
  /// Threads that have run or tried to run all tasks of their own range.
  alignas(kCacheLine) std::atomic<std::int32_t> threadsDone_{0};
  alignas(kCacheLine) std::atomic<bool> isRegionOver_{false};
  std::atomic<std::int32_t> workersAwake_{0};
  bool hasWokenWorkers_ = false;  ///< in this region

  std::mutex mutex_;
  std::condition_variable wake_;
  std::int64_t regions_ = 0;  ///< that have woken workers; guarded by mutex_
  bool mayJoin_ = false;      ///< workers may join the region; guarded by mutex_
  bool isDestroyed_ = false;  ///< workers return; guarded by mutex_
  std::vector<std::thread> workers_;
};

ThreadPool::Impl::~Impl() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    isDestroyed_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::Impl::beginRegion() {
  threads = std::min(ThreadLimit::ofThisThread(), kMaxThreads);
  isRegionOver_.store(false, std::memory_order_relaxed);
}

/// Waits for the workers that have joined, but not for those that are still waking up.
void ThreadPool::Impl::endRegion() {
  if (!hasWokenWorkers_) return;
  hasWokenWorkers_ = false;
  isRegionOver_.store(true, std::memory_order_release);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    mayJoin_ = false;
  }
  Backoff backoff;
  while (workersAwake_.load(std::memory_order_acquire) > 0) backoff.wait();
}

/// Runs a loop in the calling thread and in the workers that are awake.
void ThreadPool::Impl::run(const Loop& next, std::int32_t tasks) {
  if (!hasWokenWorkers_) wakeWorkers();
  if (states_.size() < static_cast<std::size_t>(tasks)) {
    states_ = std::vector<TaskState>(static_cast<std::size_t>(tasks));
  }
  loop_ = next;
  threadsDone_.store(0, std::memory_order_relaxed);
  gate_.open();
  runLoop(0, gate_.epoch());
  gate_.close();
}

void ThreadPool::Impl::wakeWorkers() {
  hasWokenWorkers_ = true;
  for (auto thread = static_cast<std::int32_t>(workers_.size()) + 1; thread < threads; ++thread) {
    workers_.emplace_back([this, thread] { workerMain(thread); });
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    mayJoin_ = true;
    ++regions_;
  }
  wake_.notify_all();
}

/// Sleeps between regions. Joins each region at most once, if its limit admits this thread.
void ThreadPool::Impl::workerMain(std::int32_t thread) {
  std::int64_t lastRegion = 0;
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] {
      return isDestroyed_ || (mayJoin_ && regions_ != lastRegion && thread < threads);
    });
    if (isDestroyed_) return;
    lastRegion = regions_;
    workersAwake_.fetch_add(1, std::memory_order_relaxed);
    lock.unlock();
    runLoopsOfRegion(thread);
    workersAwake_.fetch_sub(1, std::memory_order_release);
    lock.lock();
  }
}

/// Spins for loops until the region ends.
void ThreadPool::Impl::runLoopsOfRegion(std::int32_t thread) {
  Backoff backoff;
  Epoch last = 0;
  while (!isRegionOver_.load(std::memory_order_acquire)) {
    const Epoch epoch = gate_.tryEnter(last);
    if (epoch == 0) {
      backoff.wait();
      continue;
    }
    const std::int64_t before = tasksOfThisThread;
    runLoop(thread, epoch);
    workerTasks.fetch_add(tasksOfThisThread - before, std::memory_order_relaxed);
    gate_.leave();
    last = epoch;
    backoff.reset();
  }
}

/// Runs the tasks in the thread's own range, then steals those that are left of the others. Tasks
/// of a graph are stolen only after a while: the owner is likely to start them soon, and to fetch
/// their data from its cache takes longer than to wait.
void ThreadPool::Impl::runLoop(std::int32_t thread, Epoch epoch) {
  runTasksOf(thread, false, epoch);
  threadsDone_.fetch_add(1, std::memory_order_relaxed);
  const auto isDone = [&] { return threadsDone_.load(std::memory_order_relaxed) == threads; };
  if (loop_.graph != nullptr) spinWhileAllRun(isDone);
  if (isDone()) return;
  for (std::int32_t k = 1; k < threads; ++k) runTasksOf((thread + k) % threads, true, epoch);
}

/// Spins for at most kSpins polls until `isOver()`, as long as all threads are running the loop.
template <typename Condition>
void ThreadPool::Impl::spinWhileAllRun(const Condition& isOver) const {
  for (int polls = 0; polls < kSpins && !isOver() && gate_.workersInside() == threads - 1;
       ++polls) {
    pauseProcessor();
  }
}

/// Runs the tasks in the range of a thread, its equal part of each group: first the two at the
/// ends, then the others in ascending order. A thief goes through each group in reverse, to meet
/// the owner late.
void ThreadPool::Impl::runTasksOf(std::int32_t owner, bool isStealing, Epoch epoch) {
  std::int32_t first = 0;
  for (std::int32_t group = 0; group < loop_.groups; ++group) {
    const std::int32_t tasks = loop_.groupEnds[group] - first;
    const auto rangeBegin = [&](std::int32_t thread) {
      return first + (tasks * thread + threads - 1) / threads;
    };
    const std::int32_t begin = rangeBegin(owner);
    const std::int32_t count = rangeBegin(owner + 1) - begin;
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t turn = isStealing ? count - 1 - k : k;
      const std::int32_t offset = turn == 1 ? count - 1 : std::max(0, turn - 1);
      runTask(begin + offset, epoch);
    }
    first = loop_.groupEnds[group];
  }
}

/// Runs a task after its predecessors, unless another thread has claimed it.
void ThreadPool::Impl::runTask(std::int32_t task, Epoch epoch) {
  TaskState& state = states_[static_cast<std::size_t>(task)];
  if (state.isClaimed(epoch)) return;
  if (loop_.graph != nullptr) runPredecessors(task, epoch);
  if (!state.claim(epoch)) return;
  loop_.body(loop_.context, task);
  ++tasksOfThisThread;
  state.setComplete(epoch);
}

/// Returns when all predecessors are complete; runs those that no thread has claimed.
void ThreadPool::Impl::runPredecessors(std::int32_t task, Epoch epoch) {
  const TaskGraph& graph = *loop_.graph;
  const std::int32_t begin = task == 0 ? 0 : graph.predecessorEnds[task - 1];
  for (std::int32_t k = begin; k < graph.predecessorEnds[task]; ++k) {
    const std::int32_t predecessor = graph.predecessors[k];
    const TaskState& state = states_[static_cast<std::size_t>(predecessor)];
    spinWhileAllRun([&] { return state.isClaimed(epoch); });
    runTask(predecessor, epoch);
    Backoff backoff;
    while (!state.isComplete(epoch)) backoff.wait();
  }
}

ThreadPool::ThreadPool() : impl_(std::make_unique<Impl>()) {}
ThreadPool::~ThreadPool() = default;
ThreadPool::ThreadPool(ThreadPool&&) noexcept = default;
ThreadPool& ThreadPool::operator=(ThreadPool&&) noexcept = default;

ThreadPool* ThreadPool::ofThisThread() {
  return poolOfThisThread != nullptr && poolOfThisThread->size() > 1 ? poolOfThisThread : nullptr;
}

std::int32_t ThreadPool::size() const { return impl_->threads; }

std::int64_t ThreadPool::workerTasks() const {
  return impl_->workerTasks.load(std::memory_order_relaxed);
}

void ThreadPool::run(std::int32_t tasks, Body body, const void* context) {
  poolOfThisThread = nullptr;
  impl_->run({&tasks, 1, nullptr, body, context}, tasks);
  poolOfThisThread = this;
}

void ThreadPool::run(const TaskGraph& graph, Body body, const void* context) {
  poolOfThisThread = nullptr;
  impl_->run({graph.groupEnds.data(), static_cast<std::int32_t>(graph.groupEnds.size()), &graph,
              body, context},
             graph.groupEnds.back());
  poolOfThisThread = this;
}

ThreadPool::ParallelRegion::ParallelRegion(ThreadPool& pool)
    : pool_(poolOfThisThread == nullptr ? &pool : nullptr) {
  if (pool_ == nullptr) return;
  pool_->impl_->beginRegion();
  poolOfThisThread = pool_;
}

ThreadPool::ParallelRegion::~ParallelRegion() {
  if (pool_ == nullptr) return;
  poolOfThisThread = nullptr;
  pool_->impl_->endRegion();
}

}  // namespace cloth_sim
