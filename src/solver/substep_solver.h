#pragma once
/// \file What the methods that sweep over packed springs have in common.

#include "cloth_sim/solver/solver.h"
#include "constraints/particles.h"
#include "constraints/spring_schedule.h"

namespace cloth_sim {

/// Packs the state, divides the step into substeps, moves the kinematic particles, sums up
/// reactions and checks the result. A method on top of it says how one substep goes.
class SubstepSolver : public Solver {
 public:
  const StepReport& step(const Model& model, State& state, const Controls& controls,
                         Contacts& contacts, const StepLength& length) final;
  int substeps() const final { return substeps_; }
  void onModelChanged(const Model& model, const ModelChanges& changes) final;
  void save(StateWriter& archive) const final;
  void load(StateReader& archive, const Model& model) final;

 protected:
  SubstepSolver(const Model& model, int substeps);

  /// What a substep may look at.
  struct Substep {
    const Model& model;
    const Controls& controls;
    Contacts& contacts;
    double h = 0.0;         ///< length [s]
    double time = 0.0;      ///< at its end [s]
    double before = 0.0;    ///< fraction of the step that has passed at its start
    double fraction = 0.0;  ///< and at its end
  };

  /// Called once before the substeps of a step; masses and kinematic slots are set.
  virtual void prepare(const Controls& /*controls*/, double /*h*/) {}
  virtual void substep(const Substep& now) = 0;
  /// Called after the last substep, of length h: for methods whose substeps leave no velocities.
  virtual void findVelocities(double /*h*/) {}
  /// Called before `prepare` if the model has a bending energy and that of the last step, if any,
  /// was another one.
  virtual void loadBending(const Model& model) = 0;
  /// How many substeps a step takes from here on, given how many it was configured with; asked
  /// after every edit of the model.
  virtual int substepsFor(const Model& /*model*/, int configured) { return configured; }

  /// See Solver::save and load: for methods that keep more than the places of particles.
  virtual void saveMemory(StateWriter& /*archive*/) const {}
  virtual void loadMemory(StateReader& /*archive*/) {}

  /// Copies positions to `particles_.start`.
  void markStart();
  /// Puts the kinematic particles where they are when `fraction` of the step has passed.
  void placeKinematic(double fraction);
  /// The same for those in the slots [first, last).
  void placeKinematic(double fraction, std::size_t first, std::size_t last);
  /// Sums up how a substep was solved, for methods that iterate.
  void noteIterations(int iterations, double residual) {
    report_.iterations += iterations;
    report_.residual = residual;
  }
  /// Adds `force_` for the time h to the reactions of the kinematic targets.
  void addForcesToReactions(double h);
  /// Adds an impulse [N s] on the particle in a slot to the reaction of its kinematic target, if it
  /// has one.
  void bear(std::size_t slot, const Vec3& impulse) {
    if (targetOf_[slot] != kNone) addReaction(static_cast<std::size_t>(targetOf_[slot]), impulse);
  }
  /// Index of the kinematic target by slot, or kNone.
  const std::vector<std::int32_t>& targetOf() const { return targetOf_; }
  /// Adds an impulse [N s] on the k-th kinematic target to its reaction.
  void addReaction(std::size_t k, const Vec3& impulse) { report_.reactions[k] += impulse; }
  /// Adds the pressure of the wind on every face, and the forces on single particles, to `force_`.
  void addLoads(const Model& model, const Controls& controls);
  /// Pushes particles out of obstacles; their velocities change by the displacement over h.
  void enforceContacts(const Substep& now);
  /// Takes from velocities what would carry particles into obstacles in the next h, and the slip
  /// that friction then stops. Positions stay.
  void enforceContactVelocities(const Substep& now);

  Particles particles_;
  SpringSchedule schedule_;
  VectorArray force_;  ///< [N]; of the last substep that needed it
  /// Slots of the kinematic targets of this step, in their order.
  std::vector<std::int32_t> kinematicSlots_;
  /// True in `prepare` if the set of kinematic particles or the schedule is not that of the last
  /// step.
  bool layoutChanged_ = true;

 private:
  /// What is left of a step.
  struct Rest {
    double dt = 0.0;   ///< [s]
    double end = 0.0;  ///< time [s]
    int substeps = 0;
    double h = 0.0;  ///< length of one [s]
  };
  /// `LengthLimit` by slots.
  struct Limit {
    std::size_t a = 0;
    std::size_t b = 0;
    double square = 0.0;  ///< of the length [m^2]
  };

  Rest restOf(const StepLength& length, double time) const;
  void begin(const Model& model, const Contacts& contacts, const Controls& controls,
             const Rest& rest);
  void loadLimits(const Controls& controls);
  bool passesLimit() const;
  void followModel(const Model& model, const SpringChanges& changes);
  template <typename Visit>
  void forFreeCandidates(const Contacts& contacts, const Visit& visit) const;
  void addWind(const Model& model, const Wind& wind);
  void loadKinematics(const Model& model, const Controls& controls);
  void keepOutOf(const Contacts& contacts, const Controls& controls, const Rest& rest);
  void finishReactions(const Model& model, const Controls& controls, double dt);

  bool bendingChanged_ = true;
  int configured_;  ///< substeps that the scene asked for
  int substeps_;
  StepReport report_;
  std::vector<Limit> limits_;
  VectorArray before_;  ///< positions before contacts are enforced [m]
  VectorArray kinematicFrom_;
  VectorArray kinematicTo_;
  std::vector<double> kinematicMass_;  ///< zeros
  std::vector<VertexId> touching_;     ///< which kinematic targets are near an obstacle
  std::vector<Vec3> kinematicStartVelocity_;
  std::vector<std::int32_t> previousKinematic_;
  std::vector<std::int32_t> targetOf_;
};

}  // namespace cloth_sim
