/// \file Checks of springs that were read from a file.

#include <algorithm>

#include "cloth_sim/cloth/spring_network.h"
#include "cloth_sim/validation.h"

namespace cloth_sim {
namespace {

/// Extent along a spring's own axis, over its length, below which its direction is wrong [-].
constexpr double kAlong = 1e-6;

bool isVertexOf(const TriangleMesh& mesh, VertexId v) { return v >= 0 && v < mesh.vertexCount(); }

/// Tells whether the indices of a spring exist, whatever they mean.
bool hasVertices(const TriangleMesh& mesh, const Spring& s) {
  return isVertexOf(mesh, s.a) && isVertexOf(mesh, s.b) && s.a < s.b &&
         isVertexOf(mesh, s.support[0]) &&
         (s.support[1] == kNone || isVertexOf(mesh, s.support[1]));
}

bool hasKind(const Spring& s) {
  const bool isBias = s.direction == ThreadDirection::kBias;
  switch (s.kind) {
    case SpringKind::kShear:
      return isBias;
    case SpringKind::kStructural:
    case SpringKind::kBend:
      return s.direction == ThreadDirection::kWarp || s.direction == ThreadDirection::kWeft;
  }
  return false;
}

bool hasNumbers(const Spring& s) {
  return isPositive(s.restLength) && isNotNegative(s.stiffness) && isNotNegative(s.damping);
}

/// Tells whether a spring runs along its direction in the material, up to what moved vertices
/// change.
bool runsAlong(const TriangleMesh& mesh, const Spring& s) {
  const Vec2 d = mesh.material(s.b) - mesh.material(s.a);
  const int axis = s.direction == ThreadDirection::kWarp ? 0 : 1;
  return std::abs(d[axis]) > kAlong * d.norm();
}

bool areNeighbours(const TriangleMesh& mesh, VertexId a, VertexId b) {
  return mesh.facesOnEdge(a, b)[0] != kNone;
}

/// Tells whether a spring stands on the vertices that support it as its kind says.
bool standsOnMesh(const TriangleMesh& mesh, const Spring& s) {
  const auto [p, q] = s.support;
  if (s.kind == SpringKind::kBend) {
    return q == kNone && p != s.a && p != s.b && areNeighbours(mesh, p, s.a) &&
           areNeighbours(mesh, p, s.b);
  }
  if (q == kNone || p == q) return false;
  const std::array<FaceId, 2> faces = mesh.facesOnEdge(p, q);
  if (faces[0] == kNone) return false;
  if (std::minmax(p, q) == std::minmax(s.a, s.b)) return true;
  if (s.kind != SpringKind::kShear || faces[1] == kNone) return false;
  const VertexId ahead = mesh.oppositeVertex(faces[0], p, q);
  const VertexId behind = mesh.oppositeVertex(faces[1], p, q);
  return std::minmax(ahead, behind) == std::minmax(s.a, s.b);
}

using Identity = std::array<VertexId, 4>;

Identity identityOf(const Spring& s) {
  const auto [low, high] = std::minmax(s.support[0], s.support[1]);
  return {low, high, s.a, s.b};
}

}  // namespace

std::string SpringNetwork::validationError(const TriangleMesh& mesh,
                                           const SpringNetwork& undamaged) const {
  std::vector<Identity> all;
  std::int32_t slot = 0;
  for (const Spring& s : slots_) {
    const std::string name = "spring " + std::to_string(slot++);
    if (!s.exists()) continue;
    if (!hasVertices(mesh, s)) return name + " names a vertex that does not exist";
    if (!hasKind(s)) return name + " is of no kind";
    if (!hasNumbers(s)) return name + " has a length or a stiffness that no spring has";
    if (!standsOnMesh(mesh, s) || !runsAlong(mesh, s)) return name + " is not where the mesh is";
    all.push_back(identityOf(s));
  }
  std::sort(all.begin(), all.end());
  if (std::adjacent_find(all.begin(), all.end()) != all.end()) return "a spring is there twice";
  return tableError(mesh, undamaged);
}

std::string SpringNetwork::tableError(const TriangleMesh& mesh,
                                      const SpringNetwork& undamaged) const {
  if (slots_.size() < undamaged.slots_.size()) return "springs of the undamaged cloth are missing";
  if (!isPositive(scale_)) return "the scale of stiffness is not positive";
  std::array<std::int32_t, kSpringKinds> count{};
  for (const Spring& s : slots_) {
    if (s.exists()) ++count[static_cast<std::size_t>(s.kind)];
  }
  if (count != count_) return "the numbers of springs do not add up";
  const std::size_t fractions = anyRaw_ ? static_cast<std::size_t>(mesh.faceCount()) : 0;
  if (rawFractions_.size() != fractions) return "raw springs are not divided among the faces";
  if (supported_.size() == 0) return "";
  // Lists end at the last vertex that supports a spring, if they were made after a removal.
  if (supported_.size() > static_cast<std::size_t>(mesh.vertexCount())) {
    return "the springs by vertex are not those of the mesh";
  }
  std::size_t listed = 0;
  for (VertexId v = 0; v < static_cast<VertexId>(supported_.size()); ++v) {
    const IndexSpan here = supported_[v];
    listed += here.size();
    for (const std::int32_t slot : here) {
      const bool isSlot = slot >= 0 && slot < static_cast<std::int32_t>(slots_.size());
      if (!isSlot || (slots_[slot].support[0] != v && slots_[slot].support[1] != v)) {
        return "vertex " + std::to_string(v) + " lists a spring that is not there";
      }
    }
    if (!std::is_sorted(here.begin(), here.end()) ||
        std::adjacent_find(here.begin(), here.end()) != here.end()) {
      return "the springs of vertex " + std::to_string(v) + " are not in order";
    }
  }
  std::size_t supports = 0;
  for (const SpringKindTraits& traits : kSpringKindTraits) {
    const std::int32_t ofKind = count[static_cast<std::size_t>(traits.kind)];
    supports += static_cast<std::size_t>(traits.bridgesAVertex ? ofKind : 2 * ofKind);
  }
  return listed == supports ? "" : "a spring is missing at its vertices";
}

}  // namespace cloth_sim
