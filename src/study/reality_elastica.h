#pragma once
/// \file The heavy elastica: plane shapes of an inextensible strip under its own weight, by
/// shooting. Nothing here uses the cloth model, which is compared with it.
///
/// Lengths are in units of the elasto-gravity length l = (B / (rho g))^(1/3) with the rigidity
/// B [N m] and the areal density rho [kg/m^2]. Equilibrium of moments is theta'' = V cos(theta) -
/// H sin(theta), where theta is the slope, V and H the vertical and horizontal force on the strip
/// before s, and V' = -1 (Landau & Lifshitz, Theory of Elasticity, section 19).

namespace cloth_sim {

/// The elasto-gravity length (B / (rho g))^(1/3) [m].
double elastoGravityLength(double bending, double density);

/// Angle below the horizontal of the chord from the clamped edge to the tip of a strip that is
/// clamped level [rad].
/// \param overhang  over l
double cantileverChord(double overhang);

/// The overhang at which the chord is at an angle [rad], over l. By Peirce (1930) and ASTM D1388,
/// it is 2 at 41.5 degrees.
double cantileverOverhang(double chord);

/// A strip that is folded back on itself on a table without friction, its thickness neglected.
struct SoftFold {
  double height = 0.0;    ///< of its top over the table, over l
  double reaction = 0.0;  ///< force of the table where it leaves, over rho g l
};

/// Finds the fold. Where it leaves the table and where it touches down, the curvature is zero, so
/// H = 0: by the first integral theta'^2 / 2 = V sin(theta) - H (cos(theta) - 1) + y, both hold if
/// theta returns to pi at y = 0.
SoftFold findSoftFold();

}  // namespace cloth_sim
