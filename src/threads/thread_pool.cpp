#include "cloth_sim/threads/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "cloth_sim/threads/thread_limit.h"

namespace cloth_sim {
namespace {

/// A step does not gain from more.
constexpr std::int32_t kMostMembers = 16;
/// Looks at what is new before others may run: some ten microseconds.
constexpr int kPatience = 500;

thread_local ThreadPool* poolOfThisThread = nullptr;

void rest() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Waits without sleeping, at first for no one.
class Wait {
 public:
  void once() { ++looks_ < kPatience ? rest() : std::this_thread::yield(); }
  void beginAgain() { looks_ = 0; }

 private:
  int looks_ = 0;
};

}  // namespace

struct ThreadPool::Impl {
  struct Loop {
    const std::int32_t* groupEnds = nullptr;
    std::int32_t groups = 0;
    const TaskGraph* order = nullptr;  ///< null: no part waits
    Body body = nullptr;
    const void* context = nullptr;
  };

  /// Whether someone does a part of a loop, or has done it: by the number of the loop, so that
  /// nobody has to clear it. Alone in its cache line.
  class alignas(64) Mark {
   public:
    bool isTaken(std::uint64_t loop) const {
      return word_.load(std::memory_order_relaxed) >= 2 * loop;
    }
    bool isDone(std::uint64_t loop) const {
      return word_.load(std::memory_order_acquire) > 2 * loop;
    }
    /// \return false if someone else has.
    bool take(std::uint64_t loop) {
      std::uint64_t before = word_.load(std::memory_order_relaxed);
      return before < 2 * loop &&
             word_.compare_exchange_strong(before, 2 * loop, std::memory_order_relaxed);
    }
    void setDone(std::uint64_t loop) { word_.store(2 * loop + 1, std::memory_order_release); }

   private:
    std::atomic<std::uint64_t> word_{0};
  };

  /// Lets helpers in while there is a loop, and counts them, in one word: its number above
  /// whether it is open above how many are inside. While one is, the loop stays.
  class alignas(64) Gate {
   public:
    void open() { word_.fetch_add(kLoop + kOpen, std::memory_order_release); }
    /// Waits for those who are inside.
    void close() {
      word_.fetch_sub(kOpen, std::memory_order_relaxed);
      Wait wait;
      while (word_.load(std::memory_order_acquire) % kOpen > 0) wait.once();
    }
    /// \return the number of the loop, or 0 if there is none, or only the one that has been seen.
    std::uint64_t enter(std::uint64_t seen) {
      const Word before = word_.load(std::memory_order_relaxed);
      if (!isOpen(before) || before / kLoop == seen) return 0;
      const Word entered = word_.fetch_add(1, std::memory_order_acquire);
      if (isOpen(entered)) return entered / kLoop;
      leave();
      return 0;
    }
    void leave() { word_.fetch_sub(1, std::memory_order_release); }
    std::int32_t inside() const {
      return static_cast<std::int32_t>(word_.load(std::memory_order_relaxed) % kOpen);
    }
    /// Of the loop there is, for who has opened the gate.
    std::uint64_t number() const { return word_.load(std::memory_order_relaxed) / kLoop; }

   private:
    using Word = std::uint64_t;
    static constexpr Word kOpen = Word{1} << 15;
    static constexpr Word kLoop = Word{1} << 16;

    static bool isOpen(Word word) { return word / kOpen % 2 == 1; }

    std::atomic<Word> word_{0};
  };

  ~Impl();

  void begin();
  void end();
  void callHelpers();
  void live(std::int32_t member);
  void help(std::int32_t member);
  void run(const Loop& what, std::int32_t parts);
  void work(std::int32_t member, std::uint64_t number);
  void workOff(std::int32_t owner, bool isOwn, std::uint64_t number);
  template <typename Condition>
  void giveTime(const Condition& isDone) const;
  void finish(std::int32_t part, std::uint64_t number);

  std::int32_t size = 1;
  Loop loop;
  std::vector<Mark> marks;  ///< by part
  Gate gate;
  alignas(64) std::atomic<std::int32_t> through{0};  ///< members, with parts of their own
  alignas(64) std::atomic<bool> isOver{false};       ///< the shift
  std::atomic<std::int32_t> present{0};              ///< helpers
  bool areCalled = false;

