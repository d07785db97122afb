#pragma once
/// \file Bending of strips against the heavy elastica: the cantilever of ASTM D1388, and the height
/// of a soft fold.

#include <string>
#include <vector>

namespace cloth_sim {

/// A fabric with the two numbers that decide how far it bends under its own weight.
struct BendingFabric {
  std::string name;
  double bending = 0.0;  ///< B [N m]
  double density = 0.0;  ///< rho [kg/m^2]
  std::string source;    ///< of both numbers; "chosen" for no fabric in particular
};

/// The fabrics of the cantilever: ten that Wang, O'Brien & Ramamoorthi (2011) measured, two
/// presets, and two that are no fabrics but make the range of B / rho two decades wide.
const std::vector<BendingFabric>& bendingFabrics();

/// Overhang of a strip clamped level at which the chord from the edge of the clamp to the tip is at
/// 41.5 degrees (ASTM D1388) [m]. By regula falsi over runs with different overhangs.
/// \param spacing  of the particles, about [m].
double simulatedOverhang(const BendingFabric& fabric, double spacing);

/// Height of a strip that is folded back on itself on a table without friction and has come to
/// rest [m]. The layers do not touch each other: both lie on the table, as if they had no
/// thickness. \param spacing  of the particles [m].
double simulatedFoldHeight(const BendingFabric& fabric, double spacing);

}  // namespace cloth_sim
