#pragma once
/// \file Independent jobs on several threads.

#include <functional>
#include <vector>

namespace cloth_sim {

using Jobs = std::vector<std::function<void()>>;

/// Runs all jobs, started in their order, on `threads` threads (>= 1; the caller's is one of them).
/// After a job has thrown, no further job is started.
/// \throws the exception of the first job that threw, once all running jobs have ended.
void runJobs(const Jobs& jobs, int threads);

}  // namespace cloth_sim
