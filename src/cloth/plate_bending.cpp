#include "cloth_sim/cloth/plate_bending.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "cloth_sim/cloth/bend_friction.h"

namespace cloth_sim {
namespace {

/// Singular values below this fraction of the largest count as zero: the points around the face do
/// not determine the curvature in that direction.
constexpr double kSingular = 1e-3;
/// Weights below this fraction of the largest count as rounding errors of zero.
constexpr double kRounding = 1e-10;

/// The points that determine the quadratic over a face.
struct Patch {
  std::array<VertexId, 6> vertex;  ///< corners of the face, then the far corners of its neighbours
  int neighbours = 0;
};

/// Collects the patch of a face. Missing neighbours leave kNone at the end.
Patch patchAround(const TriangleMesh& mesh, FaceId f) {
  const Face& face = mesh.face(f);
  Patch patch{{face[0], face[1], face[2], kNone, kNone, kNone}, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexId a = face[k];
    const VertexId b = face[(k + 1) % 3];
    const std::array<FaceId, 2> sides = mesh.facesOnEdge(a, b);
    const FaceId other = sides[0] == f ? sides[1] : sides[0];
    if (other == kNone) continue;
    patch.vertex[static_cast<std::size_t>(3 + patch.neighbours++)] =
        mesh.oppositeVertex(other, a, b);
  }
  return patch;
}

/// Returns the barycentric coordinates of q in the triangle of the first three points of a patch.
Vec3 barycentric(const std::array<Vec2, 6>& p, const Vec2& q) {
  Eigen::Matrix2d edges;
  edges << p[1] - p[0], p[2] - p[0];
  const Vec2 l = edges.inverse() * (q - p[0]);
  return Vec3(1.0 - l.x() - l.y(), l.x(), l.y());
}

/// Evaluates u^2/2, v^2/2 and u v/sqrt(2) at q, less their linear interpolation over the face: the
/// distance of q from the plane of the face per unit of x_uu, x_vv and sqrt(2) x_uv.
/// \param l  barycentric coordinates of q in the face.
Vec3 deviations(const std::array<Vec2, 6>& p, const Vec2& q, const Vec3& l) {
  const auto monomials = [](const Vec2& at) {
    return Vec3(0.5 * at.x() * at.x(), 0.5 * at.y() * at.y(), M_SQRT1_2 * at.x() * at.y());
  };
  return monomials(q) - l[0] * monomials(p[0]) - l[1] * monomials(p[1]) - l[2] * monomials(p[2]);
}

/// Expresses x_uu, x_vv and sqrt(2) x_uv as weighted sums of the points of a patch.
///
/// The distances of the neighbours' far corners from the plane of the face are linear in the three
/// derivatives (`geometry`), and linear in the points (`offPlane`). The least-squares solution of
/// least norm inverts the former; it is unique with three neighbours in general position, and else
/// the one of least bending energy.
/// \return one row of weights for each derivative, (3, 6) [1/m^2]; zero on a face with hardly an
///         area, where they are not finite.
Eigen::Matrix<double, 3, 6> curvatureWeights(const std::array<Vec2, 6>& p, int neighbours) {
  Eigen::MatrixXd geometry(neighbours, 3);
  Eigen::MatrixXd offPlane = Eigen::MatrixXd::Zero(neighbours, 6);
  for (int k = 0; k < neighbours; ++k) {
    const Vec2& q = p[static_cast<std::size_t>(3 + k)];
    const Vec3 l = barycentric(p, q);
    geometry.row(k) = deviations(p, q, l).transpose();
    offPlane.block<1, 3>(k, 0) = -l.transpose();
    offPlane(k, 3 + k) = 1.0;
  }
  // Eigen 3.4 reads beyond the end of its arrays otherwise.
  if (!geometry.allFinite() || !offPlane.allFinite()) return Eigen::Matrix<double, 3, 6>::Zero();
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(geometry, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kSingular);
  return svd.solve(offPlane);
}

/// Makes an element of those vertices of a patch that have a weight, in ascending order.
/// \param least  weights of this magnitude or less count as zero.
PlateElement makeElement(const Patch& patch, const Eigen::Matrix<double, 1, 6>& weights,
                         double least, double stiffness) {
  PlateElement element;
  element.vertex.fill(kNone);
  element.weight.fill(0.0);
  std::array<std::size_t, 6> order{0, 1, 2, 3, 4, 5};
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return patch.vertex[a] < patch.vertex[b]; });
  for (const std::size_t k : order) {
    const double weight = weights[static_cast<Eigen::Index>(k)];
    if (patch.vertex[k] == kNone || std::abs(weight) <= least) continue;
    const auto last = static_cast<std::size_t>(element.count - 1);
    if (element.count > 0 && element.vertex[last] == patch.vertex[k]) {
      element.weight[last] += weight;  // two neighbours share their far corner
      continue;
    }
    element.vertex[static_cast<std::size_t>(element.count)] = patch.vertex[k];
    element.weight[static_cast<std::size_t>(element.count++)] = weight;
  }
  element.stiffness = element.count > 0 ? stiffness : 0.0;
  return element;
}

}  // namespace

