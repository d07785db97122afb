#include "cloth_sim/sim/measurements.h"

#include <algorithm>

#include "cloth_sim/cloth/stable_step.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

std::vector<StrainLine> strainLinesOf(const SpringNetwork& springs) {
  std::vector<StrainLine> lines;
  for (const Spring& spring : springs.slots()) {
    if (!spring.exists() || !traitsOf(spring.kind).isMembrane) continue;
    lines.push_back({spring.a, spring.b, spring.restLength});
  }
  return lines;
}

std::vector<std::array<VertexId, 2>> tornEdgesOf(const TriangleMesh& mesh) {
  std::vector<std::array<VertexId, 2>> edges;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const Face& face = mesh.face(f);
    for (int k = 0; k < 3; ++k) {
      const VertexId a = face[k];
      const VertexId b = face[(k + 1) % 3];
      const bool border = mesh.facesOnEdge(a, b)[1] == kNone;
      if (border && !mesh.isOriginalBoundary(f, k)) edges.push_back({a, b});
    }
  }
  return edges;
}

std::shared_ptr<const Topology> makeTopology(const Model& model) {
  auto topology = std::make_shared<Topology>();
  topology->revision = model.mesh.revision();
  for (const ClothPart& cloth : model.cloths) {
    topology->cloths.push_back(
        {cloth.name, cloth.firstVertex, cloth.vertices, cloth.materialOffset, cloth.grid});
  }
  topology->faces = model.mesh.faces();
  topology->material = model.mesh.material();
  topology->strainLines = strainLinesOf(model.springs);
  topology->tornEdges = tornEdgesOf(model.mesh);
  topology->shortestEdge = shortestEdge(model.mesh);
  topology->stableStep = stableStep(model);
  return topology;
}

}  // namespace

double Measurements::measureMaxStretch(const Model& model, const State& state, bool isAsleep) {
  if (!isAsleep || !stretchAsleep_) stretchAsleep_ = maxStretch(model, state);
  maxStretchSeen_ = std::max(maxStretchSeen_, *stretchAsleep_);
  return *stretchAsleep_;
}

std::shared_ptr<const Topology> Measurements::topology(const Model& model, std::uint64_t edits) {
  const double scale = model.springs.scale();  // decides the longest stable step
  if (!topology_ || topologyEdits_ != edits || topologyScale_ != scale) {
    topology_ = makeTopology(model);
    topologyEdits_ = edits;
    topologyScale_ = scale;
  }
  return topology_;
}

}  // namespace cloth_sim
