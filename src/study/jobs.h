#pragma once
/// \file Independent pieces of work, done by several threads.

#include <functional>
#include <vector>

namespace cloth_sim {

using Jobs = std::vector<std::function<void()>>;

/// Does all jobs, in their order, each in one of `threads` threads (>= 1; one: the caller's). After
/// a job that throws no more are begun. \throws what the first such job threw, once all have ended.
void runJobs(const Jobs& jobs, int threads);

}  // namespace cloth_sim