PlateBending::PlateBending(const TriangleMesh& mesh, double rigidity, double maxStiffness)
    : PlateBending(mesh, MaterialStrips(), {{rigidity, maxStiffness}}) {}

PlateBending::PlateBending(const TriangleMesh& mesh, MaterialStrips strips,
                           std::vector<Plate> plates)
    : strips_(std::move(strips)), plates_(std::move(plates)) {
  if (plates_.size() != strips_.count()) {
    throw std::invalid_argument("bending needs one plate for each cloth");
  }
  derive(mesh);
}

void PlateBending::derive(const TriangleMesh& mesh) {
  resize(mesh);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) deriveOn(mesh, f);
}

void PlateBending::resize(const TriangleMesh& mesh) {
  elements_.resize(kPerFace * static_cast<std::size_t>(mesh.faceCount()));
  if (hasFriction()) slip_.resize(static_cast<std::size_t>(mesh.faceCount()));
}

bool PlateBending::hasFriction() const {
  return std::any_of(plates_.begin(), plates_.end(), [](const Plate& plate) {
    return plate.hysteresis > 0.0 && plate.rigidity > 0.0;
  });
}

std::string PlateBending::slipError(std::int32_t faces) const {
  if (slip_.size() != (hasFriction() ? static_cast<std::size_t>(faces) : 0U)) {
    return "friction in bending is not one for each face";
  }
  const bool areStiff = std::all_of(slip_.begin(), slip_.end(),
                                    [](double it) { return it >= 0.0 && std::isfinite(it); });
  return areStiff ? "" : "friction in bending is negative";
}

/// Replaces the three elements of a face.
void PlateBending::deriveOn(const TriangleMesh& mesh, FaceId f) {
  const Patch patch = patchAround(mesh, f);
  const Plate& plate = plates_[strips_.at(mesh.material(patch.vertex[0]))];
  std::array<Vec2, 6> p;
  // Coordinates relative to the first corner, as squares would lose digits far from the origin.
  const Vec2& origin = mesh.material(patch.vertex[0]);
  for (std::size_t k = 0; k < p.size(); ++k) {
    p[k] = patch.vertex[k] == kNone ? Vec2::Zero() : Vec2(mesh.material(patch.vertex[k]) - origin);
  }
  Eigen::Matrix<double, 3, 6> weights = Eigen::Matrix<double, 3, 6>::Zero();
  if (patch.neighbours > 0 && plate.rigidity > 0.0) weights = curvatureWeights(p, patch.neighbours);
  const double stiffness = scale_ * plate.rigidity * mesh.restArea(f);
  const double most = scale_ * plate.maxStiffness;
  const double least = kRounding * weights.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < kPerFace; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double largest = weights.row(row).cwiseAbs().maxCoeff();
    const double capped = largest > 0.0 ? std::min(stiffness, most / (largest * largest)) : 0.0;
    elements_[kPerFace * static_cast<std::size_t>(f) + k] =
        makeElement(patch, weights.row(row), least, capped);
  }
  if (!slip_.empty()) slip_[static_cast<std::size_t>(f)] = slipStiffnessOn(f, plate);
}

/// Half of 2HB over the curvature of slip, times the area; less by as much as the elements are
/// capped.
double PlateBending::slipStiffnessOn(FaceId f, const Plate& plate) const {
  if (plate.rigidity == 0.0) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < kPerFace; ++k) {
    const PlateElement& element = elements_[kPerFace * static_cast<std::size_t>(f) + k];
    if (element.count > 0) least = std::min(least, element.stiffness);
  }
  if (!std::isfinite(least)) return 0.0;
  return 0.5 * plate.hysteresis / (SlipElement::kSlipCurvature * plate.rigidity) * least;
}

void PlateBending::applyChanges(const TriangleMesh& mesh, const MeshChanges& changes) {
  if (empty()) return;
  if (!changes.removedFaces.empty()) {
    derive(mesh);
    return;
  }
  resize(mesh);
  // Elements also depend on the far corners of the neighbours, so all faces around the corners of
  // a reshaped face change.
  std::vector<VertexId> around = changes.touched;
  for (FaceId f : changes.reshapedFaces) {
    around.insert(around.end(), mesh.face(f).begin(), mesh.face(f).end());
  }
  std::vector<FaceId> faces;
  for (VertexId v : around) {
    faces.insert(faces.end(), mesh.facesAround(v).begin(), mesh.facesAround(v).end());
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  for (FaceId f : faces) deriveOn(mesh, f);
}

void PlateBending::scaleBy(double factor) {
  scale_ *= factor;
  for (PlateElement& element : elements_) element.stiffness *= factor;
  for (double& stiffness : slip_) stiffness *= factor;
}

double PlateBending::energy(const std::vector<Vec3>& x) const {
  double sum = 0.0;
  for (const PlateElement& element : elements_) {
    Vec3 curvature = Vec3::Zero();
    for (int k = 0; k < element.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      curvature += element.weight[i] * x[static_cast<std::size_t>(element.vertex[i])];
    }
    sum += 0.5 * element.stiffness * curvature.squaredNorm();
  }
  return sum;
}

}  // namespace cloth_sim
