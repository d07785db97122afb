#include "cloth_sim/cloth/plate_bending.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace cloth_sim {
namespace {

/// Singular values this much smaller than the largest say nothing about the curvature.
constexpr double kBlind = 1e-3;
/// Weights this much smaller than the largest are rounding.
constexpr double kRounding = 1e-10;

/// The corners of a face, then the far corners of its neighbours.
struct Patch {
  std::array<VertexId, 6> vertex;
  int neighbours = 0;
};

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

/// Barycentric coordinates of q in the triangle of the first three points of a patch.
Vec3 barycentric(const std::array<Vec2, 6>& p, const Vec2& q) {
  Eigen::Matrix2d edges;
  edges << p[1] - p[0], p[2] - p[0];
  const Vec2 l = edges.inverse() * (q - p[0]);
  return Vec3(1.0 - l.x() - l.y(), l.x(), l.y());
}

/// How u^2/2, v^2/2 and u v/sqrt(2) deviate at q from their linear interpolation over the face:
/// how far q lies off the plane of the face at unit x_uu, x_vv and sqrt(2) x_uv.
Vec3 deviations(const std::array<Vec2, 6>& p, const Vec2& q, const Vec3& l) {
  const auto monomials = [](const Vec2& at) {
    return Vec3(0.5 * at.x() * at.x(), 0.5 * at.y() * at.y(), M_SQRT1_2 * at.x() * at.y());
  };
  return monomials(q) - l[0] * monomials(p[0]) - l[1] * monomials(p[1]) - l[2] * monomials(p[2]);
}

/// Rows: x_uu, x_vv and sqrt(2) x_uv as weights of the vertices of a patch; of all that fit, those
/// of the least sum of squares.
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
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(geometry, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kBlind);
  return svd.solve(offPlane);
}

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
      element.weight[last] += weight;  // two neighbours with one far corner
      continue;
    }
    element.vertex[static_cast<std::size_t>(element.count)] = patch.vertex[k];
    element.weight[static_cast<std::size_t>(element.count++)] = weight;
  }
  element.stiffness = element.count > 0 ? stiffness : 0.0;
  return element;
}

}  // namespace

PlateBending::PlateBending(const TriangleMesh& mesh, double rigidity, double most)
    : PlateBending(mesh, MaterialStrips(), {{rigidity, most}}) {}

PlateBending::PlateBending(const TriangleMesh& mesh, MaterialStrips strips,
                           std::vector<Plate> plates)
    : strips_(std::move(strips)), plates_(std::move(plates)) {
  if (plates_.size() != strips_.count()) {
    throw std::invalid_argument("bending needs one plate for each strip");
  }
  derive(mesh);
}

void PlateBending::derive(const TriangleMesh& mesh) {
  elements_.resize(kPerFace * static_cast<std::size_t>(mesh.faceCount()));
  for (FaceId f = 0; f < mesh.faceCount(); ++f) deriveOn(mesh, f);
}

void PlateBending::deriveOn(const TriangleMesh& mesh, FaceId f) {
  const Patch patch = patchAround(mesh, f);
  const Plate& plate = plates_[strips_.at(mesh.material(patch.vertex[0]))];
  std::array<Vec2, 6> p;
  // Around the first corner: far from the origin, squares would lose digits.
  const Vec2 origin = mesh.material(patch.vertex[0]);
  for (std::size_t k = 0; k < p.size(); ++k) {
    p[k] = patch.vertex[k] == kNone ? Vec2::Zero() : Vec2(mesh.material(patch.vertex[k]) - origin);
  }
  Eigen::Matrix<double, 3, 6> weights = Eigen::Matrix<double, 3, 6>::Zero();
  if (patch.neighbours > 0 && plate.rigidity > 0.0) weights = curvatureWeights(p, patch.neighbours);
  const double stiffness = scale_ * plate.rigidity * mesh.restArea(f);
  const double most = scale_ * plate.most;
  const double least = kRounding * weights.cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < kPerFace; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double largest = weights.row(row).cwiseAbs().maxCoeff();
    const double capped = largest > 0.0 ? std::min(stiffness, most / (largest * largest)) : 0.0;
    elements_[kPerFace * static_cast<std::size_t>(f) + k] =
        makeElement(patch, weights.row(row), least, capped);
  }
}

void PlateBending::applyChanges(const TriangleMesh& mesh, const MeshChanges& changes) {
  if (empty()) return;
  if (!changes.removedFaces.empty()) {
    derive(mesh);
    return;
  }
  elements_.resize(kPerFace * static_cast<std::size_t>(mesh.faceCount()));
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
