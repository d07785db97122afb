#pragma once
/// \file What the core's tests build their cases from. Header-only; test/ is on the include path.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "cloth_sim/mesh/mesh_editor.h"
#include "cloth_sim/scene/scene.h"
#include "cloth_sim/sim/build.h"
#include "cloth_sim/solver/registry.h"

namespace cloth_sim::testing_support {

using Generator = std::mt19937_64;

/// Uniform in [low, high), the same on every platform (distributions of <random> are not).
inline double uniform(Generator& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}

/// Uniform in [low, high], whole.
inline int whole(Generator& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

inline Vec3 randomVector(Generator& random, double range) {
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = uniform(random, -range, range);
  return p;
}

/// A cloth without bending whose cells are squares of `spacing`.
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

/// The cloth flat in z = 0, with x = u and y = v, at rest.
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

/// The flat cloth with every particle shaken by up to `shake` [m] and moving at up to `speed`
/// [m/s].
inline State shakenState(const Model& model, double shake, double speed, std::uint64_t seed) {
  Generator random(seed);
  State state = flatState(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v] += randomVector(random, shake);
    state.v[v] = randomVector(random, speed);
  }
  return state;
}

/// A method with a number of substeps and defaults otherwise.
inline std::unique_ptr<Solver> makeSolver(const SolverInfo& info, const Model& model,
                                          int substeps = 1) {
  SolverParameters given;
  for (const SolverParameter& parameter : info.parameters) {
    if (parameter.name == "substeps") given["substeps"] = substeps;
  }
  return info.create(model, completeParameters(info, given));
}

/// A random part of the faces around `v`: neither none nor all of them, where there are two.
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

/// A vertex to split at random, and how.
inline Opening randomOpening(const TriangleMesh& mesh, Generator& random) {
  Opening opening;
  opening.vertex = whole(random, 0, mesh.vertexCount() - 1);
  opening.detach = randomFaces(mesh, opening.vertex, random);
  return opening;
}

/// Rest area of every piece, in their order.
inline std::vector<double> pieceAreas(const TriangleMesh& mesh) {
  const Pieces pieces = findPieces(mesh);
  std::vector<double> areas(static_cast<std::size_t>(pieces.count), 0.0);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) areas[pieces.ofFace[f]] += mesh.restArea(f);
  return areas;
}

/// For INSTANTIATE_TEST_SUITE_P over the registry: the method's name.
inline std::vector<std::string> solverNames() {
  std::vector<std::string> names;
  for (const SolverInfo& info : solverRegistry()) names.push_back(info.name);
  return names;
}

}  // namespace cloth_sim::testing_support
