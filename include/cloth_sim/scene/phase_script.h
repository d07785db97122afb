#pragma once
/// \file Runs the script of a scene: the present phase, and its end. The script reads observations
/// and returns the phase whose actions are due; it never touches the simulation.

#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// The observation of a simulation after each step.
struct PhaseObservation {
  double time = 0.0;       ///< [s]
  double meanSpeed = 0.0;  ///< of all particles [m/s]; 0 unless `wantsMeanSpeed`
  bool inContact = false;  ///< a particle touched an obstacle in the last step
  bool clampsAtTarget = false;
  bool clampsClosed = false;
  int pieces = 1;
  int broken = 0;
};

/// The record of a phase that ran or is running.
struct PhaseRecord {
  std::string name;
  double start = 0.0;         ///< [s]
  std::optional<double> end;  ///< [s]; absent while it runs
  bool timedOut = false;      ///< its conditions did not hold in time

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, start, end, timedOut);
  }
};

enum class ScriptStatus { kIdle, kRunning, kDone, kFailed };

/// A cursor over the phases of a scene.
///
/// A phase ends as soon as all its conditions hold, or at its time-out. Without conditions, the
/// time-out is the duration of the phase; with conditions, the script then continues or fails, as
/// the phase asks. A phase with neither lasts until `jump`. Conditions have priority over the
/// time-out.
class PhaseScript {
 public:
  explicit PhaseScript(std::vector<PhaseSpec> phases);

  /// Starts the first phase. \return that phase, whose actions are due; nullptr without phases.
  const PhaseSpec* start(double time);

  /// Ends the current phase if its conditions hold or its time-out has passed.
  /// \return the phase that begins now, whose actions are due; nullptr if none begins.
  const PhaseSpec* update(const PhaseObservation& now);

  /// Ends the current phase and begins the named one, from where the script continues.
  /// \return that phase; nullptr, and nothing changed, if no phase has the name.
  const PhaseSpec* jump(const std::string& name, double time);

  /// Moves all recorded times `by` [s] later.
  void shiftTime(double by);

  ScriptStatus status() const { return status_; }
  /// The current phase; nullptr unless the script is running.
  const PhaseSpec* current() const;
  /// Tells whether `update` needs the mean speed, which costs a pass over all particles.
  bool wantsMeanSpeed() const;
  const std::vector<PhaseRecord>& history() const { return history_; }
  std::vector<std::string> names() const;
  /// Returns the present phase and what ends it, for people.
  std::string progressText() const;
  /// Returns what a script that has failed waited for; "" if it has not.
  std::string failureText() const;

  /// Checks what was read from a file.
  /// \return one sentence about the first error; empty if there is none.
  std::string validationError() const;

 private:
  friend class cereal::access;
  /// Saves the position in the script. The phases come from the scene.
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
  std::optional<double> slowSince_;  ///< time since which the mean speed is below the limit [s]
  bool touched_ = false;             ///< a particle touched an obstacle in this phase
};

}  // namespace cloth_sim
