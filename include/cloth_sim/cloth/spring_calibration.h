#pragma once
/// \file Spring stiffnesses with which a network behaves like a given fabric.

#include "cloth_sim/cloth/fabric.h"
#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {

/// The kinds of springs that a scene asks for; structural springs are always there.
struct SpringSelection {
  bool shear = true;
  bool bend = true;
};

/// Computes the stiffness of a spring from the fabric and the rest area that the spring represents
/// (Van Gelder 1998, Approximate simulation of elastic membranes by triangulated spring meshes).
/// It is calibrated such that a square grid has the fabric's uniaxial stiffness along warp and
/// weft, with shear and bend springs included. docs/model.md has the derivation.
class SpringCalibration {
 public:
  SpringCalibration() = default;
  SpringCalibration(const Fabric& fabric, const SpringSelection& selection);

  /// Returns the stiffness of a spring [N/m].
  /// \param spring  with kind, direction and rest length set.
  /// \param d       vector from end to end, in material coordinates [m].
  /// \param area    rest area of the faces that the spring represents [m^2].
  double stiffness(const Spring& spring, const Vec2& d, double area) const;
  /// Retardation time of springs of a kind: dashpot over stiffness [s].
  double damping(SpringKind kind) const {
    return traitsOf(kind).isMembrane ? damping_ : bendRetardation_;
  }

 private:
  double structuralWarp_ = 0.0;   ///< q1 of the square grid minus shear: see the constructor [N/m]
  double structuralWeft_ = 0.0;   ///< q2 minus shear [N/m]
  double shear_ = 0.0;            ///< G [N/m]; 0 without shear springs
  double bending_ = 0.0;          ///< B [N m]; 0 without bend springs
  double bendStretchCap_ = 0.0;   ///< limit of what bend springs add to the tensile stiffness [N/m]
  double damping_ = 0.0;          ///< of membrane springs [s]
  double bendRetardation_ = 0.0;  ///< [s]
};

}  // namespace cloth_sim
