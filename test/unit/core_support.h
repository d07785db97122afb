#pragma once
/// \file Random numbers, models, states and edits for the tests of the core. Header-only.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cloth_sim/mesh/mesh_editor.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/scene.h"
#include "cloth_sim/solver/registry.h"
#include "mesh/quality.h"

namespace cloth_sim::testing_support {

using Generator = std::mt19937_64;

/// Draws uniformly from [low, high), the same on every platform (distributions of <random> are
/// not).
inline double uniform(Generator& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}

/// Draws an integer uniformly from [low, high].
inline int whole(Generator& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

inline Vec3 randomVector(Generator& random, double range) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = uniform(random, -range, range);
  return p;
}

/// Makes a cloth without bending with square cells of side `spacing` [m].
inline ClothSpec clothOf(int columns, int rows, double spacing,
                         const Fabric& fabric = fabricPreset("silk")) {
  ClothSpec spec;
  spec.columns = columns;
  spec.rows = rows;
  spec.width = spacing * (columns - 1);
  spec.height = spacing * (rows - 1);
  spec.fabric = fabric;
  return spec;
}

/// Returns the state of flat cloth at rest in z = 0, with x = u and y = v.
inline State flatState(const Model& model) {
  State state;
  const auto count = static_cast<std::size_t>(model.particleCount());
  state.x = VertexData<Vec3>(count, Vec3::Zero(), model.mesh.revision());
  state.v = VertexData<Vec3>(count, Vec3::Zero(), model.mesh.revision());
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v].head<2>() = model.mesh.material(v);
  }
  return state;
}

/// Returns the state of flat cloth with random displacements of up to `shake` [m] and velocities of
/// up to `speed` [m/s].
inline State shakenState(const Model& model, double shake, double speed, std::uint64_t seed) {
  Generator random(seed);
  State state = flatState(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v] += randomVector(random, shake);
    state.v[v] = randomVector(random, speed);
  }
  return state;
}

/// Returns the largest distance of the particles from where they were [m]. \param from  positions,
/// by vertex [m]; those that are new since do not count.
inline double farthestMove(const std::vector<Vec3>& from, const State& to) {
  double farthest = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    farthest = std::max(farthest, (to.x.values()[k] - from[k]).norm());
  }
  return farthest;
}

/// Makes a method with a number of substeps and otherwise default parameters.
inline std::unique_ptr<Solver> makeSolver(const SolverInfo& info, const Model& model,
                                          int substeps = 1) {
  SolverParameters given;
  for (const SolverParameter& parameter : info.parameters) {
    if (parameter.name == "substeps") given["substeps"] = substeps;
  }
  return info.create(model, completeParameters(info, given));
}

/// Draws some of the faces around `v`: neither none nor all of them, unless there is only one.
inline std::vector<FaceId> randomFaces(const TriangleMesh& mesh, VertexId v, Generator& random) {
  const std::vector<FaceId>& around = mesh.facesAround(v);
  if (around.size() < 2) return {};
  std::vector<FaceId> some;
  while (some.empty() || some.size() == around.size()) {
    some.clear();
    for (FaceId f : around) {
      if ((random() >> 40) & 1U) some.push_back(f);
    }
  }
  return some;
}

/// A vertex to split, and the faces to detach from it.
struct Opening {
  VertexId vertex = kNone;
  std::vector<FaceId> detach;
};

/// Draws a vertex and the faces to detach from it.
inline Opening randomOpening(const TriangleMesh& mesh, Generator& random) {
  Opening opening;
  opening.vertex = whole(random, 0, mesh.vertexCount() - 1);
  opening.detach = randomFaces(mesh, opening.vertex, random);
  return opening;
}

/// Returns the rest area of every connected component [m^2].
inline std::vector<double> pieceAreas(const TriangleMesh& mesh) {
  const ConnectedComponents pieces = connectedComponents(mesh);
  std::vector<double> areas(static_cast<std::size_t>(pieces.count), 0.0);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) areas[pieces.ofFace[f]] += mesh.restArea(f);
  return areas;
}

/// Returns the sum of the rest areas in extended precision, so that a comparison to 1e-14 shows the
/// effect of an edit and not of the order of summation.
inline double preciseArea(const TriangleMesh& mesh) {
  long double twice = 0.0L;
  for (const Face& face : mesh.faces()) {
    const auto side = [&](int k, int axis) {
      return static_cast<long double>(mesh.material(face[k])[axis]) -
             static_cast<long double>(mesh.material(face[0])[axis]);
    };
    twice += side(1, 0) * side(2, 1) - side(2, 0) * side(1, 1);
  }
  return static_cast<double>(0.5L * twice);
}

