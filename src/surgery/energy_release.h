#pragma once
/// \file The energy that an advancing tear releases, and the direction of the advance.

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// Returns the material force on the tip of a tear (Eshelby 1951), material coordinates [J/m]: its
/// component along any direction is the energy that springs and loads would release per length by
/// which the tip advances there, the J-integral.
///
/// It is integrated over the faces around the tip with a weight q that falls from 1 to 0 (the
/// domain integral of Shih, Moran & Nakamura 1986):
///   J = - integral of (W I - F^T P) grad q dA,
/// with the energy W per area, the deformation gradient F and the first Piola-Kirchhoff stress P.
/// The stress is that of the springs; each acts on the faces that it represents. The result does
/// not depend on the domain where cloth is at rest, and holds for large rotations: of two legs that
/// are torn apart by a force F each it is 2 F.
/// \param tip  end of a tear or cut, on the border.
Vec2 materialForce(const Model& model, const State& state, VertexId tip);

/// An advance of a tear: the direction in which it releases most for what it takes.
struct TearAdvance {
  Vec2 direction = Vec2::Zero();  ///< material coordinates, unit length
  double load = 0.0;              ///< energy released over energy taken; >= 1: the tear advances
};

/// Returns the advance that a material force drives (the maximum of the energy release rate over
/// the fracture energy; for an isotropic fabric along the force, as Guerses & Miehe 2009).
TearAdvance mostDrivenAdvance(const Vec2& force, const TearEnergy& energy);

}  // namespace cloth_sim
