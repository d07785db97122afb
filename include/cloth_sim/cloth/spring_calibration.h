#pragma once
/// \file How stiff springs are that together behave like a fabric.

#include "cloth_sim/cloth/fabric.h"
#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {

/// Which springs a scene asks for.
struct SpringSelection {
  bool shear = true;
  bool bend = true;
};

/// Stiffness follows from the fabric and the rest area that a spring stands for (Van Gelder 1998),
/// calibrated so that the uniaxial stiffness of a square grid is the fabric's in both thread
/// directions, shear and bend springs included. See docs/model.md for the derivation.
class SpringCalibration {
 public:
  SpringCalibration() = default;
  SpringCalibration(const Fabric& fabric, const SpringSelection& selection);

  /// [N/m]
  /// \param spring  of known kind, direction and rest length.
  /// \param d       from end to end, in material coordinates [m].
  /// \param area    of the faces that it stands on, undeformed [m^2].
  double stiffness(const Spring& spring, const Vec2& d, double area) const;
  /// Retardation time of springs [s].
  double damping() const { return damping_; }

 private:
  // Membrane constants that the springs of a square grid need [N/m], and what bends need.
  double structuralWarp_ = 0.0;
  double structuralWeft_ = 0.0;
  double shear_ = 0.0;
  double bending_ = 0.0;         ///< [N m]
  double bendStretchCap_ = 0.0;  ///< most that bend springs may add to the tensile stiffness [N/m]
  double damping_ = 0.0;         ///< [s]
};

}  // namespace cloth_sim
