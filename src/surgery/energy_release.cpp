#include "energy_release.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tear_line.h"

namespace cloth_sim {
namespace {

/// Distances from the tip up to which the weight is 1, and from which on it is 0 [edges]. The field
/// next to the tip is the one that a mesh resolves worst.
constexpr double kInner = 1.0;
constexpr double kOuter = 4.0;
/// Number of directions that are tried on either side of the material force.
constexpr int kDirections = 90;

/// The weight q around a tip.
struct Weight {
  Vec2 tip;     ///< material coordinates [m]
  double edge;  ///< mean length of the edges at the tip [m]

  double at(const Vec2& p) const {
    const double distance = (p - tip).norm() / edge;
    return std::clamp((kOuter - distance) / (kOuter - kInner), 0.0, 1.0);
  }
};

double meanEdge(const TriangleMesh& mesh, VertexId v) {
  const std::vector<VertexId> around = mesh.neighbours(v);
  double sum = 0.0;
  for (VertexId w : around) sum += (mesh.material(w) - mesh.material(v)).norm();
  return sum / static_cast<double>(around.size());
}

/// Returns the vertices that are connected to the tip through vertices of positive weight,
/// ascending.
std::vector<VertexId> weightedVertices(const TriangleMesh& mesh, VertexId tip,
                                       const Weight& weight) {
  std::vector<VertexId> reached{tip};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    for (VertexId w : mesh.neighbours(reached[k])) {
      if (weight.at(mesh.material(w)) <= 0.0) continue;
      if (std::find(reached.begin(), reached.end(), w) == reached.end()) reached.push_back(w);
    }
  }
  std::sort(reached.begin(), reached.end());
  return reached;
}

/// The gradients of a face: of the position by the material coordinates, and of the weight.
struct Gradients {
  Eigen::Matrix<double, 3, 2> deformation;
  Vec2 weight;  ///< [1/m]
};

Gradients gradientsOn(const TriangleMesh& mesh, const State& state, FaceId f,
                      const Weight& weight) {
  const Face& face = mesh.face(f);
  Eigen::Matrix2d rest;
  rest << mesh.material(face[1]) - mesh.material(face[0]),
      mesh.material(face[2]) - mesh.material(face[0]);
  const Eigen::Matrix2d inverse = rest.inverse();
  Eigen::Matrix<double, 3, 2> deformed;
  deformed << state.x[face[1]] - state.x[face[0]], state.x[face[2]] - state.x[face[0]];
  const double q = weight.at(mesh.material(face[0]));
  const Eigen::RowVector2d rise(weight.at(mesh.material(face[1])) - q,
                                weight.at(mesh.material(face[2])) - q);
  return {deformed * inverse, (rise * inverse).transpose()};
}

/// Returns what a spring contributes to the material force.
Vec2 contribution(const Model& model, const State& state, const Spring& spring,
                  const Weight& weight) {
  const TriangleMesh& mesh = model.mesh;
  const Vec3 d = state.x[spring.b] - state.x[spring.a];
  const Vec2 rest = mesh.material(spring.b) - mesh.material(spring.a);
  const double length = d.norm();
  if (length == 0.0) return Vec2::Zero();
  const double elongation = length - spring.restLength;
  const double energy = 0.5 * spring.stiffness * elongation * elongation;
  const Vec3 force = spring.stiffness * elongation / length * d;
  const std::vector<FaceId> faces = facesUnder(mesh, spring);
  double area = 0.0;
  for (FaceId f : faces) area += mesh.restArea(f);
  Vec2 sum = Vec2::Zero();
  for (FaceId f : faces) {
    const Gradients at = gradientsOn(mesh, state, f, weight);
    const Vec2 flux =
        rest.dot(at.weight) * (at.deformation.transpose() * force) - energy * at.weight;
    sum += mesh.restArea(f) / area * flux;
  }
  return sum;
}

}  // namespace

Vec2 materialForce(const Model& model, const State& state, VertexId tip) {
  const Weight weight{model.mesh.material(tip), meanEdge(model.mesh, tip)};
  Vec2 sum = Vec2::Zero();
  for (std::int32_t slot :
       model.springs.springsOnAny(weightedVertices(model.mesh, tip, weight))) {
    sum += contribution(model, state, model.springs[slot], weight);
  }
  return sum;
}

TearAdvance mostDrivenAdvance(const Vec2& force, const TearEnergy& energy) {
  TearAdvance best;
  const double strength = force.norm();
  if (strength == 0.0) return best;
  const Vec2 along = force / strength;
  const Vec2 across(-along.y(), along.x());
  for (int k = -kDirections; k <= kDirections; ++k) {
    const double angle = 0.5 * M_PI * k / kDirections;
    const Vec2 direction = std::cos(angle) * along + std::sin(angle) * across;
    const double load = force.dot(direction) / energy.along(direction);
    // Of equal directions the one nearest to the force: an isotropic fabric has it at k = 0.
    if (load > best.load * (1.0 + 1e-12) || (k == 0 && load >= best.load * (1.0 - 1e-12))) {
      best = {direction, load};
    }
  }
  return best;
}

}  // namespace cloth_sim
