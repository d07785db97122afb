#include "cloth_sim/cloth/spring_calibration.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// Reference curvature, at which bend springs store the bending energy of the fabric [1/m]; see
/// docs/model.md.
constexpr double kBendCurvature = 50.0;
/// Largest fold angle at the reference curvature [rad]. On coarse grids the reference is a gentler
/// curve: the energy of a bend spring has no meaning for sharper folds.
constexpr double kBendFoldLimit = 1.5;
/// Smallest fraction of the tensile stiffness that structural springs carry, however much shear and
/// bend springs contribute.
constexpr double kStructuralFloor = 0.01;

/// Stiffness of a bend spring per rest area that it represents, 16 B / (l^4 theta^2) [N/m^3].
/// \param rigidity  B [N m].
/// \param l         half of the rest length of the spring [m]; theta is the fold angle of two
///                  segments of this length at the reference curvature.
double bendStiffnessPerArea(double rigidity, double l) {
  const double theta = std::min(l * kBendCurvature, kBendFoldLimit);
  return 16.0 * rigidity / (l * l * l * l * theta * theta);
}

}  // namespace

/// Solves for the structural constants. With shear springs of stiffness G on both diagonals of
/// square cells, the membrane has C11 = q1, C22 = q2 and C12 = G. Its uniaxial stiffness is then
/// K1 = q1 - G^2 / q2 along warp and K2 = q2 - G^2 / q1 along weft. Both follow for
/// q1 = (K1 + sqrt(K1^2 + 4 G^2 K1 / K2)) / 2 and q2 = q1 K2 / K1. The shear springs contribute G
/// to q1 and to q2; structural springs carry the rest.
SpringCalibration::SpringCalibration(const Fabric& fabric, const SpringSelection& selection)
    : shear_(selection.shear ? fabric.shear : 0.0),
      bending_(selection.bend ? fabric.bending : 0.0),
      damping_(fabric.damping),
      bendRetardation_(fabric.bendRetardation()) {
  const double g = shear_;
  const double warp = fabric.tensileWarp;
  const double weft = fabric.tensileWeft;
  const double q = 0.5 * (warp + std::sqrt(warp * warp + 4.0 * g * g * warp / weft));
  structuralWarp_ = std::max(q - g, kStructuralFloor * warp);
  structuralWeft_ = std::max(q * weft / warp - g, kStructuralFloor * weft);
  bendStretchCap_ = 0.5 * std::min(structuralWarp_, structuralWeft_);
}

double SpringCalibration::stiffness(const Spring& spring, const Vec2& d, double area) const {
  const double squared = d.squaredNorm();
  switch (spring.kind) {
    case SpringKind::kStructural: {
      // Bend springs resist stretch too; structural springs carry what is left.
      const double bends = std::min(
          4.0 * squared * bendStiffnessPerArea(bending_, spring.restLength), bendStretchCap_);
      const bool isWarp = spring.direction == ThreadDirection::kWarp;
      return ((isWarp ? structuralWarp_ : structuralWeft_) - bends) * area / squared;
    }
    case SpringKind::kShear: {
      // Under a shear angle gamma, a spring of direction (c, s) has the strain gamma c s. Both
      // diagonals together store G gamma^2 / 2 per area.
      const double cs = d.x() * d.y() / squared;
      return shear_ * area / (2.0 * squared * cs * cs);
    }
    case SpringKind::kBend: {
      const double l = 0.5 * spring.restLength;
      const double lumped = area / 3.0;  // of the vertex that the spring bridges
      return std::min(bendStiffnessPerArea(bending_, l), bendStretchCap_ / (4.0 * l * l)) * lumped;
    }
  }
  return 0.0;
}

}  // namespace cloth_sim
