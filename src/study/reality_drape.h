#pragma once
/// \file The drape test of Cusick (1968): a disc of cloth of 30 cm is held between discs of 18 cm,
/// and what hangs over is measured by its shadow.

#include <string>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A fabric in the drape tester.
struct DrapeFabric {
  std::string name;
  double bending = 0.0;     ///< B [N m]
  double density = 0.0;     ///< [kg/m^2]
  double shear = 0.0;       ///< in-plane shear stiffness G [N/m]
  double hysteresis = 0.0;  ///< 2HB [N]
};

/// The mesh of the disc (makeDisc).
struct DrapeMesh {
  double side = 0.0;  ///< of its triangles [m]
  double turn = 0.0;  ///< of its rings
};

/// A drape at rest.
struct Drape {
  int start = 0;             ///< number of small folds with which the flat disc was released
  double coefficient = 0.0;  ///< area of the shadow of the overhang over its flat area [%]
  int folds = 0;             ///< of the rim, as seen from above
  double energy = 0.0;       ///< of bending, stretch and height, over that of the flat disc [J]
  bool isAtRest = false;
  std::vector<Vec2> rim;  ///< from above, by angle [m]
};

/// Releases the disc with a wave of a number of folds on it. Which folds remain depends on how it
/// was released, as with a cloth: of several starts, that of least energy is the drape. With
/// friction in bending the disc also comes to rest elsewhere than where its energy is least.
///
/// The inner disc is held rigid, as between the discs of the tester: up to half a ring beyond the
/// edge, so that the clamp begins at the edge (docs/model.md). On triangles, springs of the warp
/// and the weft resist shear, too. The shear stiffness of the fabric is therefore set so that an
/// even shear of the disc stores G angle^2 / 2 per area.
Drape simulateDrape(const DrapeFabric& fabric, const DrapeMesh& mesh, int start);

/// Counts the maxima of a rim that stand out by more than a millimetre.
int countFolds(const std::vector<Vec2>& rim);

}  // namespace cloth_sim
