#include "cloth_sim/cloth/spring_network.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace cloth_sim {
namespace {

/// A thread passes straight through a vertex if it turns by less than this (cosine).
constexpr double kStraight = 0.9;
/// A mesh direction within 22.5 degrees of a thread direction counts as that thread's.
const double kThreadCosine = std::cos(M_PI / 8.0);
/// Springs per vertex of a grid, but for its border.
constexpr std::size_t kUsualSprings = 6;

ThreadDirection threadDirection(const Vec2& d) {
  const double length = d.norm();
  if (std::abs(d.x()) > kThreadCosine * length) return ThreadDirection::kWarp;
  if (std::abs(d.y()) > kThreadCosine * length) return ThreadDirection::kWeft;
  return ThreadDirection::kBias;
}

template <typename Faces>
double areaOf(const TriangleMesh& mesh, const Faces& faces) {
  double area = 0.0;
  for (FaceId f : faces) area += mesh.restArea(f);
  return area;
}

/// What a spring stands on and joins, independent of the order of the ends: two vertices to a word.
using SpringKey = std::array<std::uint64_t, 2>;

std::uint64_t packed(VertexId p, VertexId q) {
  const auto low = static_cast<std::uint32_t>(std::min(p, q));
  const auto high = static_cast<std::uint32_t>(std::max(p, q));
  return (std::uint64_t{low} << 32U) | high;
}

std::array<VertexId, 4> unpacked(const std::array<std::uint64_t, 2>& key) {
  const auto low = [](std::uint64_t word) {
    return static_cast<VertexId>(static_cast<std::uint32_t>(word));
  };
  return {low(key[0] >> 32U), low(key[0]), low(key[1] >> 32U), low(key[1])};
}

SpringKey makeKey(VertexId s, VertexId t, VertexId a, VertexId b) {
  return {packed(s, t), packed(a, b)};
}

SpringKey ownKey(const Spring& spring) {
  return makeKey(spring.support[0], spring.support[1], spring.a, spring.b);
}

template <typename T>
struct Keyed {
  SpringKey key;
  T value;
  bool operator<(const Keyed& other) const {
    if (key[0] != other.key[0]) return key[0] < other.key[0];
    return key[1] != other.key[1] ? key[1] < other.key[1] : value < other.value;
  }
};

/// What vertices were called before an edit.
class Ancestors {
 public:
  explicit Ancestors(const MeshChanges& changes) {
    for (const VertexEdit& edit : changes.vertices) {
      if (edit.kind == VertexEdit::Kind::kCopy) source_.emplace(edit.id, of(edit.from[0]));
    }
  }
  VertexId of(VertexId v) const {
    const auto found = source_.find(v);
    return found == source_.end() ? v : found->second;
  }
  SpringKey key(const Spring& s) const {
    return makeKey(of(s.support[0]), of(s.support[1]), of(s.a), of(s.b));
  }

 private:
  std::map<VertexId, VertexId> source_;
};

/// Of each vertex that has any: the slots of the springs that stand on it, ascending, in no more
/// memory than that takes.
IndexLists listStanding(const SpringSlots& slots) {
  std::vector<std::int32_t> number;
  for (const Spring& spring : slots) {
    for (VertexId v : spring.support) {
      if (v == kNone) continue;
      if (number.size() <= static_cast<std::size_t>(v)) number.resize(v + 1, 0);
      ++number[v];
    }
  }
  IndexLists standing(number);
  std::int32_t slot = 0;
  for (const Spring& spring : slots) {
    for (VertexId v : spring.support) {
      if (v != kNone) standing.append(v, slot);
    }
    ++slot;
  }
  return standing;
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
    throw std::invalid_argument("springs need one recipe for each strip");
  }
  cloths_.clear();
  for (const SpringRecipe& recipe : recipes) {
    cloths_.push_back(
        {recipe.selection, {recipe.fabric, recipe.selection}, recipe.raw, {0.0, 0.0}});
    anyRaw_ = anyRaw_ || recipe.raw;
  }
  if (anyRaw_) rawShares_ = RawSpringFractions(mesh);
  build(mesh);
  if (anyRaw_) measureRawBends(mesh);
}

void SpringNetwork::measureRawBends(const TriangleMesh& mesh) {
  std::vector<std::array<double, 2>> number(cloths_.size(), {0.0, 0.0});
  for (const Spring& spring : slots_) {
    if (spring.kind != SpringKind::kBend) continue;
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

/// Springs over copies of what a cleared one stood on or joined stay away too.
void SpringNetwork::applyClearedEdges(const MeshChanges& changes) {
  if (cleared_.empty()) return;
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.kind != VertexEdit::Kind::kCopy) continue;
    std::vector<SpringKey> more;
    for (const SpringKey& key : cleared_) {
      std::array<VertexId, 4> v = unpacked(key);
      if (std::find(v.begin(), v.end(), edit.from[0]) == v.end()) continue;
      std::replace(v.begin(), v.end(), edit.from[0], edit.id);
      more.push_back(makeKey(v[0], v[1], v[2], v[3]));
    }
    cleared_.insert(more.begin(), more.end());
  }
}

