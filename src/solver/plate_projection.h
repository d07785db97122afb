#pragma once
/// \file Bending of a plate in position-based methods.

#include "constraints/bend_friction.h"
#include "constraints/bend_projection.h"
#include "linalg/bend_matrix.h"
#include "substep.h"

namespace cloth_sim {

/// Bending of a plate, for methods that project constraints.
///
/// Where bending is soft, the impulses h^2 W K y of all elements at the predicted positions y are
/// given at once; K is their stiffness matrix and W the inverse inertia. That takes the forces of
/// bending as they are, and is stable where it moves no mode by much more than its amplitude. Where
/// bending is stiffer, on fine grids, a polynomial of W K takes the place of W K
/// (ImpulsePolynomial): the same for waves that are slower than a substep. Single elements that are
/// stiffer still, beside cuts, and all where bending has friction, are projected one after the
/// other with their compliance, which is stable for any stiffness, and too soft.
class PlateProjection {
 public:
  bool empty() const { return !hasBending_; }
  /// Follows what depends on the model. A model without bending energy takes no time.
  void build(const Substep& now);
  /// Prepares for substeps, and for the particles that are held.
  /// \param lag  dashpot over stiffness that is added to that of the fabric [s]; less of it where
  ///             the polynomial would have to be of a higher degree.
  void setStep(Substep& now, double lag);
  /// Gives the impulse, with friction if there is any, and adds what held particles bear.
  /// \param inverseInertia  of each particle [1/kg]; 0: held.
  void project(const ScalarArray& inverseInertia, Substep& now);

 private:
  bool isSplitFor(double h) const;
  void split(const Substep& now, double h);
  double softLimit(std::vector<double> circles, double h) const;
  double lagWithin(double limit, double h, double lag) const;
  double impulseOf(double circle, double h) const;
  void displace(const ScalarArray& inverseInertia, Substep& now);
  const VectorArray& smooth(const ScalarArray& inverseInertia, const VectorArray& at);

  BendMatrix soft_;
  BendProjection stiff_;
  BendFriction friction_;
  BendStep step_;  ///< that all are prepared for
  ImpulsePolynomial polynomial_{1};
  VectorArray smooth_;      ///< z_j of its recurrence, by slot
  VectorArray before_;      ///< z_{j-1}
  double softest_ = 0.0;    ///< largest circle of the elements of `soft_` [1/s^2]
  double splitStep_ = 0.0;  ///< longest substep that elements are divided for [s]; 0: none
  bool hasBending_ = false;
};

}  // namespace cloth_sim