  std::mutex mutex;
  std::condition_variable called;
  std::int64_t calls = 0;  ///< guarded by mutex
  bool isOpen = false;     ///< whoever comes may help; guarded by mutex
  bool isClosing = false;  ///< for good; guarded by mutex
  std::vector<std::thread> helpers;
};

ThreadPool::Impl::~Impl() {
  {
    const std::lock_guard<std::mutex> lock(mutex);
    isClosing = true;
  }
  called.notify_all();
  for (std::thread& helper : helpers) helper.join();
}

void ThreadPool::Impl::begin() {
  size = std::min(ThreadLimit::ofThisThread(), kMostMembers);
  isOver.store(false, std::memory_order_relaxed);
}

/// Who has not come yet is not waited for.
void ThreadPool::Impl::end() {
  if (!areCalled) return;
  areCalled = false;
  isOver.store(true, std::memory_order_release);
  {
    const std::lock_guard<std::mutex> lock(mutex);
    isOpen = false;
  }
  Wait wait;
  while (present.load(std::memory_order_acquire) > 0) wait.once();
}

void ThreadPool::Impl::callHelpers() {
  areCalled = true;
  for (auto member = static_cast<std::int32_t>(helpers.size()) + 1; member < size; ++member) {
    helpers.emplace_back([this, member] { live(member); });
  }
  {
    const std::lock_guard<std::mutex> lock(mutex);
    isOpen = true;
    ++calls;
  }
  called.notify_all();
}

void ThreadPool::Impl::live(std::int32_t member) {
  std::int64_t heard = 0;
  std::unique_lock<std::mutex> lock(mutex);
  while (true) {
    called.wait(lock, [&] { return isClosing || (isOpen && calls != heard && member < size); });
    if (isClosing) return;
    heard = calls;
    present.fetch_add(1, std::memory_order_relaxed);
    lock.unlock();
    help(member);
    present.fetch_sub(1, std::memory_order_release);
    lock.lock();
  }
}

void ThreadPool::Impl::help(std::int32_t member) {
  Wait wait;
  std::uint64_t seen = 0;
  while (!isOver.load(std::memory_order_acquire)) {
    const std::uint64_t number = gate.enter(seen);
    if (number == 0) {
      wait.once();
      continue;
    }
    work(member, number);
    gate.leave();
    seen = number;
    wait.beginAgain();
  }
}

void ThreadPool::Impl::run(const Loop& what, std::int32_t parts) {
  if (!areCalled) callHelpers();
  if (marks.size() < static_cast<std::size_t>(parts)) {
    marks = std::vector<Mark>(static_cast<std::size_t>(parts));
  }
  loop = what;
  through.store(0, std::memory_order_relaxed);
  gate.open();
  work(0, gate.number());
  gate.close();
}

/// Parts of its own, and then those of others.
void ThreadPool::Impl::work(std::int32_t member, std::uint64_t number) {
  workOff(member, true, number);
  through.fetch_add(1, std::memory_order_relaxed);
  const auto areThrough = [&] { return through.load(std::memory_order_relaxed) == size; };
  if (loop.order != nullptr) giveTime(areThrough);
  if (areThrough()) return;
  for (std::int32_t k = 1; k < size; ++k) workOff((member + k) % size, false, number);
}

/// Waits for a while until `isDone()`, if everyone is here: what somebody else will begin soon is
/// left to him. To fetch its particles from his cache costs more.
template <typename Condition>
void ThreadPool::Impl::giveTime(const Condition& isDone) const {
  for (int looks = 0; looks < kPatience && !isDone() && gate.inside() == size - 1; ++looks) rest();
}

/// The parts of a member: of each group those at its ends first; who helps begins with the last.
void ThreadPool::Impl::workOff(std::int32_t owner, bool isOwn, std::uint64_t number) {
  std::int32_t first = 0;
  for (std::int32_t group = 0; group < loop.groups; ++group) {
    const std::int32_t parts = loop.groupEnds[group] - first;
    const auto boundary = [&](std::int32_t member) {
      return first + (parts * member + size - 1) / size;
    };
    const std::int32_t begin = boundary(owner);
    const std::int32_t count = boundary(owner + 1) - begin;
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t at = isOwn ? k : count - 1 - k;
      const std::int32_t fromEnds = at == 1 ? count - 1 : std::max(0, at - 1);
      finish(begin + fromEnds, number);
    }
    first = loop.groupEnds[group];
  }
}

/// Does a part and those that it waits for, if nobody else does.
void ThreadPool::Impl::finish(std::int32_t part, std::uint64_t number) {
  Mark& mark = marks[static_cast<std::size_t>(part)];
  if (mark.isTaken(number)) return;
  if (loop.order != nullptr) {
    const TaskGraph& order = *loop.order;
    for (std::int32_t k = part == 0 ? 0 : order.waitEnds[part - 1]; k < order.waitEnds[part]; ++k) {
      const Mark& before = marks[static_cast<std::size_t>(order.waits[k])];
      giveTime([&] { return before.isTaken(number); });
      finish(order.waits[k], number);
      Wait wait;
      while (!before.isDone(number)) wait.once();
    }
  }
  if (!mark.take(number)) return;
  loop.body(loop.context, part);
  mark.setDone(number);
}

ThreadPool::ThreadPool() : impl_(std::make_unique<Impl>()) {}
ThreadPool::~ThreadPool() = default;
ThreadPool::ThreadPool(ThreadPool&&) noexcept = default;
ThreadPool& ThreadPool::operator=(ThreadPool&&) noexcept = default;

ThreadPool* ThreadPool::ofThisThread() {
  return poolOfThisThread != nullptr && poolOfThisThread->size() > 1 ? poolOfThisThread : nullptr;
}

std::int32_t ThreadPool::size() const { return impl_->size; }

void ThreadPool::run(std::int32_t parts, Body body, const void* context) {
  poolOfThisThread = nullptr;
  impl_->run({&parts, 1, nullptr, body, context}, parts);
  poolOfThisThread = this;
}

void ThreadPool::run(const TaskGraph& order, Body body, const void* context) {
  poolOfThisThread = nullptr;
  impl_->run({order.groupEnds.data(), static_cast<std::int32_t>(order.groupEnds.size()), &order,
              body, context},
             order.groupEnds.back());
  poolOfThisThread = this;
}

ThreadPool::ParallelRegion::ParallelRegion(ThreadPool& pool)
    : pool_(poolOfThisThread == nullptr ? &pool : nullptr) {
  if (pool_ == nullptr) return;
  pool_->impl_->begin();
  poolOfThisThread = pool_;
}

ThreadPool::ParallelRegion::~ParallelRegion() {
  if (pool_ == nullptr) return;
  poolOfThisThread = nullptr;
  pool_->impl_->end();
}

}  // namespace cloth_sim
