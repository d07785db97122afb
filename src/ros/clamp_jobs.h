#pragma once
/// \file The goals of clamps that are under way, in the simulation thread. No ROS in here.

#include <memory>

#include "clamp_job.h"

namespace cloth_sim {

/// The goals under way: at most one for each part of each clamp.
class ClampJobs {
 public:
  using Apply = std::function<CommandResult(const Command&)>;

  /// \param apply  carries out a command between two steps, and records it.
  ClampJobs(const Simulation& simulation, Apply apply)
      : simulation_(simulation), apply_(std::move(apply)) {}

  /// Begins a goal, which takes the place of the one before; or refuses it, and nothing changes.
  void start(const std::shared_ptr<ClampJob>& job);
  /// Cancels a goal, unless it is over: the clamp holds its place.
  void cancel(const ClampJob* job);
  /// Cancels the goal for a part of a clamp, if there is one.
  void cancel(const std::string& clamp, ClampJob::Part part);
  /// Lets every goal proceed. To be called between two steps, after commands too.
  void tend();
  /// Ends every goal. \param reason  one sentence.
  void endAll(const std::string& reason);
  /// Answers a goal that has not begun.
  static void refuse(const ClampJob& job, const std::string& reason);

 private:
  using Outcome = ClampJobResult::Outcome;

  const Clamp* find(const std::string& clamp) const;
  bool tendOne(ClampJob& job);
  void cancelIf(const std::function<bool(const ClampJob&)>& chosen);
  void finish(const ClampJob& job, Outcome outcome, const std::string& message) const;

  const Simulation& simulation_;
  Apply apply_;
  std::vector<std::shared_ptr<ClampJob>> jobs_;
};

}  // namespace cloth_sim