template <typename Sink>
void SpringNetwork::deriveEdge(const TriangleMesh& mesh, VertexId a, VertexId b,
                               const Sink& sink) const {
  Spring edge;
  edge.a = a;
  edge.b = b;
  edge.support = {a, b};
  edge.direction = threadDirection(mesh.material(b) - mesh.material(a));
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
  if (threadDirection(mesh.material(q) - mesh.material(p)) != ThreadDirection::kBias) return;
  setConstants(mesh, on, across);
  sink(across);
}

template <typename Sink>
void SpringNetwork::deriveBends(const TriangleMesh& mesh, VertexId v,
                                const std::vector<VertexId>& neighbours, const Sink& sink) const {
  struct Straight {
    VertexId ahead = kNone;
    VertexId behind = kNone;
    double bestAhead = kStraight;
    double bestBehind = kStraight;
  };
  std::array<Straight, 2> straight;  // along warp and weft
  for (VertexId w : neighbours) {
    const Vec2 direction = (mesh.material(w) - mesh.material(v)).normalized();
    for (int axis = 0; axis < 2; ++axis) {
      const double cosine = direction[axis];
      Straight& s = straight[static_cast<std::size_t>(axis)];
      if (cosine > s.bestAhead) {
        s.bestAhead = cosine;
        s.ahead = w;
      } else if (-cosine > s.bestBehind) {
        s.bestBehind = -cosine;
        s.behind = w;
      }
    }
  }
  for (const ThreadDirection thread : {ThreadDirection::kWarp, ThreadDirection::kWeft}) {
    const Straight& s = straight[thread == ThreadDirection::kWarp ? 0 : 1];
    if (s.ahead == kNone || s.behind == kNone) continue;
    Spring bend;
    bend.a = std::min(s.ahead, s.behind);
    bend.b = std::max(s.ahead, s.behind);
    bend.kind = SpringKind::kBend;
    bend.direction = thread;
    bend.support = {v, kNone};
    setConstants(mesh, mesh.facesAround(v), bend);
    sink(bend);
  }
}

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
      if (!foundThere) deriveEdge(mesh, std::min(v, w), std::max(v, w), sink);
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
    ++count_[static_cast<int>(spring.kind)];
  });
}

void SpringNetwork::setConstants(const TriangleMesh& mesh, const IndexSpan& on,
                                 Spring& spring) const {
  const Vec2 d = mesh.material(spring.b) - mesh.material(spring.a);
  spring.restLength = d.norm();
  const Cloth& cloth = clothAt(mesh, spring.a);
  if (cloth.raw) {
    const RawSpringFraction share = rawShare(mesh, on, spring);
    const double constant = cloth.raw->constant[static_cast<int>(spring.kind)];
    // Half of a spring is twice as stiff.
    const double perLength = cloth.raw->perStretch ? 1.0 : share.length;
    spring.stiffness = scale_ * constant * share.part * perLength / spring.restLength;
    spring.damping = cloth.raw->dashpot * share.part * share.length / spring.restLength;
  } else {
    spring.stiffness = scale_ * cloth.calibration.stiffness(spring, d, areaOf(mesh, on));
    spring.damping = cloth.calibration.damping() * spring.stiffness;
  }
}

RawSpringFraction SpringNetwork::rawShare(const TriangleMesh& mesh, const IndexSpan& on,
                                          const Spring& spring) const {
  if (spring.kind == SpringKind::kBend) {
    RawSpringFraction share = rawShares_.ofCorners(mesh, on, spring.support[0]);
    const std::size_t thread = spring.direction == ThreadDirection::kWarp ? 0 : 1;
    const double usual = clothAt(mesh, spring.a).rawBendLength[thread];
    share.length = share.length == 0.0 && usual > 0.0 ? usual : spring.restLength;
    return share;
  }
  const bool isEdge = spring.support[0] == spring.a && spring.support[1] == spring.b;
  if (!isEdge) return {1.0, spring.restLength};
  return rawShares_.ofEdge(mesh, on, spring.a, spring.b);
}

