#include "cloth_sim/cloth/spring_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "spring_area.h"
#include "spring_matches.h"

namespace cloth_sim {
namespace {

/// A bend spring joins neighbours in the directions of a thread, if their cosines exceed this.
constexpr double kStraight = 0.9;
/// Springs per vertex in the interior of a grid.
constexpr std::size_t kUsualSprings = 6;

ThreadDirection directionOf(const TriangleMesh& mesh, VertexId a, VertexId b) {
  return threadDirection(mesh.material(b) - mesh.material(a));
}

/// Lists the slots of the springs that each vertex supports, ascending, without spare capacity.
IndexLists listSupported(const SpringSlots& slots) {
  std::vector<std::int32_t> number;
  for (const Spring& spring : slots) {
    for (VertexId v : spring.support) {
      if (v == kNone) continue;
      if (number.size() <= static_cast<std::size_t>(v)) number.resize(v + 1, 0);
      ++number[v];
    }
  }
  IndexLists supported(number);
  std::int32_t slot = 0;
  for (const Spring& spring : slots) {
    for (VertexId v : spring.support) {
      if (v != kNone) supported.append(v, slot);
    }
    ++slot;
  }
  return supported;
}

}  // namespace

SpringNetwork::SpringNetwork(const TriangleMesh& mesh, const Fabric& fabric,
                             const SpringSelection& selection)
    : SpringNetwork(mesh, MaterialStrips(), {{fabric, selection, std::nullopt}}) {}

SpringNetwork::SpringNetwork(const TriangleMesh& mesh, const RawSprings& raw,
                             const SpringSelection& selection)
    : SpringNetwork(mesh, MaterialStrips(), {{Fabric(), selection, raw}}) {}

SpringNetwork::SpringNetwork(const TriangleMesh& mesh, MaterialStrips strips,
                             const std::vector<SpringRecipe>& recipes)
    : strips_(std::move(strips)) {
  if (recipes.size() != strips_.count()) {
    throw std::invalid_argument("springs need one recipe for each cloth");
  }
  cloths_.clear();
  for (const SpringRecipe& recipe : recipes) {
    cloths_.push_back(
        {recipe.selection, {recipe.fabric, recipe.selection}, recipe.raw, {0.0, 0.0}});
    anyRaw_ = anyRaw_ || recipe.raw;
  }
  if (anyRaw_) rawFractions_ = RawSpringFractions(mesh);
  build(mesh);
  if (anyRaw_) measureRawBends(mesh);
}

/// Averages the rest lengths of the raw bend springs of each cloth and thread.
void SpringNetwork::measureRawBends(const TriangleMesh& mesh) {
  std::vector<std::array<double, 2>> number(cloths_.size(), {0.0, 0.0});
  for (const Spring& spring : slots_) {
    if (!traitsOf(spring.kind).bridgesAVertex) continue;
    const std::size_t cloth = strips_.at(mesh.material(spring.a));
    const std::size_t thread = spring.direction == ThreadDirection::kWarp ? 0 : 1;
    cloths_[cloth].rawBendLength[thread] += spring.restLength;
    number[cloth][thread] += 1.0;
  }
  for (std::size_t cloth = 0; cloth < cloths_.size(); ++cloth) {
    for (std::size_t thread = 0; thread < 2; ++thread) {
      if (number[cloth][thread] > 0.0)
        cloths_[cloth].rawBendLength[thread] /= number[cloth][thread];
    }
  }
}

/// Derives the spring along an edge and, if the edge is an inner diagonal, the one across it.
template <typename Sink>
void SpringNetwork::deriveOnEdge(const TriangleMesh& mesh, VertexId a, VertexId b,
                                 const Sink& sink) const {
  Spring edge;
  edge.a = a;
  edge.b = b;
  edge.support = {a, b};
  edge.direction = directionOf(mesh, a, b);
  const bool bias = edge.direction == ThreadDirection::kBias;
  edge.kind = bias ? SpringKind::kShear : SpringKind::kStructural;
  if (bias && !clothAt(mesh, a).selection.shear) return;
  const std::array<FaceId, 2> faces = mesh.facesOnEdge(a, b);
  const IndexSpan on{faces.data(), faces.data() + (faces[1] == kNone ? 1 : 2)};
  setConstants(mesh, on, edge);
  sink(edge);
  if (!bias || faces[1] == kNone) return;

  Spring across = edge;
  const VertexId p = mesh.oppositeVertex(faces[0], a, b);
  const VertexId q = mesh.oppositeVertex(faces[1], a, b);
  across.a = std::min(p, q);
  across.b = std::max(p, q);
  if (directionOf(mesh, p, q) != ThreadDirection::kBias) return;
  setConstants(mesh, on, across);
  sink(across);
}

/// Derives the bend springs over a vertex: along warp and along weft, between the neighbours that
/// lie most nearly in both directions of the thread.
template <typename Sink>
void SpringNetwork::deriveBends(const TriangleMesh& mesh, VertexId v,
                                const std::vector<VertexId>& neighbours, const Sink& sink) const {
  struct Straightest {
    VertexId ahead = kNone;
    VertexId behind = kNone;
    double cosineAhead = kStraight;
    double cosineBehind = kStraight;
  };
  std::array<Straightest, 2> straightest;  // along warp and weft
  for (VertexId w : neighbours) {
    const Vec2 direction = (mesh.material(w) - mesh.material(v)).normalized();
    for (int axis = 0; axis < 2; ++axis) {
      const double cosine = direction[axis];
      Straightest& best = straightest[static_cast<std::size_t>(axis)];
      if (cosine > best.cosineAhead) {
        best.cosineAhead = cosine;
        best.ahead = w;
      } else if (-cosine > best.cosineBehind) {
        best.cosineBehind = -cosine;
        best.behind = w;
      }
    }
  }
  for (const ThreadDirection thread : {ThreadDirection::kWarp, ThreadDirection::kWeft}) {
    const Straightest& best = straightest[thread == ThreadDirection::kWarp ? 0 : 1];
    if (best.ahead == kNone || best.behind == kNone) continue;
    Spring bend;
    bend.a = std::min(best.ahead, best.behind);
    bend.b = std::max(best.ahead, best.behind);
    bend.kind = SpringKind::kBend;
    bend.direction = thread;
    bend.support = {v, kNone};
    setConstants(mesh, mesh.facesAround(v), bend);
    sink(bend);
  }
}

/// Derives the springs at and over each of `vertices`; one between two of them only once.
template <typename Sink>
void SpringNetwork::deriveAroundAll(const TriangleMesh& mesh, const std::vector<VertexId>& vertices,
                                    const Sink& sink) const {
  std::vector<bool> listed(static_cast<std::size_t>(mesh.vertexCount()), false);
  for (VertexId v : vertices) listed[v] = true;
  std::vector<VertexId> neighbours;
  for (VertexId v : vertices) {
    mesh.neighbours(v, neighbours);
    for (VertexId w : neighbours) {
      const bool foundThere = w < v && listed[w];
      if (!foundThere) deriveOnEdge(mesh, std::min(v, w), std::max(v, w), sink);
    }
    if (clothAt(mesh, v).selection.bend) deriveBends(mesh, v, neighbours, sink);
  }
}

SpringChanges SpringNetwork::allModified() const {
  SpringChanges all;
  all.modified.resize(slots_.size());
  std::iota(all.modified.begin(), all.modified.end(), 0);
  return all;
}

void SpringNetwork::build(const TriangleMesh& mesh) {
  std::vector<VertexId> all(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(all.begin(), all.end(), 0);
  slots_.reserve(kUsualSprings * all.size());
  deriveAroundAll(mesh, all, [this](const Spring& spring) {
    slots_.append(spring);
    ++count_[static_cast<std::size_t>(spring.kind)];
  });
}

/// Sets rest length, stiffness and damping.
/// \param on  the faces that the spring represents.
void SpringNetwork::setConstants(const TriangleMesh& mesh, const IndexSpan& on,
                                 Spring& spring) const {
  const Vec2 d = mesh.material(spring.b) - mesh.material(spring.a);
  spring.restLength = d.norm();
  const Cloth& cloth = clothAt(mesh, spring.a);
  if (cloth.raw) {
    const RawSpringFraction raw = rawFraction(mesh, on, spring);
    const double constant = cloth.raw->constant[static_cast<std::size_t>(spring.kind)];
    // Half of a spring is twice as stiff.
    const double perLength = cloth.raw->perStretch ? 1.0 : raw.restLength;
    spring.stiffness = scale_ * constant * raw.fraction * perLength / spring.restLength;
    spring.damping = cloth.raw->dashpot * raw.fraction * raw.restLength / spring.restLength;
  } else {
    spring.stiffness =
        scale_ * cloth.calibration.stiffness(spring, d, representedArea(mesh, on, spring));
    spring.damping = cloth.calibration.damping(spring.kind) * spring.stiffness;
  }
}

RawSpringFraction SpringNetwork::rawFraction(const TriangleMesh& mesh, const IndexSpan& on,
                                             const Spring& spring) const {
  if (traitsOf(spring.kind).bridgesAVertex) {
    RawSpringFraction result = rawFractions_.ofCorners(mesh, on, spring.support[0]);
    const std::size_t thread = spring.direction == ThreadDirection::kWarp ? 0 : 1;
    const double usual = clothAt(mesh, spring.a).rawBendLength[thread];
    result.restLength = result.restLength == 0.0 && usual > 0.0 ? usual : spring.restLength;
    return result;
  }
  const bool isEdge = spring.support[0] == spring.a && spring.support[1] == spring.b;
  if (!isEdge) return {1.0, spring.restLength};
  return rawFractions_.ofEdge(mesh, on, spring.a, spring.b);
}

SpringChanges SpringNetwork::applyChanges(const TriangleMesh& mesh, const MeshChanges& changes) {
  if (!changes.removedFaces.empty()) return applyRemoval(mesh, changes);
  const auto vertices = static_cast<std::size_t>(mesh.vertexCount());
  for (std::size_t lists = supported().size(); lists < vertices; ++lists) supported_.addList();
  if (anyRaw_) rawFractions_.applyChanges(mesh, changes);

  std::vector<Spring> derived;
  derived.reserve(kUsualSprings * changes.touched.size());
  deriveAroundAll(mesh, changes.touched, [&](const Spring& spring) { derived.push_back(spring); });
  return update(matchSprings(slots_, springsOnAny(changes.touched), derived, changes), derived);
}

/// Stores derived springs in the slots of those that they continue, or in new ones; removes old
/// springs that nothing continues.
SpringChanges SpringNetwork::update(const std::vector<SpringMatch>& matches,
                                    const std::vector<Spring>& derived) {
  SpringChanges result;
  for (const auto& [slot, k] : matches) {
    if (k == kNone) result.removed.push_back(slot);
    if (k == kNone || slot == kNone) continue;
    const Spring before = slots_[slot];
    const Spring& after = derived[static_cast<std::size_t>(k)];
    if (before == after) continue;
    result.modified.push_back(slot);
    --count_[static_cast<std::size_t>(before.kind)];
    ++count_[static_cast<std::size_t>(after.kind)];
    replace(slot, after);
  }
  std::sort(result.removed.begin(), result.removed.end());
  std::sort(result.modified.begin(), result.modified.end());
  for (std::int32_t slot : result.removed) {
    result.removedSprings.push_back(slots_[slot]);
    erase(slot);
  }
  for (const auto& [slot, k] : matches) {
    if (slot == kNone) result.added.push_back(insert(derived[static_cast<std::size_t>(k)]));
  }
  return result;
}

/// Renumbers the springs of what is left after connected components were removed.
SpringChanges SpringNetwork::applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes) {
  const std::vector<VertexId> newId = newIdsAfter(changes, mesh.vertexCount());
  if (anyRaw_) rawFractions_.applyChanges(mesh, changes);
  SpringChanges result;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(slots_.size()); ++slot) {
    const Spring before = slots_[slot];
    if (!before.exists()) continue;
    const Spring after = renumbered(before, newId);
    if (after == before) continue;
    if (after.exists()) {
      slots_.set(slot, after);
      result.modified.push_back(slot);
    } else {
      result.removed.push_back(slot);
      result.removedSprings.push_back(before);
      --count_[static_cast<std::size_t>(before.kind)];
      slots_.set(slot, Spring{});
    }
  }
  supported_ = IndexLists();
  return result;
}

