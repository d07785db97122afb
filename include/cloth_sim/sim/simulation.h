#pragma once
/// \file One cloth with everything that acts on it.

#include <memory>

#include "cloth_sim/scene/phase_script.h"
#include "cloth_sim/sim/command.h"
#include "cloth_sim/sim/snapshot.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// A scene at work. Not thread-safe: one thread owns it, others get snapshots.
///
/// The same scene and the same commands at the same simulated times give the same bits, whatever
/// the number of threads.
class Simulation {
 public:
  explicit Simulation(Scene scene);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by `scene().solver.dt`. Does nothing once it has failed.
  void step();

  /// Carries out a command now, between two steps; or refuses it, and nothing changes.
  CommandResult apply(const Command& command);

  const Scene& scene() const { return scene_; }
  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const std::vector<Clamp>& clamps() const { return clamps_; }
  const PhaseScript& script() const { return script_; }
  const BrokenCounts& broken() const { return broken_; }
  int pieces() const { return pieces_; }
  double time() const { return state_.t; }
  std::uint64_t stepCount() const { return stepCount_; }
  /// The largest structural or shear stretch seen so far at the end of any step.
  double maxStretchSeen() const { return maxStretchSeen_; }
  bool failed() const { return !failure_.empty(); }
  const std::string& failure() const { return failure_; }

  /// Failures since the last call, in order; they are also counted in `broken`.
  std::vector<FailureEvent> takeEvents();

  /// A copy of what others may see. The topology is shared between snapshots of one revision.
  std::shared_ptr<const Snapshot> snapshot();

 private:
  void build();
  void runScript();
  void beginPhase(const PhaseSpec& phase);
  void moveClamps();
  void gatherKinematics();
  void detectContacts();
  void solve();
  void readClamps();
  void openSurface();

  CommandResult carryOut(const SetClampTarget& command);
  CommandResult carryOut(const SetGrasp& command);
  CommandResult carryOut(const SetPhase& command);
  CommandResult carryOut(const SetGravity& command);
  CommandResult carryOut(const MoveObstacle& command);
  CommandResult carryOut(const SetTearing& command);
  CommandResult carryOut(const Reset& command);
  Clamp* findClamp(const std::string& name);

  Scene scene_;
  Model model_;
  State state_;
  State lastGood_;
  Controls controls_;
  std::vector<KinematicTarget> pins_;
  std::vector<Clamp> clamps_;
  ColliderSet colliders_;
  Contacts contacts_;
  std::unique_ptr<Solver> solver_;
  PhaseScript script_;
  TearingSettings tearing_;
  BrokenCounts broken_;
  std::vector<FailureEvent> events_;
  std::shared_ptr<const Topology> topology_;
  std::vector<std::array<VertexId, 2>> originalBoundary_;
  int pieces_ = 1;
  std::uint64_t stepCount_ = 0;
  double maxStretchSeen_ = 1.0;
  std::string failure_;
};

}  // namespace cloth_sim
