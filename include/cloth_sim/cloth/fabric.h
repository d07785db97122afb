#pragma once
/// \file Fabrics: the material parameters of cloth, in SI units that do not depend on the mesh.

#include <cmath>
#include <string>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Energy that a tear takes per length by which it advances (the fracture energy of Griffith). A
/// trouser tear of inextensible legs then needs half of it as its force.
struct TearEnergy {
  double warp = 0.0;  ///< of tears along v, which break warp threads [J/m], >= 0; 0: not known
  double weft = 0.0;  ///< of tears along u, which break weft threads [J/m], >= 0; 0: not known
  /// Of tears at 45 degrees to the threads [J/m]. With the mean of warp and weft, equal threads
  /// make an isotropic fabric. A woven one has more, up to sqrt(2) times that mean, as such tears
  /// break threads of both directions; tears then tend to follow the threads.
  double bias = 0.0;

  /// Makes energies whose bias is the mean of warp and weft.
  static TearEnergy of(double warp, double weft) { return {warp, weft, 0.5 * (warp + weft)}; }

  bool isKnown() const { return warp > 0.0 && weft > 0.0 && bias > 0.0; }
  /// Returns the energy per length of a tear in any direction [J/m]:
  /// warp sin^2 + weft cos^2 + (bias - (warp + weft) / 2) |sin 2|, of the angle to u.
  /// \param direction  of the tear, material coordinates, unit length.
  double along(const Vec2& direction) const {
    const Vec2 square = direction.cwiseAbs2();
    return warp * square.y() + weft * square.x() +
           2.0 * (bias - 0.5 * (warp + weft)) * std::abs(direction.x() * direction.y());
  }
};

/// Parameters of a woven or knitted fabric, modelled as a linear orthotropic membrane with bending
/// and Kelvin-Voigt damping. Defaults are those of the preset "cotton".
struct Fabric {
  std::string name = "custom";
  double arealDensity = 0.1036;  ///< mass per area [kg/m^2], > 0
  double tensileWarp = 4501.0;   ///< uniaxial membrane stiffness along u [N/m], > 0
  double tensileWeft = 2800.0;   ///< uniaxial membrane stiffness along v [N/m], > 0
  double shear = 97.0;           ///< in-plane shear stiffness [N/m], >= 0
  double bending = 5e-6;         ///< bending rigidity [N m], >= 0
  /// Moment per width between bending and unbending, Kawabata's 2HB [N], >= 0. Presets have none,
  /// even where it was measured (FabricSheet): it costs time, and few fabrics have a value.
  double bendingHysteresis = 0.0;
  double damping = 0.0;         ///< retardation time: dashpot over stiffness [s], >= 0
  double bendingDamping = 0.0;  ///< of bending, beyond `damping` [s], >= 0
  double friction = 0.3;        ///< Coulomb coefficient where an obstacle names none, >= 0
  double thickness = 0.18e-3;   ///< [m]; particles rest half of it above a surface, >= 0
  std::string source;           ///< reference for the values
  TearEnergy tearEnergy{15.0, 15.0, 21.0};  ///< that tears take, where they are decided by energy

  /// Retardation time of bending [s].
  double bendRetardation() const { return damping + bendingDamping; }
};

/// Returns the names of the built-in fabrics, sorted.
std::vector<std::string> fabricPresetNames();

/// Returns a built-in fabric.
/// \throws std::invalid_argument that lists the presets if `name` is not one of them.
Fabric fabricPreset(const std::string& name);

}  // namespace cloth_sim