/// Returns the smallest angle of all faces [rad].
inline double smallestAngle(const TriangleMesh& mesh) {
  double smallest = M_PI;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) smallest = std::min(smallest, minAngle(mesh, f));
  return smallest;
}

/// Returns the length of the original border that is left [m].
inline double rimLength(const TriangleMesh& mesh) {
  double length = 0.0;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Face& face = mesh.face(f);
      if (mesh.isOriginalBoundary(f, k)) {
        length += (mesh.material(face[(k + 1) % 3]) - mesh.material(face[k])).norm();
      }
    }
  }
  return length;
}

/// Returns `validationError` or, if that is empty, the first disagreement of the tables with a
/// search through all faces.
inline std::string validateMesh(const TriangleMesh& mesh) {
  std::string error = validationError(mesh);
  if (!error.empty()) return error;
  std::vector<std::vector<FaceId>> around(static_cast<std::size_t>(mesh.vertexCount()));
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (VertexId v : mesh.face(f)) around[v].push_back(f);
  }
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    if (mesh.facesAround(v) != around[v]) return "wrong faces around " + std::to_string(v);
  }
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Face& face = mesh.face(f);
      const bool border = mesh.facesOnEdge(face[k], face[(k + 1) % 3])[1] == kNone;
      if (mesh.isOriginalBoundary(f, k) && !border)
        return "original border inside, at face " + std::to_string(f);
    }
  }
  return "";
}

/// Returns whether exactly the border edges are marked as original border: no opening, and no
/// vertex on an edge of a neighbour.
inline bool isConforming(const TriangleMesh& mesh) {
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Face& face = mesh.face(f);
      const bool border = mesh.facesOnEdge(face[k], face[(k + 1) % 3])[1] == kNone;
      if (border != mesh.isOriginalBoundary(f, k)) return false;
    }
  }
  return true;
}

/// Makes a grid with random displacements of inner vertices by up to `shake` spacings per axis.
inline TriangleMesh irregularMesh(const Grid& grid, double shake, Generator& random) {
  const TriangleMesh even = makeGridMesh(grid);
  std::vector<Vec2> material = even.material();
  for (VertexId v = 0; v < even.vertexCount(); ++v) {
    if (even.isBoundary(v)) continue;
    material[v] += shake * Vec2(uniform(random, -1.0, 1.0) * grid.spacingU(),
                                uniform(random, -1.0, 1.0) * grid.spacingV());
  }
  return TriangleMesh(std::move(material), even.faces());
}

/// Draws three numbers of at least `least` that sum to one.
inline std::array<double, 3> randomWeights(Generator& random, double least) {
  const double a = uniform(random, 0.0, 1.0);
  const double b = uniform(random, 0.0, 1.0 - a);
  const double rest = 1.0 - 3.0 * least;
  return {least + rest * a, least + rest * b, 1.0 - (least + rest * a) - (least + rest * b)};
}

/// Returns the point of a face with the given barycentric coordinates.
inline Vec2 pointIn(const TriangleMesh& mesh, FaceId f, const std::array<double, 3>& weight) {
  Vec2 p = Vec2::Zero();
  for (int k = 0; k < 3; ++k) p += weight[k] * mesh.material(mesh.face(f)[k]);
  return p;
}

/// Random edits of every kind except the removal of components. They leave no face with an angle
/// below about 2 degrees. Each returns whether it changed anything.
class RandomEditor {
 public:
  RandomEditor(MeshEditor& editor, Generator& random) : editor_(editor), random_(random) {}

  bool splitEdge() {
    const auto [f, k] = someSide();
    if (minAngle(mesh(), f) < kEnough) return false;
    const Face face = mesh().face(f);
    for (FaceId other : mesh().facesOnEdge(face[k], face[(k + 1) % 3])) {
      if (other != kNone && minAngle(mesh(), other) < kEnough) return false;
    }
    editor_.splitEdge(face[k], face[(k + 1) % 3], uniform(random_, 0.3, 0.7));
    return true;
  }

  bool splitFace() {
    const FaceId f = someFace();
    if (minAngle(mesh(), f) < 2.0 * kEnough) return false;
    editor_.splitFace(f, randomWeights(random_, 0.25));
    return true;
  }