SpringChanges SpringNetwork::applyChanges(const TriangleMesh& mesh, const MeshChanges& changes) {
  if (!changes.removedFaces.empty()) return applyRemoval(mesh, changes);
  const auto vertices = static_cast<std::size_t>(mesh.vertexCount());
  for (std::size_t lists = standing().size(); lists < vertices; ++lists) standing_.addList();
  if (anyRaw_) rawShares_.applyChanges(mesh, changes);
  applyClearedEdges(changes);
  const std::vector<std::int32_t> standing = springsOnAny(changes.touched);
  std::vector<Spring> derived;
  derived.reserve(kUsualSprings * changes.touched.size());
  deriveAroundAll(mesh, changes.touched, [&](const Spring& spring) { derived.push_back(spring); });
  std::vector<Keyed<std::size_t>> after;
  after.reserve(derived.size());
  const Ancestors ancestors(changes);
  for (std::size_t k = 0; k < derived.size(); ++k) {
    if (cleared_.count(ownKey(derived[k])) == 0) after.push_back({ancestors.key(derived[k]), k});
  }
  std::vector<Keyed<std::int32_t>> old;
  old.reserve(standing.size());
  for (std::int32_t slot : standing) old.push_back({ownKey(slots_[slot]), slot});
  std::sort(old.begin(), old.end());
  std::sort(after.begin(), after.end());

  // Both are sorted by what the springs were called before the edit: the first of several copies
  // (the one that kept its ends, if any did) goes on in the slot.
  SpringChanges result;
  std::vector<Spring> fresh;
  fresh.reserve(after.size());
  auto at = old.begin();
  for (const auto& [key, k] : after) {
    const Spring& spring = derived[k];
    for (; at != old.end() && at->key < key; ++at) result.removed.push_back(at->value);
    if (at != old.end() && at->key == key) {
      const Spring before = slots_[at->value];
      if (!(before == spring)) {
        result.modified.push_back(at->value);
        --count_[static_cast<std::size_t>(before.kind)];
        ++count_[static_cast<std::size_t>(spring.kind)];
        replace(at->value, spring);
      }
      ++at;
    } else {
      fresh.push_back(spring);
    }
  }
  for (; at != old.end(); ++at) result.removed.push_back(at->value);
  std::sort(result.removed.begin(), result.removed.end());
  std::sort(result.modified.begin(), result.modified.end());
  for (std::int32_t slot : result.removed) {
    result.removedSprings.push_back(slots_[slot]);
    erase(slot);
  }
  for (const Spring& spring : fresh) result.added.push_back(insert(spring));
  return result;
}

SpringChanges SpringNetwork::clear(const std::vector<std::int32_t>& slots) {
  SpringChanges result;
  for (std::int32_t slot : slots) {
    result.removed.push_back(slot);
    result.removedSprings.push_back(slots_[slot]);
    cleared_.insert(ownKey(slots_[slot]));
    erase(slot);
  }
  return result;
}

SpringChanges SpringNetwork::applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes) {
  std::vector<VertexId> nameOf(static_cast<std::size_t>(mesh.vertexCount()) +
                               changes.vertices.size());
  std::iota(nameOf.begin(), nameOf.end(), 0);
  std::vector<VertexId> original = nameOf;  // by present name
  for (const VertexEdit& edit : changes.vertices) {
    nameOf[original[edit.id]] = kNone;
    if (edit.from[0] != edit.id) nameOf[original[edit.from[0]]] = edit.id;
    original[edit.id] = original[edit.from[0]];
  }
  if (anyRaw_) rawShares_.applyChanges(mesh, changes);
  std::set<SpringKey> cleared;
  for (const SpringKey& key : cleared_) {
    std::array<VertexId, 4> v = unpacked(key);
    for (VertexId& end : v) end = end == kNone ? kNone : nameOf[end];
    cleared.insert(makeKey(v[0], v[1], v[2], v[3]));
  }
  cleared_ = std::move(cleared);
  SpringChanges result;
  const auto rename = [&](VertexId& v) { v = v == kNone ? kNone : nameOf[v]; };
  for (std::int32_t slot = 0; slot < static_cast<std::int32_t>(slots_.size()); ++slot) {
    const Spring before = slots_[slot];
    if (!before.exists()) continue;
    Spring spring = before;
    for (VertexId* v : {&spring.a, &spring.b, &spring.support[0], &spring.support[1]}) rename(*v);
    if (!spring.exists()) {
      result.removed.push_back(slot);
      result.removedSprings.push_back(before);
      --count_[static_cast<int>(before.kind)];
      slots_.set(slot, Spring{});
      continue;
    }
    if (spring.a > spring.b) std::swap(spring.a, spring.b);
    const bool bend = spring.kind == SpringKind::kBend;
    if (!bend && spring.support[0] > spring.support[1]) {
      std::swap(spring.support[0], spring.support[1]);
    }
    if (spring == before) continue;
    slots_.set(slot, spring);
    result.modified.push_back(slot);
  }
  standing_ = IndexLists();
  return result;
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
  if (static_cast<std::size_t>(v) >= standing().size()) return {nullptr, nullptr};
  return standing()[v];
}

const IndexLists& SpringNetwork::standing() const {
  if (standing_.size() == 0) standing_ = listStanding(slots_);
  return standing_;
}

std::int32_t SpringNetwork::insert(const Spring& spring) {
  const auto slot = static_cast<std::int32_t>(slots_.size());
  slots_.append(Spring{});
  replace(slot, spring);
  ++count_[static_cast<int>(spring.kind)];
  return slot;
}

void SpringNetwork::erase(std::int32_t slot) {
  --count_[static_cast<int>(slots_[slot].kind)];
  replace(slot, Spring{});
}

void SpringNetwork::replace(std::int32_t slot, const Spring& spring) {
  if (standing_.size() > 0) {
    for (VertexId v : slots_[slot].support) {
      if (v != kNone) standing_.erase(v, slot);
    }
    for (VertexId v : spring.support) {
      if (v != kNone) standing_.insertSorted(v, slot);
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
