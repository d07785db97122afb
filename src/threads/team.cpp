#include "cloth_sim/threads/team.h"

#include <algorithm>
#include <array>
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

thread_local Team* teamOfThisThread = nullptr;

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

struct Team::Impl {
  /// Parts [next, end) of a member, in one word, so that they are taken one at a time.
  class alignas(64) Share {
   public:
    void set(std::int32_t next, std::int32_t end) {
      word_.store(wordOf(next, end), std::memory_order_release);
    }
    /// \return a part, or -1. Whoever gets a part sees the loop that it belongs to, because that
    /// was written before, and is not overwritten as long as a part of it is not done.
    std::int32_t takeFirst() {
      return take([](std::int32_t next, std::int32_t end) { return wordOf(next + 1, end); },
                  [](std::int32_t next, std::int32_t /*end*/) { return next; });
    }
    std::int32_t takeLast() {
      return take([](std::int32_t next, std::int32_t end) { return wordOf(next, end - 1); },
                  [](std::int32_t /*next*/, std::int32_t end) { return end - 1; });
    }

   private:
    using Word = std::uint64_t;

    static Word wordOf(std::int32_t next, std::int32_t end) {
      return Word{static_cast<std::uint32_t>(next)} << 32 | static_cast<std::uint32_t>(end);
    }

    template <typename Rest, typename Taken>
    std::int32_t take(const Rest& rest, const Taken& taken) {
      Word word = word_.load(std::memory_order_relaxed);
      while (true) {
        const auto next = static_cast<std::int32_t>(word >> 32);
        const auto end = static_cast<std::int32_t>(word & 0xffffffffU);
        if (next >= end) return -1;
        if (word_.compare_exchange_weak(word, rest(next, end), std::memory_order_acq_rel,
                                        std::memory_order_relaxed)) {
          return taken(next, end);
        }
      }
    }

    std::atomic<Word> word_{0};
  };

  ~Impl();

  void begin();
  void end();
  void callHelpers();
  void live(std::int32_t member);
  void help(std::int32_t member);
  bool work(std::int32_t member);

  std::int32_t size = 1;
  std::array<Share, kMostMembers> shares;  ///< by member
  Body body = nullptr;
  const void* context = nullptr;
  alignas(64) std::atomic<std::int32_t> pending{0};  ///< parts of the loop that are not done
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

Team::Impl::~Impl() {
  {
    const std::lock_guard<std::mutex> lock(mutex);
    isClosing = true;
  }
  called.notify_all();
  for (std::thread& helper : helpers) helper.join();
}

void Team::Impl::begin() {
  size = std::min(ThreadLimit::ofThisThread(), kMostMembers);
  isOver.store(false, std::memory_order_relaxed);
}

/// Who has not come yet is not waited for.
void Team::Impl::end() {
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

void Team::Impl::callHelpers() {
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

void Team::Impl::live(std::int32_t member) {
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

void Team::Impl::help(std::int32_t member) {
  Wait wait;
  while (!isOver.load(std::memory_order_acquire)) {
    work(member) ? wait.beginAgain() : wait.once();
  }
}

/// Parts of its own, and then those of others: who does not begin with its own would have in its
/// cache what another one needs.
/// \return whether it had any.
bool Team::Impl::work(std::int32_t member) {
  Share& own = shares[static_cast<std::size_t>(member)];
  std::int32_t part = own.takeFirst();
  if (part < 0) return false;
  std::int32_t done = 0;  // told at the end: `pending` goes from core to core each time
  for (; part >= 0; part = own.takeFirst(), ++done) body(context, part);
  for (std::int32_t k = 1; k < size; ++k) {
    Share& other = shares[static_cast<std::size_t>((member + k) % size)];
    for (; (part = other.takeLast()) >= 0; ++done) body(context, part);
  }
  pending.fetch_sub(done, std::memory_order_release);
  return true;
}

Team::Team() : impl_(std::make_unique<Impl>()) {}
Team::~Team() = default;
Team::Team(Team&&) noexcept = default;
Team& Team::operator=(Team&&) noexcept = default;

Team* Team::ofThisThread() {
  return teamOfThisThread != nullptr && teamOfThisThread->size() > 1 ? teamOfThisThread : nullptr;
}

std::int32_t Team::size() const { return impl_->size; }

void Team::run(std::int32_t parts, Body body, const void* context) {
  Impl& team = *impl_;
  if (!team.areCalled) team.callHelpers();
  team.body = body;
  team.context = context;
  team.pending.store(parts, std::memory_order_relaxed);
  for (std::int32_t member = 0; member < team.size; ++member) {
    team.shares[static_cast<std::size_t>(member)].set(parts * member / team.size,
                                                      parts * (member + 1) / team.size);
  }
  teamOfThisThread = nullptr;
  team.work(0);
  teamOfThisThread = this;
  Wait wait;
  while (team.pending.load(std::memory_order_acquire) > 0) wait.once();
}

Team::Shift::Shift(Team& team) : team_(teamOfThisThread == nullptr ? &team : nullptr) {
  if (team_ == nullptr) return;
  team_->impl_->begin();
  teamOfThisThread = team_;
}

Team::Shift::~Shift() {
  if (team_ == nullptr) return;
  teamOfThisThread = nullptr;
  team_->impl_->end();
}

}  // namespace cloth_sim
