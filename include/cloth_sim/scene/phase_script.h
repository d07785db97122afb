#pragma once
/// \file Runs the phases of a scene: which one is on, and when it is over. It reads observations
/// and returns what to do; it never touches the simulation.

#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// What the script may look at, after each step.
struct PhaseObservation {
  double time = 0.0;       ///< [s]
  double meanSpeed = 0.0;  ///< [m/s]; 0 unless `wantsMeanSpeed`
  bool inContact = false;  ///< some particle touched an obstacle in the last step
  bool clampsAtTarget = false;
  bool clampsClosed = false;
  int pieces = 1;
  int broken = 0;
};

/// One phase that ran or is running.
struct PhaseRecord {
  std::string name;
  double start = 0.0;         ///< [s]
  std::optional<double> end;  ///< [s]; absent while it runs
  bool timedOut = false;      ///< it had conditions, and they did not come to hold in time

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, start, end, timedOut);
  }
};

enum class ScriptStatus { kIdle, kRunning, kDone, kFailed };

/// A cursor over the phases of a scene.
///
/// How a phase ends: as soon as all its conditions hold; or at its time-out, which without
/// conditions is just how long it lasts, and with conditions goes on or fails as the phase says. A
/// phase with neither lasts until `jump`. Conditions are looked at before the time-out.
class PhaseScript {
 public:
  explicit PhaseScript(std::vector<PhaseSpec> phases);

  /// Starts the first phase, if there is one. \return the phase whose actions to carry out.
  const PhaseSpec* start(double time);

  /// Ends the current phase if its conditions hold or its time-out has passed.
  /// \return the phase that begins now, whose actions to carry out; nullptr if none does.
  const PhaseSpec* update(const PhaseObservation& now);

  /// Ends the current phase and begins the named one; the script goes on from there.
  /// \return nullptr, and nothing changed, if there is no phase of that name.
  const PhaseSpec* jump(const std::string& name, double time);

  /// Whatever has happened so far happened `by` later [s].
  void shiftTime(double by);

  ScriptStatus status() const { return status_; }
  /// nullptr unless running.
  const PhaseSpec* current() const;
  /// Whether `update` will look at the mean speed, which takes a look at every particle.
  bool wantsMeanSpeed() const;
  const std::vector<PhaseRecord>& history() const { return history_; }
  std::vector<std::string> names() const;

 private:
  friend class cereal::access;
  /// Where the script is; the phases are as the scene has them.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(index_, status_, history_, phaseStart_, slowSince_, touched_);
  }

  const PhaseSpec* begin(std::size_t index, double time);
  const PhaseSpec* beginNext(double time);
  void finish(double time, bool timedOut);
  void watch(const PhaseObservation& now);
  bool conditionsHold(const PhaseConditions& until, const PhaseObservation& now) const;

  std::vector<PhaseSpec> phases_;
  std::size_t index_ = 0;
  ScriptStatus status_ = ScriptStatus::kIdle;
  std::vector<PhaseRecord> history_;
  double phaseStart_ = 0.0;
  std::optional<double> slowSince_;  ///< since when the mean speed is below the phase's limit
  bool touched_ = false;             ///< some particle touched an obstacle in this phase
};

}  // namespace cloth_sim
