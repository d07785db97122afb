#pragma once
/// \file Friction between the yarns of bent cloth: a Coulomb slip element beside the bending
/// energy.

#include "cloth_sim/cloth/plate_bending.h"

namespace cloth_sim {

/// The slip element of one face. Cloth that is bent and released keeps a part of its curvature,
/// because its yarns rub on each other; Kawabata's tester measures the moment of that as half the
/// distance between bending and unbending, 2HB.
///
/// A spring and a Coulomb slider in series (Jenkin's element, the simplest of Prandtl's models) are
/// parallel to the bending energy. Per rest area, the spring has the energy
///     psi = B_s / 2 |c - z|^2,   B_s = HB / kSlipCurvature,   |c - z| <= kSlipCurvature
/// of the signed curvatures c and of where the slider is, z, which moves along with c as soon as
/// the moment B_s |c - z| would exceed HB. Friction of the yarns as in Ngo-Ngoc & Boivin (2004) and
/// Miguel et al. (2013), who use Dahl's rounder law.
///
/// c are the components of the curvature vectors of PlateBending along the normal of the face,
/// (x_uu, x_vv, sqrt(2) x_uv) . n. Their norm is the curvature of a cylinder that is rolled in any
/// direction, so the friction does not depend on the direction. They do not change in rigid motion,
/// so forces along their gradients exert no torque in sum.
struct SlipElement {
  /// Distance of the curvature from where the slider is at which it slips [1/m]: a twentieth of
  /// the largest curvature of Kawabata's tester.
  static constexpr double kSlipCurvature = 12.5;

  /// Vertices, or slots of particles; the first three are the corners of the face.
  std::array<std::int32_t, PlateElement::kMostVertices> vertex;
  std::array<Vec3, PlateElement::kMostVertices> weight;  ///< by vertex, of each curvature [1/m^2]
  std::size_t count = 0;                                 ///< of vertices; 0: no friction here
  double stiffness = 0.0;                                ///< B_s times the area [N m^3]

  /// Energy of the spring [J].
  /// \param stretched  c - z, as it is or would be without slip [1/m].
  double energy(const Vec3& stretched) const {
    return 0.5 * stiffness * withoutSlip(stretched).squaredNorm();
  }
  /// Incremental potential of a step in which the slider may slip [J]: its gradient by c is the
  /// moment. It is the energy plus what slip dissipates in the step.
  double potential(const Vec3& stretched) const {
    const double size = stretched.norm();
    return size <= kSlipCurvature ? 0.5 * stiffness * size * size
                                  : stiffness * kSlipCurvature * (size - 0.5 * kSlipCurvature);
  }
  /// Returns c - z after the slider has slipped as far as it must [1/m].
  static Vec3 withoutSlip(const Vec3& stretched) {
    const double size = stretched.norm();
    return size <= kSlipCurvature ? stretched : Vec3(kSlipCurvature / size * stretched);
  }
  /// Returns z after slip [1/m]; without slip, to the bit what it was.
  static Vec3 slipped(const Vec3& curvature, const Vec3& z) {
    const Vec3 stretched = curvature - z;
    const double size = stretched.norm();
    return size <= kSlipCurvature ? z : Vec3(curvature - kSlipCurvature / size * stretched);
  }
};

/// Makes the slip element of a face.
SlipElement slipElement(const PlateBending& bending, const TriangleMesh& mesh, FaceId f);

/// The signed curvatures of a face and how they depend on the positions.
struct SignedCurvature {
  Vec3 value = Vec3::Zero();   ///< c [1/m]
  Vec3 normal = Vec3::Zero();  ///< of the face; zero if it has no area
  /// By vertex: the gradient of c[k] is gradient[i][k] times the normal [1/m^2]. The normal turns
  /// with the corners, which takes the curvature along the surface out of it.
  std::array<Vec3, PlateElement::kMostVertices> gradient;
};

/// Evaluates the curvatures of a face.
/// \param at  at(vertex) is its position [m].
template <typename Positions>
SignedCurvature signedCurvature(const SlipElement& element, const Positions& at) {
  SignedCurvature result;
  std::array<Vec3, PlateElement::kMostVertices> x;
  for (std::size_t i = 0; i < element.count; ++i) x[i] = at(element.vertex[i]);
  const Vec3 across = (x[1] - x[0]).cross(x[2] - x[0]);
  const double area = across.norm();  // twice that of the face
  if (area == 0.0) {
    result.gradient.fill(Vec3::Zero());
    return result;
  }
  result.normal = across / area;
  Eigen::Matrix3d vectors = Eigen::Matrix3d::Zero();  // column k: the curvature vector k
  for (std::size_t i = 0; i < element.count; ++i) {
    vectors += x[i] * element.weight[i].transpose();
    result.gradient[i] = element.weight[i];
  }
  result.value = vectors.transpose() * result.normal;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 opposite = x[(i + 2) % 3] - x[(i + 1) % 3];
    result.gradient[i] -= vectors.transpose() * (result.normal.cross(opposite) / area);
  }
  return result;
}

/// Returns the energy of the springs of all slip elements [J].
/// \param x  positions, (vertexCount,) [m].
/// \param z  where the sliders are, (faceCount,) [1/m].
double slipEnergy(const PlateBending& bending, const TriangleMesh& mesh, const std::vector<Vec3>& x,
                  const std::vector<Vec3>& z);

}  // namespace cloth_sim