  bool flipEdge() {
    const auto [f, k] = someSide();
    const VertexId a = mesh().face(f)[k];
    const VertexId b = mesh().face(f)[(k + 1) % 3];
    const auto on = mesh().facesOnEdge(a, b);
    if (on[1] == kNone) return false;
    const FaceId other = on[0] == f ? on[1] : on[0];
    const VertexId c = mesh().oppositeVertex(f, a, b);
    const VertexId d = mesh().oppositeVertex(other, a, b);
    if (mesh().facesOnEdge(c, d)[0] != kNone) return false;
    const auto angle = [&](VertexId p, VertexId q, VertexId r) {
      return minAngle(mesh().material(p), mesh().material(q), mesh().material(r));
    };
    if (std::min(angle(a, d, c), angle(d, b, c)) < kLeast) return false;
    editor_.flipEdge(a, b);
    return true;
  }

  /// Moves an inner vertex within the faces around it, and a border vertex along the border.
  bool moveVertex() {
    const VertexId v = whole(random_, 0, mesh().vertexCount() - 1);
    const std::vector<FaceId>& around = mesh().facesAround(v);
    const FaceId f = around[whole(random_, 0, static_cast<int>(around.size()) - 1)];
    std::array<double, 3> weight = randomWeights(random_, 0.0);
    if (mesh().isBoundary(v) && !slide(v, f, weight)) return false;
    const Vec2 to = pointIn(mesh(), f, weight);
    for (FaceId moved : around) {
      std::array<Vec2, 3> corner;
      for (int k = 0; k < 3; ++k) {
        const VertexId w = mesh().face(moved)[k];
        corner[k] = w == v ? to : mesh().material(w);
      }
      if (minAngle(corner[0], corner[1], corner[2]) < kLeast) return false;
    }
    editor_.moveVertex(v, f, weight);
    return true;
  }

  bool open() {
    const Opening opening = randomOpening(mesh(), random_);
    return editor_.splitVertex(opening.vertex, opening.detach);
  }

  bool any() {
    switch (whole(random_, 0, 9)) {
      case 0:
        return open();
      case 1:
      case 2:
        return splitEdge();
      case 3:
        return splitFace();
      case 4:
      case 5:
      case 6:
        return flipEdge();
      default:
        return moveVertex();
    }
  }

 private:
  static constexpr double kLeast = 0.035;
  static constexpr double kEnough = 0.15;

  const TriangleMesh& mesh() const { return editor_.mesh(); }
  FaceId someFace() { return whole(random_, 0, mesh().faceCount() - 1); }
  std::pair<FaceId, int> someSide() {
    const FaceId f = someFace();
    return {f, whole(random_, 0, 2)};
  }

  /// Sets `weight` to a point on a border edge of `f` at `v`, if the border is parallel to an axis
  /// there.
  bool slide(VertexId v, FaceId f, std::array<double, 3>& weight) {
    const Face& face = mesh().face(f);
    const int k = static_cast<int>(std::find(face.begin(), face.end(), v) - face.begin());
    bool done = false;
    bool alongU = true;
    bool alongV = true;
    for (VertexId w : mesh().neighbours(v)) {
      if (mesh().facesOnEdge(v, w)[1] != kNone) continue;
      alongU = alongU && mesh().material(w).y() == mesh().material(v).y();
      alongV = alongV && mesh().material(w).x() == mesh().material(v).x();
      const auto at = std::find(face.begin(), face.end(), w);
      if (at == face.end() || done) continue;
      const double t = uniform(random_, 0.0, 0.5);
      weight = {0.0, 0.0, 0.0};
      weight[k] = 1.0 - t;
      weight[at - face.begin()] = t;
      done = true;
    }
    return done && (alongU || alongV);
  }

  MeshEditor& editor_;
  Generator& random_;
};

/// Names the tests of INSTANTIATE_TEST_SUITE_P over the registry by the method.
inline std::vector<std::string> solverNames() {
  std::vector<std::string> names;
  for (const SolverInfo& info : solverRegistry()) names.push_back(info.name);
  return names;
}

/// Same, without the methods that gain energy at any step length without damping.
inline std::vector<std::string> boundedSolverNames() {
  std::vector<std::string> names;
  for (const SolverInfo& info : solverRegistry()) {
    if (info.stabilityLimit > 0.0) names.push_back(info.name);
  }
  return names;
}

}  // namespace cloth_sim::testing_support
