#include "cloth_sim/scene/build.h"

#include <algorithm>
#include <random>

namespace cloth_sim {
namespace {

/// Uniform in [-1, 1), the same on every platform (distributions of <random> are not).
double symmetricUniform(std::mt19937_64& generator) {
  return 2.0 * static_cast<double>(generator() >> 11) * 0x1.0p-53 - 1.0;
}

Vec3 randomOffset(const Vec3& range, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  Vec3 offset;
  for (int axis = 0; axis < 3; ++axis) offset[axis] = range[axis] * symmetricUniform(generator);
  return offset;
}

/// In the cloth's frame.
Vec3 startPosition(const ClothSpec& spec, const Model& model, VertexId v) {
  if (spec.mesh) return spec.mesh->positions[v];
  Vec3 position = Vec3::Zero();
  position.head<2>() = model.mesh.material(v) - 0.5 * Vec2(spec.width, spec.height);
  return position;
}

}  // namespace

Model buildModel(const ClothSpec& spec) {
  Model model;
  if (spec.mesh) {
    model.mesh = TriangleMesh(spec.mesh->material, spec.mesh->faces);
  } else {
    model.grid = Grid{spec.columns, spec.rows, spec.width, spec.height};
    model.mesh = makeGridMesh(*model.grid);
  }
  model.fabric = spec.fabric;
  model.springs = spec.raw ? SpringNetwork(model.mesh, *spec.raw, spec.springs)
                           : SpringNetwork(model.mesh, spec.fabric, spec.springs);
  if (spec.hinge)
    model.bending = BendNetwork(model.mesh, spec.fabric.bending,
                                std::min(spec.fabric.tensileWarp, spec.fabric.tensileWeft));
  if (spec.particleMass) {
    setParticleMasses(*spec.particleMass, model);
  } else {
    lumpMasses(spec.fabric.arealDensity, model);
  }
  return model;
}

State initialState(const ClothSpec& spec, const Model& model, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(model.particleCount());
  State state;
  state.x = VertexData<Vec3>(count, Vec3::Zero());
  state.v = VertexData<Vec3>(count, spec.velocity);
  const Vec3 offset = randomOffset(spec.randomOffset, seed);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v] = spec.pose.toWorld(startPosition(spec, model, v)) + offset;
  }
  return state;
}

std::vector<KinematicTarget> pinTargets(const ClothSpec& spec, const Model& model,
                                        const State& state) {
  std::vector<KinematicTarget> pins;
  for (const PinSpec& pin : spec.pins) {
    const VertexId v = pin.vertex != kNone ? pin.vertex : model.grid->vertex(pin.column, pin.row);
    pins.push_back({v, state.x[v], Vec3::Zero()});
  }
  const auto before = [](const KinematicTarget& a, const KinematicTarget& b) {
    return a.vertex < b.vertex;
  };
  const auto same = [](const KinematicTarget& a, const KinematicTarget& b) {
    return a.vertex == b.vertex;
  };
  std::sort(pins.begin(), pins.end(), before);
  pins.erase(std::unique(pins.begin(), pins.end(), same), pins.end());
  return pins;
}

ColliderSet buildColliders(const Scene& scene) {
  ColliderSet colliders;
  for (const Obstacle& obstacle : scene.obstacles) {
    colliders.add(obstacle, 0.5 * scene.cloth.fabric.thickness);
  }
  return colliders;
}

}  // namespace cloth_sim
