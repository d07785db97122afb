#include "cloth_sim/scene/build.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Returns a uniform number in [-1, 1). Unlike the distributions of <random>, it is the same on
/// every platform.
double symmetricUniform(std::mt19937_64& generator) {
  return 2.0 * static_cast<double>(generator() >> 11) * 0x1.0p-53 - 1.0;
}

Vec3 randomOffset(const Vec3& range, std::mt19937_64& generator) {
  Vec3 offset;
  for (int axis = 0; axis < 3; ++axis) offset[axis] = range[axis] * symmetricUniform(generator);
  return offset;
}

/// The mesh of one cloth in material coordinates of its own.
struct OwnMesh {
  std::optional<Grid> grid;
  TriangleMesh mesh;
};

OwnMesh makeOwnMesh(const ClothSpec& cloth) {
  if (cloth.mesh) return {std::nullopt, TriangleMesh(cloth.mesh->material, cloth.mesh->faces)};
  const Grid grid{cloth.columns, cloth.rows, cloth.width, cloth.height, cloth.diagonals};
  return {grid, makeGridMesh(grid)};
}

/// Appends a mesh, shifted along u, to the vertices and faces of others.
void append(const TriangleMesh& mesh, double shift, std::vector<Vec2>& material,
            std::vector<Face>& faces) {
  const auto first = static_cast<VertexId>(material.size());
  for (const Vec2& p : mesh.material()) material.emplace_back(p.x() + shift, p.y());
  for (const Face& face : mesh.faces()) {
    faces.push_back({first + face[0], first + face[1], first + face[2]});
  }
}

ClothPart partOf(const ClothSpec& cloth, const OwnMesh& own, VertexId firstVertex, double offset) {
  ClothPart part;
  part.name = cloth.name;
  part.fabric = cloth.fabric;
  part.grid = own.grid;
  part.firstVertex = firstVertex;
  part.vertices = own.mesh.vertexCount();
  part.materialOffset = offset;
  return part;
}

/// Returns the strips of the material plane: their bounds are half way between neighbours.
MaterialStrips stripsOf(const std::vector<ClothSpec>& cloths, const std::vector<double>& offsets) {
  std::vector<double> bounds;
  for (std::size_t k = 0; k + 1 < cloths.size(); ++k) {
    bounds.push_back(0.5 * (offsets[k] + cloths[k].width + offsets[k + 1]));
  }
  return MaterialStrips(std::move(bounds));
}

/// Makes the meshes of the cloths and places them side by side in the material plane.
void layOut(const std::vector<ClothSpec>& cloths, Model& model) {
  const std::vector<double> offsets = materialOffsets(cloths);
  model.strips = stripsOf(cloths, offsets);
  model.cloths.clear();
  if (cloths.size() == 1) {  // its material plane is its own
    OwnMesh own = makeOwnMesh(cloths[0]);
    model.cloths.push_back(partOf(cloths[0], own, 0, offsets[0]));
    model.mesh = std::move(own.mesh);
    return;
  }
  std::vector<Vec2> material;
  std::vector<Face> faces;
  for (std::size_t k = 0; k < cloths.size(); ++k) {
    const OwnMesh own = makeOwnMesh(cloths[k]);
    const auto first = static_cast<VertexId>(material.size());
    model.cloths.push_back(partOf(cloths[k], own, first, offsets[k]));
    append(own.mesh, offsets[k], material, faces);
  }
  model.mesh = TriangleMesh(std::move(material), std::move(faces));
}

PlateBending makeBending(const std::vector<ClothSpec>& cloths, const Model& model) {
  std::vector<PlateBending::Plate> plates(cloths.size());
  bool any = false;
  for (std::size_t k = 0; k < cloths.size(); ++k) {
    if (!cloths[k].plate) continue;
    const Fabric& fabric = cloths[k].fabric;
    plates[k] = {fabric.bending, std::min(fabric.tensileWarp, fabric.tensileWeft),
                 fabric.bendingHysteresis};
    any = true;
  }
  return any ? PlateBending(model.mesh, model.strips, std::move(plates)) : PlateBending();
}

