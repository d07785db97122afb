#pragma once
/// \file One cloth, or several, with everything that acts on them.

#include <memory>

#include "cloth_sim/clamp/grip_event.h"
#include "cloth_sim/scene/phase_script.h"
#include "cloth_sim/sim/command.h"
#include "cloth_sim/sim/obstacle_guides.h"
#include "cloth_sim/sim/sleep.h"
#include "cloth_sim/sim/snapshot.h"
#include "cloth_sim/sim/step_watch.h"
#include "cloth_sim/solver/solver.h"
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
  explicit Simulation(Scene scene);

  /// Advances by `scene().solver.dt`. Does nothing once it has failed.
  void step();

  /// Carries out a command now, between two steps; or refuses it, and nothing changes.
  CommandResult apply(const Command& command);

  const Scene& scene() const { return scene_; }
  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const std::vector<Clamp>& clamps() const { return clamps_; }
  const ColliderSet& colliders() const { return colliders_; }
  const Contacts& contacts() const { return contacts_; }
  const PhaseScript& script() const { return script_; }
  const BrokenCounts& broken() const { return broken_; }
  const StepReport& lastReport() const { return report_; }
  const GuardRecord& guard() const { return watch_.record(); }
  /// What may be turned by commands, as it is now.
  Tuning tuning() const;
  /// Of the method, as the mesh is now [s].
  double substep() const { return scene_.solver.dt / solver_->substeps(); }
  int pieces() const { return pieces_.count; }
  const DroppedScraps& dropped() const { return dropped_; }
  double time() const { return state_.t; }
  std::uint64_t stepCount() const { return stepCount_; }
  bool failed() const { return !failure_.empty(); }
  const std::string& failure() const { return failure_; }
  /// While the cloth sleeps, steps only let time go on; see docs/model.md.
  bool isAsleep() const { return sleep_.isAsleep(); }
  /// How long it has slept since the start or the last reset, simulated [s].
  double timeAsleep() const { return sleep_.timeAsleep(); }

  /// Largest structural or shear stretch now; remembers the largest that it was asked for.
  double observeMaxStretch();
  /// The largest stretch that `observeMaxStretch` has seen.
  double maxStretchSeen() const { return maxStretchSeen_; }

  /// All springs that failed since the start or the last reset, in order, as counted in `broken`.
  const std::vector<FailureEvent>& failures() const { return failures_; }
  /// Those since the last call.
  std::vector<FailureEvent> takeEvents();
  /// What became of grasps since the last call, in order.
  std::vector<GripEvent> takeGripEvents();

  /// Everything that the future of this simulation depends on, as bytes (see sim/saved_state.h).
  std::string save() const;
  /// Goes on from `bytes` as the simulation that was saved would, to the bit.
  /// \throws StateError if they are damaged, of another version or of another scene; nothing has
  ///         changed then.
  void load(const std::string& bytes);

  /// The connected pieces of cloth, the largest first.
  std::vector<PieceSnapshot> describePieces() const;

  /// A copy of what others may see. The topology is shared between snapshots of one revision.
  std::shared_ptr<const Snapshot> snapshot(Detail detail = Detail::kFigures);

 private:
  void runScript();
  void advance(double done);
  void moveClamps(double dt);
  void gatherControls();
  bool letSlip();
  void watchGrips();
  void detectContacts(double dt);
  void solve(const StepLength& length);
  bool attempt(const StepLength& length);
  bool mayTakeBack() const;
  void takeBack();
  void readClamps(double share);
  void tear(double dt);
  void sleepOn();
  /// \param brokenBefore  how many springs had failed before the step.
  void watchRest(int brokenBefore);
  bool isStill() const;
  bool touches(const Command& command) const;

  PhaseObservation observe() const;
  void beginPhase(const PhaseSpec& phase);
  void operateFor(const PhaseSpec& phase);
  void act(const ClampAction& action, Clamp& clamp);
  /// Cuts, and brings everything along. Throws TooManyParticles, and nothing has changed.
  SurgeryResult operate(const CutPlan& plan);
  SurgeryResult cutStroke(const Stroke& stroke);
  SurgeryResult cutNotch(const MaterialPath& notch);
  void refineMesh(const RefineNear& request);
  void applyChanges(const SurgeryResult& result);
  void dropScraps();
  std::vector<std::int32_t> largestPieces(const std::vector<double>& area) const;
  std::vector<VertexId> heldVertices() const;
  void count(const FailureEvent& event);
  void fail(const std::string& why);

  CommandResult carryOut(const SetClampTarget& command);
  CommandResult carryOut(const GuideClamp& command);
  CommandResult carryOut(const SetGripForce& command);
  CommandResult carryOut(const SetGapWidth& command);
  CommandResult carryOut(const CreateClamp& command);
  CommandResult carryOut(const DeleteClamp& command);
  CommandResult carryOut(const SetGrasp& command);
  CommandResult carryOut(const SetPhase& command);
  CommandResult carryOut(const SetGravity& command);
  CommandResult carryOut(const MoveObstacle& command);
  CommandResult carryOut(const GuideObstacle& command);
  CommandResult carryOut(const SetTearing& command);
  CommandResult carryOut(const SetWind& command);
  CommandResult carryOut(const SetStiffness& command);
  CommandResult carryOut(const PullParticle& command);
  CommandResult carryOut(const CutAlong& command);
  CommandResult carryOut(const RefineNear& command);
  CommandResult carryOut(const Reset& command);
  CommandResult carryOut(const Restore& command);
  /// Everything that is told by the time goes on as if it were `by` later [s].
  void shiftTime(double by);
  Clamp* findClamp(const std::string& name);
  std::shared_ptr<const Topology> makeTopology() const;
  Figures figures();

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive);
  template <class Archive>
  void serializeContacts(Archive& archive);

  Scene scene_;
  Model model_;
  State state_;
  State start_;  ///< of the step, where one that ends well may be taken back
  Controls controls_;
  std::vector<KinematicTarget> pins_;
  std::vector<KinematicTarget> holders_;  ///< of pins, clamps and what is dragged, as they come
  std::vector<std::size_t> holderOrder_;  ///< of them, by vertex
  std::vector<Clamp> clamps_;
  Drag drag_;
  GripWatch grips_;
  std::vector<GripEvent> gripEvents_;
  ColliderSet colliders_;
  ObstacleGuides guides_;
  Contacts contacts_;
  ThreadPool pool_;  ///< for the loops of a step
  std::unique_ptr<Solver> solver_;
  StepReport report_;
  StepWatch watch_;
  Sleep sleep_;
  std::optional<double> stretchAsleep_;  ///< the largest stretch, if known since it fell asleep
  PhaseScript script_;
  Tearing tearing_;
  BrokenCounts broken_;
  std::vector<FailureEvent> failures_;
  std::size_t told_ = 0;  ///< of failures_, by takeEvents
  std::shared_ptr<const Topology> topology_;
  SurgeryLimits limits_;
  ConnectedComponents pieces_;
  DroppedScraps dropped_;
  std::uint64_t stepCount_ = 0;
  double maxStretchSeen_ = 1.0;
  std::string failure_;
  std::uint64_t startHash_ = 0;  ///< stateHash before the first step
};

}  // namespace cloth_sim
