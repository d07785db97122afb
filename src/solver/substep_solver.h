#pragma once
/// \file The solver that divides a step into substeps and has a method advance them.

#include "substep.h"

namespace cloth_sim {

/// Packs the state, divides the step, moves the kinematic particles, sums up what their holders
/// bear and checks the result. The method integrates each substep.
class SubstepSolver final : public Solver {
 public:
  /// \param substeps  of a step, as the scene asks for.
  SubstepSolver(const Model& model, int substeps, std::unique_ptr<SubstepMethod> method);

  const StepReport& step(const Model& model, State& state, const Controls& controls,
                         Contacts& contacts, const StepLength& length) override;
  int substeps() const override { return substeps_; }
  void onModelChanged(const Model& model, const ModelChanges& changes) override;
  void save(StateWriter& archive) const override;
  void load(StateReader& archive, const Model& model) override;

 private:
  /// The part of a step that is left.
  struct Division {
    double dt = 0.0;  ///< length [s]
    int substeps = 0;
    double h = 0.0;  ///< length of a substep [s]
  };
  /// LengthLimit by particle slots.
  struct Limit {
    std::size_t a = 0;
    std::size_t b = 0;
    double square = 0.0;  ///< of the length [m^2]
  };

  void applyChanges(const Model& model, const SpringChanges& changes);
  Division divide(const StepLength& length) const;
  void begin(Substep& now, double end, double dt);
  int advance(Substep& now, const Division& division, double startTime);
  void finish(Substep& now, const StepLength& length, double dt, bool isWhole, State& state);
  void loadLimits(const Controls& controls);
  bool isLimitPassed() const;

  std::unique_ptr<SubstepMethod> method_;
  int configured_;  ///< substeps that the scene asks for
  int substeps_;
  Particles particles_;
  SpringConstraints springs_;
  KinematicParticles kinematic_;
  VectorArray force_, scratch_;
  ScalarArray windSpeeds_;
  std::vector<Limit> limits_;
  bool isNewModel_ = true;
  StepReport report_;
};

}  // namespace cloth_sim
