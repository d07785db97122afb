#pragma once
/// \file The springs of a cloth, as methods use them.

#include "particles.h"
#include "spring_hessian.h"
#include "spring_projection.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// All springs: as constraints to project, as forces, and linearised. Every operation visits them
/// in the order of one schedule, so its result is the same on any number of threads.
class SpringConstraints {
 public:
  using Element = SpringSchedule::Element;

  /// \param slotOf  particle slot by vertex.
  SpringConstraints(const Model& model, const std::vector<std::int32_t>& slotOf) {
    schedule_.build(model, slotOf);
  }
  /// Follows an edit of the model; `slotOf` as it is afterwards.
  void applyChanges(const Model& model, const SpringChanges& changes,
                    const std::vector<std::int32_t>& slotOf) {
    schedule_.applyChanges(model, changes, slotOf);
  }

  // Projection (extended position-based dynamics, reference_projection.h):

  /// To be called before `project` when springs, masses or the length of the substep have changed.
  /// \param inverseMass   by particle slot [1/kg].
  /// \param h             length of the substep [s].
  /// \param isNewLayout   springs or masses have changed, not only h.
  void prepareProjection(const ScalarArray& inverseMass, double h, bool isNewLayout) {
    if (isNewLayout) projection_.setMasses(schedule_, inverseMass);
    projection_.setStep(schedule_, inverseMass, h);
  }
  /// Projects every spring once (one Gauss-Seidel sweep). Moves `particles.x`.
  void project(Particles& particles) { projection_.project(schedule_, particles); }

  // Forces (spring_forces.h):

  /// force += -(k (l - l0) + c dl/dt) along each spring [N].
  void addForces(const VectorArray& x, const VectorArray& v, VectorArray& force) const;
  /// Adds the force of one spring.
  static void addForce(const Element& spring, const VectorArray& x, const VectorArray& v,
                       VectorArray& force);
  /// Elastic energy, and tau times half of the power that dashpots take [J].
  double potential(const VectorArray& x, const VectorArray& v, double tau) const;

  // Linearised (spring_hessian.h):

  /// Linearises all springs at positions x, for `multiply` and `addDiagonalBlocks`.
  /// \param elastic, viscous  factors of stiffnesses and dashpots.
  void linearise(const VectorArray& x, double elastic, double viscous) {
    hessian_.linearise(schedule_, x, elastic, viscous);
  }
  /// q += H p, H the matrix of the linearised springs.
  void multiply(const VectorArray& p, VectorArray& q) const {
    hessian_.addProduct(schedule_, p, q);
  }
  void addDiagonalBlocks(SymmetricBlocks& blocks) const {
    hessian_.addDiagonalBlocks(schedule_, blocks);
  }

  // Visits:

  /// Calls `visit(element)` for every spring, on this thread.
  template <typename Visit>
  void forEach(const Visit& visit) const {
    schedule_.forEach(visit);
  }
  /// Calls `visit(element)` for every spring, one colour after the other, on all threads.
  template <typename Visit>
  void sweep(const Visit& visit) const {
    schedule_.sweep(visit);
  }
  /// Tells whether some spring has a dashpot.
  bool areDamped() const { return schedule_.parameters.damped(); }
  /// Number of places for springs, gone ones included.
  std::int32_t size() const { return schedule_.size(); }
  const SpringSchedule& schedule() const { return schedule_; }

 private:
  SpringSchedule schedule_;
  SpringProjection projection_;
  SpringHessian hessian_;
};

}  // namespace cloth_sim
