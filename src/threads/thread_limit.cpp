#include "cloth_sim/threads/thread_limit.h"

#include <sched.h>

#include <algorithm>

namespace cloth_sim {
namespace {

thread_local int limitOfThisThread = 0;  // 0: one per processor

/// Processors that this thread may run on (its affinity mask, which taskset sets).
int processors() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 1;
  return std::max(1, CPU_COUNT(&allowed));
}

}  // namespace

ThreadLimit::ThreadLimit(int threads) : before_(limitOfThisThread) {
  limitOfThisThread = std::max(0, threads);
}

ThreadLimit::~ThreadLimit() { limitOfThisThread = before_; }

int ThreadLimit::ofThisThread() { return limitOfThisThread > 0 ? limitOfThisThread : processors(); }

}  // namespace cloth_sim
