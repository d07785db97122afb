#pragma once
/// \file Inertia that is added where the forces of lines of springs cancel each other.

#include <vector>

#include "substep.h"

namespace cloth_sim {

/// Inertia that is added where the forces of different families of lines cancel each other.
///
/// A substep projects one family of lines after the other. In equilibrium the forces F_f of the
/// families on a particle add up to next to nothing, but each moves it by h^2 F_f / m before the
/// next one moves it back. Where that is no small part of a cell, as beside a pin that bears half
/// of the cloth, the lines find each other out of place, and the cloth is too soft there. So a
/// particle gets the inertia for which the cancelled part of these displacements is `kTolerance` of
/// its shortest spring. Gravity and other loads act as before, so equilibria stay where they are;
/// what changes is how fast these few particles accelerate (selective mass scaling, Olovsson,
/// Simonsson & Unosson 2005).
class AddedInertia {
 public:
  /// Follows the model: which particles there are, and their shortest springs.
  void layOut(const Model& model, const Particles& p);
  /// Prepares for substeps of length h [s]. The inertia that is needed grows with the square of h,
  /// so longer ones than those that it was found for begin with as much more of it.
  void setStep(double h);
  /// Finds the least inertia of particles between tight threads, for substeps of length h [s] in
  /// quasi-static motion.
  ///
  /// Threads pull in the directions that they have at the start of a projection. So transverse
  /// vibration of angular frequency w is integrated explicitly: it is unstable at h w > 2, and the
  /// seam of a pull tears early at h w = 1.4. The Gershgorin bound of the geometric stiffness gives
  /// w^2 <= 2 sum(T / l) / m, over the tensions T and lengths l of the springs at a particle of
  /// inertia m; neighbours that move against each other reach it. With this inertia h w is at
  /// most 1.
  void followTension(const Model& model, const Particles& p, double h);
  /// Finds the inertia of each particle; 0 if it is held.
  void find(const Particles& p);
  /// Updates the inertia that is needed, as far as it does not resist motion.
  /// \param h          length of the substep [s].
  /// \param duration   since the last update [s].
  /// \param cancelled  displacement of each particle by lines in vain [m], by particle slot.
  void update(double h, double duration, const Particles& p, const ScalarArray& cancelled);
  /// The same, while motion is quasi-static: inertia may resist it, and has the bound of tight
  /// threads.
  /// \param h          length of the substep, and time since the last update [s].
  /// \param hasLayers  whether layers may touch: what they displace in vain is not in `cancelled`,
  ///                   so that more inertia is needed.
  void updateQuasiStatic(double h, bool hasLayers, const Particles& p,
                         const ScalarArray& cancelled);
  /// Returns what is added to all particles, over their mass [-].
  double addedFraction(const Particles& p) const;
  /// The largest displacement in vain of a free particle over its shortest spring [-].
  double largestFraction(const ScalarArray& cancelled) const;
  /// [1/kg], by particle slot; 0: held.
  const ScalarArray& inverse() const { return inverse_; }
  /// The inertia of all particles, those without added inertia too [kg], by slot; 0: held.
  const ScalarArray& whole() const { return whole_; }
  /// Slots of the particles with added inertia, ascending.
  const std::vector<std::int32_t>& heavier() const { return heavier_; }
  /// Tells whether there is a value for each slot, or for fewer: those of new particles follow.
  bool fits(std::size_t slots) const;

  /// Writes what is remembered from step to step.
  void save(StateWriter& archive) const;
  void load(StateReader& archive);

 private:
  struct Kernel;

  ScalarArray inertia_;       ///< by particle slot [kg]; below the mass: nothing is added
  VectorArray velocity_;      ///< by particle slot, at the last update [m/s]
  VectorArray acceleration_;  ///< by particle slot, averaged [m/s^2]
  double step_ = 0.0;         ///< length of substeps that need it [s]; 0: none has been found
  ScalarArray least_;         ///< by particle slot, while motion is quasi-static [kg]
  ScalarArray shortest_;      ///< by particle slot: rest length [m]
  ScalarArray inverse_;
  ScalarArray whole_;
  std::vector<std::int32_t> heavier_;
};

}  // namespace cloth_sim