/// Position of a vertex in the frame of the cloth [m].
/// \param v  from 0, among the vertices of this cloth.
Vec3 startPosition(const ClothSpec& cloth, VertexId v) {
  if (cloth.mesh) return cloth.mesh->positions[v];
  const Grid grid{cloth.columns, cloth.rows, cloth.width, cloth.height};
  Vec3 position = Vec3::Zero();
  position.head<2>() =
      grid.material(v % grid.columns, v / grid.columns) - 0.5 * Vec2(cloth.width, cloth.height);
  return position;
}

}  // namespace

double longestSide(const std::vector<ClothSpec>& cloths) {
  double longest = 0.0;
  for (const ClothSpec& cloth : cloths) longest = std::max({longest, cloth.width, cloth.height});
  return longest;
}

std::vector<double> materialOffsets(const std::vector<ClothSpec>& cloths) {
  const double gap = std::max(1.0, 2.0 * longestSide(cloths));  // [m]
  std::vector<double> offsets{0.0};
  for (std::size_t k = 1; k < cloths.size(); ++k) {
    offsets.push_back(std::ceil(offsets.back() + cloths[k - 1].width + gap));
  }
  return offsets;
}

Model buildModel(const std::vector<ClothSpec>& cloths) {
  Model model;
  layOut(cloths, model);
  std::vector<SpringRecipe> recipes;
  for (const ClothSpec& cloth : cloths) {
    recipes.push_back({cloth.fabric, cloth.springs, cloth.raw});
  }
  model.springs = SpringNetwork(model.mesh, model.strips, recipes);
  model.bending = makeBending(cloths, model);
  for (std::size_t k = 0; k < cloths.size(); ++k) {
    if (cloths[k].particleMass) {
      setParticleMasses(*cloths[k].particleMass, k, model);
    } else {
      lumpMasses(cloths[k].fabric.arealDensity, k, model);
    }
  }
  return model;
}

Model buildModel(const ClothSpec& cloth) { return buildModel(std::vector<ClothSpec>{cloth}); }

State initialState(const std::vector<ClothSpec>& cloths, const Model& model, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(model.particleCount());
  State state;
  state.x = VertexData<Vec3>(count, Vec3::Zero());
  state.v = VertexData<Vec3>(count, Vec3::Zero());
  if (model.bending.hasFriction()) {
    state.bendOffset.assign(static_cast<std::size_t>(model.mesh.faceCount()), Vec3::Zero());
  }
  std::mt19937_64 generator(seed);
  for (std::size_t k = 0; k < cloths.size(); ++k) {
    const ClothPart& part = model.cloths[k];
    const Vec3 offset = randomOffset(cloths[k].randomOffset, generator);
    for (VertexId v = 0; v < part.vertices; ++v) {
      state.x[part.firstVertex + v] = cloths[k].pose.toWorld(startPosition(cloths[k], v)) + offset;
      state.v[part.firstVertex + v] = cloths[k].velocity;
    }
  }
  return state;
}

std::vector<KinematicTarget> pinTargets(const std::vector<ClothSpec>& cloths, const Model& model,
                                        const State& state) {
  std::vector<KinematicTarget> pins;
  for (std::size_t k = 0; k < cloths.size(); ++k) {
    const ClothPart& part = model.cloths[k];
    for (const PinSpec& pin : cloths[k].pins) {
      const VertexId own =
          pin.vertex != kNone ? pin.vertex : part.grid->vertex(pin.column, pin.row);
      const VertexId v = part.firstVertex + own;
      pins.push_back({v, state.x[v], Vec3::Zero()});
    }
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

double thickestLayer(const Model& model) { return 0.5 * shortestEdge(model.mesh); }

std::unique_ptr<LayerContact> buildLayers(const Scene& scene, const Model& model) {
  if (!scene.selfContact) return nullptr;
  const double most = thickestLayer(model);
  std::vector<LayerProperties> byCloth;
  for (const ClothSpec& cloth : scene.cloths) {
    byCloth.push_back({std::min(cloth.fabric.thickness, most),
                       scene.layerFriction.value_or(cloth.fabric.friction)});
  }
  return std::make_unique<LayerContact>(model, std::move(byCloth));
}

ColliderSet buildColliders(const Scene& scene) {
  std::vector<ContactProperties> properties;
  for (const ClothSpec& cloth : scene.cloths) {
    properties.push_back({0.5 * cloth.fabric.thickness, cloth.fabric.friction});
  }
  ColliderSet colliders;
  for (const Obstacle& obstacle : scene.obstacles) colliders.add(obstacle, properties);
  return colliders;
}

}  // namespace cloth_sim
