#pragma once
/// \file Names of threads, for `top -H`, debuggers and bench/node_overhead.

#include <pthread.h>

namespace cloth_sim {

/// Names the calling thread; threads that it starts afterwards inherit the name.
/// \param name  at most 15 characters.
inline void nameThisThread(const char* name) { pthread_setname_np(pthread_self(), name); }

}  // namespace cloth_sim