std::int32_t SpringNetwork::count() const {
  return std::accumulate(count_.begin(), count_.end(), 0);
}

std::vector<std::int32_t> SpringNetwork::springsOnAny(const std::vector<VertexId>& vertices) const {
  std::vector<std::int32_t> slots;
  for (VertexId v : vertices) {
    const IndexSpan there = springsOn(v);
    slots.insert(slots.end(), there.begin(), there.end());
  }
  std::sort(slots.begin(), slots.end());
  slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  return slots;
}

IndexSpan SpringNetwork::springsOn(VertexId v) const {
  if (static_cast<std::size_t>(v) >= supported().size()) return {nullptr, nullptr};
  return supported()[v];
}

const IndexLists& SpringNetwork::supported() const {
  if (supported_.size() == 0) supported_ = listSupported(slots_);
  return supported_;
}

std::int32_t SpringNetwork::insert(const Spring& spring) {
  const auto slot = static_cast<std::int32_t>(slots_.size());
  slots_.append(Spring{});
  replace(slot, spring);
  ++count_[static_cast<std::size_t>(spring.kind)];
  return slot;
}

void SpringNetwork::erase(std::int32_t slot) {
  --count_[static_cast<std::size_t>(slots_[slot].kind)];
  replace(slot, Spring{});
}

void SpringNetwork::replace(std::int32_t slot, const Spring& spring) {
  if (supported_.size() > 0) {
    for (VertexId v : slots_[slot].support) {
      if (v != kNone) supported_.erase(v, slot);
    }
    for (VertexId v : spring.support) {
      if (v != kNone) supported_.insertSorted(v, slot);
    }
  }
  slots_.set(slot, spring);
}

SpringChanges SpringNetwork::setScale(const TriangleMesh& mesh, double scale) {
  const double factor = scale / std::exchange(scale_, scale);
  SpringChanges changes;
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(slots_.size()); ++slot) {
    Spring spring = slots_[slot];
    if (!spring.exists()) continue;
    spring.stiffness *= factor;
    if (!clothAt(mesh, spring.a).raw) spring.damping *= factor;
    slots_.set(slot, spring);
    changes.modified.push_back(slot);
  }
  return changes;
}

}  // namespace cloth_sim
