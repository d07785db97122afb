#include "clamp_jobs.h"

#include <algorithm>

#include "clamp/find_clamp.h"
#include "scene/names.h"

namespace cloth_sim {

const Clamp* ClampJobs::find(const std::string& clamp) const {
  return findClamp(simulation_.clamps(), clamp);
}

void ClampJobs::start(const std::shared_ptr<ClampJob>& job) {
  if (simulation_.failed()) return refuse(*job, "the simulation has failed; reset it");
  const Clamp* clamp = find(job->clamp());
  if (clamp == nullptr) {
    return refuse(*job, unknownName("clamp", job->clamp(), namesOf(simulation_.clamps())));
  }
  const ClampJob::Turn turn = job->begin(*clamp, simulation_);
  if (turn.end) return refuse(*job, turn.message);
  for (const Command& command : turn.commands) {
    const CommandResult result = apply_(command);
    if (!result.success) return refuse(*job, result.message);
  }
  const auto rival = std::find_if(jobs_.begin(), jobs_.end(), [&](const auto& other) {
    return other->clamp() == job->clamp() && other->part() == job->part();
  });
  if (rival != jobs_.end()) {
    const std::shared_ptr<ClampJob> old = *rival;
    jobs_.erase(rival);
    finish(*old, Outcome::kPreempted, "another goal took its place");
  }
  if (job->listener().accepted) job->listener().accepted();
  jobs_.push_back(job);
}

void ClampJobs::cancel(const ClampJob* job) {
  cancelIf([&](const ClampJob& it) { return &it == job; });
}

void ClampJobs::cancel(const std::string& clamp, ClampJob::Part part) {
  cancelIf([&](const ClampJob& it) { return it.clamp() == clamp && it.part() == part; });
}

void ClampJobs::cancelIf(const std::function<bool(const ClampJob&)>& chosen) {
  const auto found =
      std::find_if(jobs_.begin(), jobs_.end(), [&](const auto& it) { return chosen(*it); });
  if (found == jobs_.end()) return;
  const std::shared_ptr<ClampJob> job = *found;
  jobs_.erase(found);
  if (const Clamp* clamp = find(job->clamp())) {
    if (const auto hold = job->hold(*clamp)) apply_(*hold);
  }
  finish(*job, Outcome::kCancelled, "cancelled");
}

void ClampJobs::tend() {
  const auto over = [this](const std::shared_ptr<ClampJob>& job) { return tendOne(*job); };
  jobs_.erase(std::remove_if(jobs_.begin(), jobs_.end(), over), jobs_.end());
}

/// \return whether the goal is over.
bool ClampJobs::tendOne(ClampJob& job) {
  const Clamp* clamp = find(job.clamp());
  if (simulation_.failed() || clamp == nullptr) {
    finish(job, Outcome::kFailed,
           clamp == nullptr ? "the clamp was removed"
                            : "the simulation has failed: " + simulation_.failure());
    return true;
  }
  const ClampJob::Turn turn = job.proceed(*clamp, simulation_);
  for (const Command& command : turn.commands) {
    const CommandResult result = apply_(command);
    if (result.success) continue;
    finish(job, Outcome::kFailed, result.message);
    return true;
  }
  if (turn.end) finish(job, *turn.end, turn.message);
  return turn.end.has_value();
}

void ClampJobs::endAll(const std::string& reason) {
  for (const auto& job : jobs_) finish(*job, Outcome::kFailed, reason);
  jobs_.clear();
}

void ClampJobs::refuse(const ClampJob& job, const std::string& reason) {
  ClampJobResult result;
  result.outcome = Outcome::kRefused;
  result.message = reason;
  job.listener().answer(result);
}

void ClampJobs::finish(const ClampJob& job, Outcome outcome, const std::string& message) const {
  ClampJobResult result;
  result.outcome = outcome;
  result.message = message;
  result.time = simulation_.time();
  result.revision = simulation_.model().mesh.revision();
  if (const Clamp* clamp = find(job.clamp())) {
    result.pose = clamp->pose();
    result.gap = clamp->gap();
    result.force = clamp->wrench().force.norm();
    result.held = clamp->held();
    result.heldArea =
        gripContents(*clamp, simulation_.model(), simulation_.state(), simulation_.colliders())
            .area;
  }
  job.listener().answer(result);
}

}  // namespace cloth_sim
