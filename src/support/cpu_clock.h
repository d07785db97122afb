#pragma once
/// \file The CPU clock of a thread.

#include <ctime>

namespace cloth_sim {

/// Returns the CPU time of the calling thread [s].
inline double threadCpuTime() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace cloth_sim
