#pragma once
/// \file Goals of a clamp that take some steps: to close or open, and to move. No ROS in here.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// The end of a goal of a clamp, with the clamp as it is then.
struct ClampJobResult {
  enum class Outcome { kReached, kBlocked, kPreempted, kCancelled, kTimedOut, kRefused, kFailed };
  Outcome outcome = Outcome::kReached;
  std::string message;  ///< reason, one sentence
  double time = 0.0;    ///< simulated [s]
  Pose pose;
  double gap = 0.0;    ///< [m]
  double force = 0.0;  ///< norm of the force of the cloth on the clamp [N]
  std::vector<VertexId> held;
  double heldArea = 0.0;  ///< rest area of the cloth that they represent [m^2]
  std::uint64_t revision = 0;
};

/// The receivers of news about a goal. Both are called in the simulation thread, and must not
/// block.
struct ClampJobListener {
  std::function<void()> accepted;                     ///< may be null
  std::function<void(const ClampJobResult&)> answer;  ///< called once
};

/// A goal of a clamp. What it does to the clamp, it does by commands, so that recordings have them.
class ClampJob {
 public:
  /// The part of the clamp that a goal is about; a new goal takes the place of the one before.
  enum class Part { kPlates, kMotion };
  using Outcome = ClampJobResult::Outcome;

  /// Commands to carry out now, and the end of the goal, if this is it.
  struct Turn {
    std::vector<Command> commands;
    std::optional<Outcome> end;
    std::string message;  ///< about the end
  };

  ClampJob(std::string clamp, Part part, ClampJobListener listener)
      : clamp_(std::move(clamp)), part_(part), listener_(std::move(listener)) {}
  virtual ~ClampJob() = default;
  ClampJob(const ClampJob&) = delete;
  ClampJob& operator=(const ClampJob&) = delete;

  const std::string& clamp() const { return clamp_; }
  Part part() const { return part_; }
  const ClampJobListener& listener() const { return listener_; }

  /// Begins. The goal is refused if the turn ends it, or if the first of its commands is refused.
  virtual Turn begin(const Clamp& clamp, const Simulation& simulation) = 0;
  /// Goes on, between two steps.
  virtual Turn proceed(const Clamp& clamp, const Simulation& simulation) = 0;
  /// Returns the command that leaves the clamp where it is, if there is one.
  virtual std::optional<Command> hold(const Clamp& clamp) const = 0;

 private:
  std::string clamp_;
  Part part_;
  ClampJobListener listener_;
};

}  // namespace cloth_sim
