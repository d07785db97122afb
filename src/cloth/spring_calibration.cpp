#include "cloth_sim/cloth/spring_calibration.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// Bend springs store the fabric's bending energy at this curvature [1/m]; see docs/model.md.
constexpr double kBendCurvature = 50.0;
/// ... but at no fold sharper than this [rad], where the spring law loses its meaning.
constexpr double kBendFoldLimit = 1.5;
/// What structural springs keep of the tensile stiffness at least, whatever shear and bend springs
/// already carry.
constexpr double kStructuralFloor = 0.01;

/// Bending constant of a spring over two segments of length `l` that stands for one unit of area:
/// 16 B / (l^4 theta^2) with theta the fold angle at the reference curvature.
double bendStiffnessPerArea(double rigidity, double l) {
  const double theta = std::min(l * kBendCurvature, kBendFoldLimit);
  return 16.0 * rigidity / (l * l * l * l * theta * theta);
}

}  // namespace

/// With shear springs of stiffness G on both diagonals of square cells, the membrane has C11 = q1,
/// C22 = q2, C12 = G, so that its uniaxial stiffness along u is q1 - G^2 / q2 and along v
/// q2 - G^2 / q1. Here are the q that make them the fabric's.
SpringCalibration::SpringCalibration(const Fabric& fabric, const SpringSelection& selection)
    : shear_(selection.shear ? fabric.shear : 0.0),
      bending_(selection.bend ? fabric.bending : 0.0),
      damping_(fabric.damping) {
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
      const double bends = std::min(
          4.0 * squared * bendStiffnessPerArea(bending_, spring.restLength), bendStretchCap_);
      const bool isWarp = spring.direction == ThreadDirection::kWarp;
      return ((isWarp ? structuralWarp_ : structuralWeft_) - bends) * area / squared;
    }
    case SpringKind::kShear: {
      // Under a shear angle gamma a direction (c, s) stretches by gamma c s; both diagonals
      // together store G gamma^2 / 2 per area.
      const double cs = d.x() * d.y() / squared;
      return shear_ * area / (2.0 * squared * cs * cs);
    }
    case SpringKind::kBend: {
      const double l = 0.5 * spring.restLength;
      const double lumped = area / 3.0;
      return std::min(bendStiffnessPerArea(bending_, l), bendStretchCap_ / (4.0 * l * l)) * lumped;
    }
  }
  return 0.0;
}

}  // namespace cloth_sim
