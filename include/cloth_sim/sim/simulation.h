#pragma once
/// \file A simulation of one or several cloths: the order of a step, and access from outside.
///
/// `Simulation` is a conductor. The state and the rules live in its components (SimulationParts):
/// holders (pins, clamps, the pull of a pointer), obstacles, the guarded solver, surgery (tears,
/// cuts, refinement, the history of failures), the script of phases, sleep, and measurements.
/// `step` calls them in order. Between two steps, commands (sim/command.h) change the components;
/// each command knows itself how to check, describe and carry out what it asks for.

#include "cloth_sim/sim/command.h"
#include "cloth_sim/threads/thread_pool.h"

namespace cloth_sim {

/// A scene at work. Not thread-safe: one thread owns it, others get snapshots.
///
/// The same scene and the same commands at the same simulated times give the same bits, whatever
/// the number of threads.
class Simulation {
 public:
  /// \throws std::invalid_argument if the scene contradicts itself (loadScene finds that earlier,
  ///         with a better message).
  explicit Simulation(Scene scene) : parts_(std::move(scene)) {}

  /// Advances by `scene().solver.dt`. Does nothing once it has failed.
  ///
  /// A step that is stopped (`stopWhen`) is not counted: cloth, clamps and time are where they were
  /// after the last whole step, or, if springs failed in the step, where the last of them did. The
  /// script may have begun a phase. The next step does what the stopped one had begun, but not to
  /// the bit: methods keep some memory of it.
  void step();
  /// Has steps end early while `stop` is set, even within a substep. `stop` must outlive this.
  void stopWhen(const StopFlag& stop) { stop_ = &stop; }

  /// Carries out a command now, between two steps; or refuses it, and nothing changes.
  CommandResult apply(const Command& command);

  const Scene& scene() const { return parts_.scene; }
  const Model& model() const { return parts_.model; }
  const State& state() const { return parts_.state; }
  const std::vector<Clamp>& clamps() const { return parts_.holders.clamps(); }
  const ColliderSet& colliders() const { return parts_.obstacles.colliders(); }
  const Contacts& contacts() const { return parts_.obstacles.contacts(); }
  /// Figures of the contact between layers of cloth in the last step; absent if the scene has none.
  std::optional<LayerReport> layerReport() const {
    return parts_.layers ? std::optional<LayerReport>(parts_.layers->report()) : std::nullopt;
  }
  const PhaseScript& script() const { return parts_.script; }
  const StepReport& lastReport() const { return parts_.solver.report(); }
  const GuardRecord& guard() const { return parts_.solver.guard(); }
  /// Returns the settings that commands may change, as they are now.
  Tuning tuning() const { return parts_.tuning(); }
  /// Length of the substeps of the last step; before the first one, of those that the scene asks
  /// for [s].
  double substep() const {
    const double last = lastReport().substep;
    return last > 0.0 ? last : parts_.dt() / parts_.solver.substeps();
  }
  /// Number of connected pieces of cloth.
  int pieces() const { return parts_.surgery.pieces().count; }
  const DroppedScraps& dropped() const { return parts_.surgery.dropped(); }
  double time() const { return parts_.time(); }  ///< [s]
  /// Number of steps since the start or the last reset.
  std::uint64_t stepCount() const { return parts_.stepCount; }
  bool failed() const { return parts_.failed(); }
  /// Why it failed, in one sentence; "" if it has not.
  const std::string& failure() const { return parts_.failure; }
  /// Doubts about the result although the simulation goes on; none at best. They stay until a
  /// reset.
  std::vector<ResultWarning> warnings() const { return parts_.warnings(); }
  /// The measures behind the warnings.
  const ResultWatch& watch() const { return parts_.watch; }
  /// While the cloth sleeps, steps only let time go on; see docs/model.md.
  bool isAsleep() const { return parts_.sleep.isAsleep(); }
  /// Simulated time slept through since the start or the last reset [s].
  double timeAsleep() const { return parts_.sleep.timeAsleep(); }

  /// Returns the largest structural or shear stretch now [-], and remembers the largest of all.
  double observeMaxStretch();
  /// The largest stretch that `observeMaxStretch` has returned [-], at least 1.
  double maxStretchSeen() const { return parts_.measurements.maxStretchSeen(); }

  /// All springs that failed since the start or the last reset, in order, as counted in `broken`.
  const std::vector<FailureEvent>& failures() const { return parts_.surgery.failures().all(); }
  const BrokenCounts& broken() const { return parts_.surgery.failures().counts(); }
  /// Returns the failures since the last call.
  std::vector<FailureEvent> takeEvents() { return parts_.surgery.failures().takeNew(); }
  /// Returns the events of grips since the last call, in order.
  std::vector<GripEvent> takeGripEvents() { return parts_.holders.takeGripEvents(); }

  /// Everything that the future of this simulation depends on, as bytes (see sim/saved_state.h).
  std::string save() const { return saveParts(parts_); }
  /// Goes on from `bytes` as the simulation that was saved would, to the bit.
  /// \throws StateError if they are damaged, of another version or of another scene; nothing has
  ///         changed then.
  void load(const std::string& bytes) { parts_ = loadParts(bytes, parts_); }
  /// Takes over all that was saved except for the method: this simulation's own method goes on from
  /// there, without a memory. It compares methods from the same state.
  /// \throws StateError if `bytes` are damaged, of another version or of another scene; nothing has
  ///         changed then.
  void adopt(const std::string& bytes) { parts_ = adoptParts(bytes, parts_); }

  /// The connected pieces of cloth, the largest first.
  std::vector<PieceSnapshot> describePieces() const;

  /// Returns a copy of everything that others may see. The topology is shared between snapshots
  /// until it changes.
  std::shared_ptr<const Snapshot> snapshot(Detail detail = Detail::kFigures,
                                           ContactDetail contacts = ContactDetail::kReport);

 private:
  void sleepThrough();
  std::optional<double> solveFrom(double done);
  void tear(double dt);
  void watchRest(int brokenBefore);

  SimulationParts parts_;
  const StopFlag* stop_ = nullptr;  ///< null: steps are never stopped
  ThreadPool pool_;                 ///< for the loops of a step
};

}  // namespace cloth_sim
