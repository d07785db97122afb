#pragma once
/// \file What this thread has computed for.

#include <ctime>

namespace cloth_sim {

inline double threadCpuTime() {  ///< [s]
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace cloth_sim
