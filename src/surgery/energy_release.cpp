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
/// Relative difference up to which loads count as equal.
constexpr double kSameLoad = 1e-12;

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

/// The faces around a tip, and what the springs that represent them store and bear.
class Surroundings {
 public:
  Surroundings(const Model& model, const State& state, VertexId tip)
      : mesh_(model.mesh),
        state_(state),
        weight_{model.mesh.material(tip), meanEdge(model.mesh, tip)} {
    const std::vector<VertexId> inside = weightedVertices(mesh_, tip, weight_);
    for (VertexId v : inside) addFaces(mesh_.facesAround(v));
    std::sort(parts_.begin(), parts_.end(),
              [](const Part& p, const Part& q) { return p.face < q.face; });
    for (const std::int32_t slot : model.springs.springsOnAny(corners())) add(model.springs[slot]);
  }

  /// Integrates the material force over the faces, and what acts on the free edges of the tear.
  Vec2 materialForce() const {
    Vec2 sum = Vec2::Zero();
    for (const Part& part : parts_) sum += onFace(part) + onFreeEdges(part);
    return sum;
  }

 private:
  using Matrix32 = Eigen::Matrix<double, 3, 2>;
  /// A face: its energy W A [J], and its stress times area P A [N m].
  struct Part {
    FaceId face = kNone;
    double energy = 0.0;
    Matrix32 stress = Matrix32::Zero();
  };

  void addFaces(const std::vector<FaceId>& faces) {
    for (FaceId f : faces) {
      const auto isIt = [f](const Part& part) { return part.face == f; };
      if (std::none_of(parts_.begin(), parts_.end(), isIt)) parts_.push_back({f});
    }
  }

  std::vector<VertexId> corners() const {
    std::vector<VertexId> all;
    for (const Part& part : parts_) {
      for (VertexId v : mesh_.face(part.face)) all.push_back(v);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  Part* partOf(FaceId f) {
    const auto at =
        std::lower_bound(parts_.begin(), parts_.end(), f,
                         [](const Part& part, FaceId face) { return part.face < face; });
    return at != parts_.end() && at->face == f ? &*at : nullptr;
  }

  /// Adds a spring to the faces that it represents, by their areas.
  void add(const Spring& spring) {
    const Vec3 d = state_.x[spring.b] - state_.x[spring.a];
    const double length = d.norm();
    if (length == 0.0) return;
    const double elongation = length - spring.restLength;
    const double energy = 0.5 * spring.stiffness * elongation * elongation;
    const Matrix32 stress = spring.stiffness * elongation / length * d *
                            (mesh_.material(spring.b) - mesh_.material(spring.a)).transpose();
    const std::vector<FaceId> faces = facesUnder(mesh_, spring);
    double area = 0.0;
    for (FaceId f : faces) area += mesh_.restArea(f);
    for (FaceId f : faces) {
      Part* part = partOf(f);
      if (part == nullptr) continue;
      part->energy += mesh_.restArea(f) / area * energy;
      part->stress += mesh_.restArea(f) / area * stress;
    }
  }

  /// Returns (F^T P - W I) grad q A of a face.
  Vec2 onFace(const Part& part) const {
    const Face& face = mesh_.face(part.face);
    Eigen::Matrix2d rest;
    rest << mesh_.material(face[1]) - mesh_.material(face[0]),
        mesh_.material(face[2]) - mesh_.material(face[0]);
    Matrix32 deformed;
    deformed << state_.x[face[1]] - state_.x[face[0]], state_.x[face[2]] - state_.x[face[0]];
    const Eigen::Matrix2d inverse = rest.inverse();
    const double q = weight_.at(mesh_.material(face[0]));
    const Eigen::RowVector2d rise(weight_.at(mesh_.material(face[1])) - q,
                                  weight_.at(mesh_.material(face[2])) - q);
    const Vec2 gradient = (rise * inverse).transpose();
    return (deformed * inverse).transpose() * (part.stress * gradient) - part.energy * gradient;
  }

  /// Returns the integral of q W n over the border edges of a face, with their outward normals n.
  Vec2 onFreeEdges(const Part& part) const {
    const Face& face = mesh_.face(part.face);
    Vec2 sum = Vec2::Zero();
    for (int k = 0; k < 3; ++k) {
      const VertexId a = face[k];
      const VertexId b = face[(k + 1) % 3];
      if (mesh_.facesOnEdge(a, b)[1] != kNone) continue;
      const Vec2 edge = mesh_.material(b) - mesh_.material(a);
      const double q = 0.5 * (weight_.at(mesh_.material(a)) + weight_.at(mesh_.material(b)));
      sum += q * part.energy / mesh_.restArea(part.face) * Vec2(edge.y(), -edge.x());
    }
    return sum;
  }

  const TriangleMesh& mesh_;
  const State& state_;
  Weight weight_;
  std::vector<Part> parts_;  ///< by face, ascending
};

}  // namespace

Vec2 materialForce(const Model& model, const State& state, VertexId tip) {
  return Surroundings(model, state, tip).materialForce();
}

TearAdvance mostDrivenAdvance(const Vec2& force, const TearEnergy& energy) {
  TearAdvance best;
  const double strength = force.norm();
  if (strength == 0.0) return best;
  const auto tryOne = [&](const Vec2& direction) {
    const double load = force.dot(direction) / energy.along(direction);
    if (load > best.load * (1.0 + kSameLoad)) best = {direction, load};
  };
  const Vec2 along = force / strength;
  const Vec2 across(-along.y(), along.x());
  // First those that win ties: along the force, as for an isotropic fabric, and along the threads,
  // where the energy of a woven one has its minima.
  tryOne(along);
  for (const Vec2& thread : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)}) tryOne(thread);
  for (int k = 1; k < kDirections; ++k) {
    const double angle = 0.5 * M_PI * k / kDirections;
    for (const double side : {-1.0, 1.0}) {
      tryOne(std::cos(angle) * along + side * std::sin(angle) * across);
    }
  }
  return best;
}

}  // namespace cloth_sim
