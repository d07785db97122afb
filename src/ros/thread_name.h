#pragma once
/// \file Names of threads, for `top -H`, debuggers and bench/node_overhead.

#include <pthread.h>

namespace cloth_sim {

/// Threads that this one starts from now on (workers of the simulation) get the same name.
/// \param name  of 15 characters at most
inline void nameThisThread(const char* name) { pthread_setname_np(pthread_self(), name); }

}  // namespace cloth_sim
