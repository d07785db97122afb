#pragma once
/// \file A time-stepping method with the checks around it that keep a bad step out of the state.

#include "cloth_sim/contact/layers.h"
#include "cloth_sim/sim/holders.h"
#include "cloth_sim/sim/obstacles.h"
#include "cloth_sim/sim/step_watch.h"
#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {

/// The cloth that a step moves, and what acts on it.
struct SteppedCloth {
  const Model& model;
  State& state;
  Controls& controls;
  Holders& holders;
  Obstacles& obstacles;
  LayerContact* layers;  ///< null if layers of cloth do not touch
  Tearing& tearing;
};

/// Solves steps with the scene's method. A step that diverges, or whose energy jumps, is taken back
/// and solved again with twice the substeps; one that loads a clamp beyond its grip force is taken
/// back and solved again with that clamp slipping.
class GuardedSolver {
 public:
  /// \throws std::invalid_argument if the method is unknown, cannot follow the model, or is refused
  ///         by the scene's step guard.
  GuardedSolver(const SolverSpec& spec, const Model& model, const State& state);

  /// Advances `cloth.state` to the end of the step, or to where a length limit was passed.
  /// \return how it ended; unless that is `kOk`, the state is where it was.
  StepStatus advance(const StepLength& length, const SteppedCloth& cloth);

  /// Report of the last step.
  const StepReport& report() const { return report_; }
  /// The interventions of the guard so far.
  const GuardRecord& guard() const { return watch_.record(); }
  /// Number of substeps of a step that is not redone.
  int substeps() const { return solver_->substeps(); }

  /// Updates what the method derives from the model. To be called after every edit.
  void onModelChanged(const Model& model, const ModelChanges& changes) {
    solver_->onModelChanged(model, changes);
  }

 private:
  friend class StateFormat;

  StepStatus attempt(const StepLength& length, const SteppedCloth& cloth);
  bool mayTakeBack(const SteppedCloth& cloth) const;
  void takeBack(const SteppedCloth& cloth);

  std::unique_ptr<Solver> solver_;
  StepWatch watch_;
  bool meetsSharpFeatures_;  ///< whether the method does
  StepReport report_;
  State start_;  ///< of the step, if the step may be taken back after it has ended
};

}  // namespace cloth_sim
