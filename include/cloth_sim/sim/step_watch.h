#pragma once
/// \file Whether a step ended well, for simulations that redo the ones that did not.

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/scene/scene.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// Judges steps. One ended well if it did not diverge and, for methods with a limit of stability,
/// if its energy did not jump: kinetic and elastic energy are at most twice what clamps, wind,
/// obstacles and gravity can have put in since they were last lower.
class StepWatch {
 public:
  /// \param substeps  that the method has after the guard looked at the scene.
  StepWatch(const SolverSpec& solver, int substeps);

  /// How many times the substeps a step that ends badly is tried with at most; each attempt has
  /// twice those of the one before. 1: it is not redone.
  int mostTimes() const { return redoes_ ? kMostTimes : 1; }

  /// Whether it looks at the energy.
  bool weighs() const { return weighs_; }

  /// Notes what a step starts from.
  void begin(const Model& model, const State& state, const Controls& controls,
             const ColliderSet& colliders, double dt);
  /// Whether the step that led to `state` ended well; `status` is what the solver says of it.
  bool isSound(const Model& model, const State& state, StepStatus status);
  /// Notes that the step stays as it was last looked at.
  void accept();
  /// Notes that an attempt was rolled back, and that the next one is divided `times` further.
  void noteRedone(double time, int times);

  const GuardRecord& record() const { return record_; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(budget_, record_);
  }

 private:
  static constexpr int kMostTimes = 64;

  bool redoes_;
  bool weighs_;
  double budget_ = -1.0;  ///< that the cloth can have by now; negative: no step yet [J]
  double input_ = 0.0;    ///< root of what may come in during the step [J^1/2]
  double height_ = 0.0;   ///< energy of weight at the start of the step [J]
  Vec3 gravity_ = Vec3::Zero();
  double reached_ = 0.0;  ///< what the budget is if the step is accepted [J]
  double found_ = 0.0;    ///< by the attempt before; 0: none [J]
  GuardRecord record_;
};

}  // namespace cloth_sim
