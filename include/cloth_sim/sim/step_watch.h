#pragma once
/// \file Judges whether a step ended well, so that one that did not can be redone.

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/scene/scene.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// Judges steps. A step ended well if it did not diverge and, for a method with a limit of
/// stability, if the energy did not jump: kinetic plus elastic energy are at most twice what
/// clamps, wind, obstacles and gravity can have put in since they were last lower.
class StepWatch {
 public:
  /// \param substeps  number of substeps that the method has after the guard looked at the scene.
  StepWatch(const SolverSpec& solver, int substeps);

  /// Returns the largest factor by which the substeps of a bad step are multiplied, a power of two:
  /// each attempt doubles it. 1 if steps are never redone.
  int maxSubstepFactor() const { return redoes_ ? kMaxSubstepFactor : 1; }

  /// Tells whether the energy is checked, so that also a step that ended may be rejected.
  bool checksEnergy() const { return checksEnergy_; }

  /// Records the state that a step of `dt` [s] starts from.
  void begin(const Model& model, const State& state, const Controls& controls,
             const ColliderSet& colliders, double dt);
  /// Tells whether the attempt that led to `state` ended well.
  /// \param status  that the solver reported.
  bool endedWell(const Model& model, const State& state, StepStatus status);
  /// Accepts the attempt that `endedWell` last judged.
  void accept();
  /// Records that an attempt was rolled back, and that the next one has `factor` times the
  /// substeps.
  void noteRedone(double time, int factor);

  const GuardRecord& record() const { return record_; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(budget_, record_);
  }

 private:
  static constexpr int kMaxSubstepFactor = 64;

  bool redoes_;
  bool checksEnergy_;
  double budget_ = -1.0;  ///< energy that the cloth may have by now [J]; negative before any step
  double input_ = 0.0;    ///< square root of the energy that may come in during the step [J^1/2]
  double height_ = 0.0;   ///< gravitational energy at the start of the step [J]
  Vec3 gravity_ = Vec3::Zero();  ///< [m/s^2]
  double nextBudget_ = 0.0;      ///< the budget if the step is accepted [J]
  double previousEnergy_ = 0.0;  ///< after the attempt before this one [J]; 0 if this is the first
  GuardRecord record_;
};

}  // namespace cloth_sim
