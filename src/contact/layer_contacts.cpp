#include "layer_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Substeps after which closest points are found again.
constexpr int kRefreshEvery = 6;
/// Closest points are kept while their vertices have moved by less in sum [m]: a fiftieth of the
/// thickness of thin cloth.
constexpr double kStill = 3e-5;
/// Layers that are nearer than their thickness when a step begins, as after a cut, part at this
/// speed [m/s].
constexpr double kPartingSpeed = 0.2;
/// Lines whose sine is smaller count as parallel; a vertex and a face then carry the contact.
constexpr double kParallel = 0.05;
/// Edges keep this share of the thickness: so vertices and faces alone carry flat layers, and edges
/// only what rests on ridges.
constexpr double kEdgeShare = 0.993;
/// A push moves no vertex by more than this many times what is missing in the distance: where the
/// closest point is nearly at a vertex that cannot move, a light one beside it would be thrown far.
constexpr double kFarthestPush = 4.0;

bool areAdjacent(const Face& a, const Face& b) {
  return contains(a, b[0]) || contains(a, b[1]) || contains(a, b[2]);
}

bool areParallel(const std::array<VertexId, 4>& v, const std::vector<Vec3>& x) {
  const Vec3 a = x[v[1]] - x[v[0]];
  const Vec3 b = x[v[3]] - x[v[2]];
  return a.cross(b).squaredNorm() < kParallel * kParallel * a.squaredNorm() * b.squaredNorm();
}

/// Inverse mass of a vertex [1/kg]; 0 if its motion is prescribed.
double inverse(double mass) { return mass > 0.0 ? 1.0 / mass : 0.0; }

}  // namespace

void LayerContacts::build(const Model& model, const std::vector<LayerProperties>& byCloth) {
  const TriangleMesh& mesh = model.mesh;
  byCloth_ = byCloth;
  faces_ = mesh.faces();
  material_ = mesh.material();
  firstFace_.resize(material_.size());
  isMoved_.assign(material_.size(), 0);
  travel_.resize(material_.size());
  outlook_.resize(material_.size());
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) firstFace_[v] = *mesh.facesAround(v).begin();
  clothOfFace_.resize(faces_.size());
  isMovedFace_.assign(faces_.size(), 0);
  edgeOwner_.resize(faces_.size());
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const Face& face = faces_[f];
    clothOfFace_[f] = static_cast<std::uint8_t>(model.clothOf(face[0]));
    for (int k = 0; k < 3; ++k) {
      const std::array<FaceId, 2> on = mesh.facesOnEdge(face[k], face[(k + 1) % 3]);
      edgeOwner_[f][k] = on[1] == kNone ? on[0] : std::min(on[0], on[1]);
    }
  }
  clear();
}

void LayerContacts::clear() {
  clearCandidates();
  contacts_.clear();
  touching_.clear();
  active_ = 0;
}

void LayerContacts::clearCandidates() {
  candidates_.clear();
  std::fill(travel_.begin(), travel_.end(), 0.0);
  sinceRefresh_ = 0;
  refreshes_ = 0;
}

LayerContacts::Layers LayerContacts::layersOf(FaceId f, FaceId g) const {
  const LayerProperties& a = byCloth_[clothOfFace_[f]];
  const LayerProperties& b = byCloth_[clothOfFace_[g]];
  return {0.5 * (a.thickness + b.thickness), 0.5 * (a.friction + b.friction)};
}

/// Lists what may come into contact of a pair of faces. A vertex takes part as a corner of its
/// first face, an edge as a side of its first face; so no contact is listed twice.
/// \param isKnown  whether only contacts of vertices with the mark `isMoved_` are missing.
void LayerContacts::addPair(const FaceIds& ids, bool isKnown, const std::vector<QuickBox>& boxes) {
  const Face& f = faces_[ids.first];
  const Face& g = faces_[ids.second];
  const Layers layers = layersOf(ids.first, ids.second);
  const auto isMoved = [this](VertexId v) { return isMoved_[v] != 0; };
  const auto add = [&](const std::array<VertexId, 4>& v, FaceId face) {
    if (isKnown && std::none_of(v.begin(), v.end(), isMoved)) return;
    candidates_.push_back({v, face, layers});
  };
  const auto join = [&](VertexId a, VertexId b) {
    QuickBox box = boxes[a];
    box.add(boxes[b]);
    return box;
  };
  const auto addVertices = [&](FaceId from, const Face& corners, FaceId to, const Face& face) {
    QuickBox box = join(face[0], face[1]);
    box.add(boxes[face[2]]);
    for (const VertexId p : corners) {
      if (firstFace_[p] != from || contains(face, p) || !box.meets(boxes[p])) continue;
      add({p, face[0], face[1], face[2]}, to);
    }
  };
  addVertices(ids.first, f, ids.second, g);
  addVertices(ids.second, g, ids.first, f);
  for (int i = 0; i < 3; ++i) {
    if (edgeOwner_[ids.first][i] != ids.first) continue;
    const QuickBox edge = join(f[i], f[(i + 1) % 3]);
    for (int j = 0; j < 3; ++j) {
      if (edgeOwner_[ids.second][j] != ids.second) continue;
      const std::array<VertexId, 4> v{f[i], f[(i + 1) % 3], g[j], g[(j + 1) % 3]};
      if (v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3]) continue;
      if (edge.meets(join(v[2], v[3]))) add(v, kNone);
    }
  }
}

void LayerContacts::assign(const std::vector<FaceIds>& near, const std::vector<QuickBox>& boxes) {
  // The contacts of the last substep stay, for whoever asks, until the next one refreshes them.
  clearCandidates();
  extend(near, 0, Renewed(), boxes);
}

void LayerContacts::extend(const std::vector<FaceIds>& near, std::size_t known,
                           const Renewed& moved, const std::vector<QuickBox>& boxes) {
  for (const VertexId v : moved.vertices) isMoved_[v] = 1;
  for (const FaceId f : moved.faces) isMovedFace_[f] = 1;
  for (std::size_t k = 0; k < known && !moved.vertices.empty(); ++k) {
    if ((isMovedFace_[near[k].first] | isMovedFace_[near[k].second]) == 0) continue;
    addPair(near[k], true, boxes);
  }
  for (const FaceId f : moved.faces) isMovedFace_[f] = 0;
  for (const VertexId v : moved.vertices) isMoved_[v] = 0;
  for (std::size_t k = known; k < near.size(); ++k) addPair(near[k], false, boxes);
}

/// Finds the closest points of a candidate. \return false if they cannot carry a contact; its
/// distance is known all the same.
bool LayerContacts::find(const Candidate& candidate, const std::vector<Vec3>& x,
                         Closest& out) const {
  const std::array<VertexId, 4>& v = candidate.v;
  Contact& contact = out.contact;
  contact.v = v;
  contact.friction = candidate.layers.friction;
  out.face = candidate.face;
  if (candidate.areEdges()) {
    const SegmentPoints at = closestOnSegments(x[v[0]], x[v[1]], x[v[2]], x[v[3]]);
    out.isInside = at.s > 0.0 && at.s < 1.0 && at.t > 0.0 && at.t < 1.0;
    contact.weight = {1.0 - at.s, at.s, at.t - 1.0, -at.t};
    contact.corners = 2;
  } else {
    const std::array<double, 3> w = closestOnTriangle(x[v[0]], {x[v[1]], x[v[2]], x[v[3]]});
    out.isInside = w[0] > 0.0 && w[1] > 0.0 && w[2] > 0.0;
    contact.weight = {1.0, -w[0], -w[1], -w[2]};
    contact.corners = 1;
  }
  Vec3 apart = Vec3::Zero();
  Vec2 atRest = Vec2::Zero();
  for (int k = 0; k < 4; ++k) {
    apart += contact.weight[k] * x[v[k]];
    atRest += contact.weight[k] * material_[v[k]];
  }
  out.apart = apart.norm();
  if (!(out.apart > 0.0)) return false;
  if (candidate.areEdges() && (!out.isInside || areParallel(v, x))) return false;
  contact.normal = apart / out.apart;
  const double share = candidate.areEdges() ? kEdgeShare : 1.0;
  // Points that are near each other in the cloth laid flat are not pushed apart.
  contact.distance = std::min(share * candidate.layers.thickness, 0.9 * atRest.norm());
  return true;
}

/// Tells whether no face next to that of number `at` of the order is closer to the same vertex, of
/// those in [first, last) of it.
bool LayerContacts::isClosestFace(std::size_t first, std::size_t last, std::size_t at) const {
  const Closest& self = closest_[order_[at]];
  if (self.isInside) return true;
  for (std::size_t k = first; k < last; ++k) {
    const Closest& other = closest_[order_[k]];
    if (k == at) continue;
    const bool isCloser =
        other.apart < self.apart || (other.apart == self.apart && other.face < self.face);
    if (isCloser && areAdjacent(faces_[other.face], faces_[self.face])) return false;
  }
  return true;
}

/// Motion that vertices have in common, which brings nothing together [m]: their mean, or none if
/// most are at rest.
Vec3 LayerContacts::commonMotion(SubstepMotion motion) {
  Vec3 mean = Vec3::Zero();
  for (const VertexId v : motion.vertices) mean += motion.end[v] - motion.start[v];
  mean /= static_cast<double>(std::max<std::size_t>(1, motion.vertices.size()));
  double toMean = 0.0;
  double toRest = 0.0;
  for (const VertexId v : motion.vertices) {
    const Vec3 moved = motion.end[v] - motion.start[v];
    toMean += (moved - mean).norm();
    toRest += moved.norm();
  }
  return toMean < toRest ? mean : Vec3(Vec3::Zero());
}

/// Finds the closest points of the candidates that may come into contact before the next
/// refreshing. Those of a candidate that has hardly moved since they were found are kept.
void LayerContacts::findClosest(const std::vector<Vec3>& x) {
  closest_.swap(before_);
  closest_.clear();
  ++refreshes_;
  const auto sum = [](const std::vector<double>& of, const std::array<VertexId, 4>& v) {
    return of[v[0]] + of[v[1]] + of[v[2]] + of[v[3]];
  };
  for (Candidate& candidate : candidates_) {
    if (candidate.due > sum(outlook_, candidate.v)) continue;
    const double travel = sum(travel_, candidate.v);
    const bool isKept = travel - candidate.found < kStill && candidate.refresh == refreshes_ - 1;
    candidate.refresh = refreshes_;
    if (isKept && candidate.place < 0) continue;
    Closest& closest = closest_.emplace_back();
    if (isKept) {
      closest = before_[candidate.place];
    } else {
      const bool holds = find(candidate, x, closest);
      candidate.found = travel;
      candidate.due = travel + closest.apart - candidate.layers.thickness;
      candidate.place = -1;
      if (!holds) {
        closest_.pop_back();
        continue;
      }
    }
    candidate.place = static_cast<std::int32_t>(closest_.size()) - 1;
  }
}

/// Puts the faces near each vertex together, in the order of vertices, then edges by their first
/// vertex (a counting sort).
void LayerContacts::sortByVertex() {
  const std::size_t vertices = firstFace_.size();
  const auto keyOf = [&](const Closest& of) {
    return static_cast<std::size_t>(of.contact.v[0]) + (of.face == kNone ? vertices : 0);
  };
  first_.assign(2 * vertices + 1, 0);
  for (const Closest& closest : closest_) ++first_[keyOf(closest) + 1];
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  order_.resize(closest_.size());
  for (std::size_t k = 0; k < closest_.size(); ++k) {
    order_[first_[keyOf(closest_[k])]++] = static_cast<std::uint32_t>(k);
  }
}

/// Lists the contacts that may touch until the next time, and of each vertex only those with the
/// faces that are locally closest. Candidates that are listed twice count once.
void LayerContacts::refresh(const std::vector<Vec3>& x) {
  findClosest(x);
  sortByVertex();
  contacts_.clear();
  for (std::size_t first = 0; first < order_.size();) {
    const Closest& group = closest_[order_[first]];
    const bool areEdges = group.face == kNone;
    std::size_t last = first + 1;
    while (last < order_.size() && closest_[order_[last]].contact.v[0] == group.contact.v[0] &&
           (closest_[order_[last]].face == kNone) == areEdges) {
      ++last;
    }
    for (std::size_t k = first; k < last; ++k) {
      const Closest& closest = closest_[order_[k]];
      if (isListed(first, k) || (!areEdges && !isClosestFace(first, last, k))) continue;
      contacts_.push_back(closest.contact);
    }
    first = last;
  }
}

/// Tells whether the same vertices as in number `at` of the order are in [first, at) of it.
bool LayerContacts::isListed(std::size_t first, std::size_t at) const {
  for (std::size_t k = first; k < at; ++k) {
    if (closest_[order_[k]].contact.v == closest_[order_[at]].contact.v) return true;
  }
  return false;
}

void LayerContacts::project(SubstepMotion motion, double h) {
  active_ = 0;
  substep_ = h;
  if (candidates_.empty()) {
    touching_.clear();
    return;
  }
  const Vec3 common = commonMotion(motion);
  const auto distanceOf = [&](VertexId v) {
    return (motion.end[v] - motion.start[v] - common).norm();
  };
  if (sinceRefresh_++ % kRefreshEvery == 0) {
    for (const VertexId v : motion.vertices) {
      // At one and a half times the speed, and a little.
      outlook_[v] = travel_[v] + 1.5 * kRefreshEvery * distanceOf(v) + 2.5e-5;
    }
    refresh(motion.start);
  }
  for (const VertexId v : motion.vertices) travel_[v] += distanceOf(v);
  findTouching(motion.end);
  for (const std::uint32_t k : touching_) projectFreely(contacts_[k], motion, h);
  for (auto k = touching_.rbegin(); k != touching_.rend(); ++k) {
    if (projectFreely(contacts_[*k], motion, h)) ++active_;
  }
}

/// Lists the contacts that are too near at the end of the substep, or nearly so: sweeps over the
/// others would do nothing.
void LayerContacts::findTouching(const std::vector<Vec3>& x) {
  constexpr double kSlack = 1.003;  // of the distance to keep, because sweeps move their neighbours
  constexpr std::int32_t kGrain = 4096;
  isTouching_.resize(contacts_.size());
  parallelFor(static_cast<std::int32_t>(contacts_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last);
                     ++k) {
                  Contact& contact = contacts_[k];
                  contact.load = 0.0;
                  contact.drag.setZero();
                  Vec3 apart = Vec3::Zero();
                  for (int i = 0; i < 4; ++i) apart += contact.weight[i] * x[contact.v[i]];
                  isTouching_[k] = contact.normal.dot(apart) < kSlack * contact.distance ? 1 : 0;
                }
              });
  touching_.clear();
  for (std::size_t k = 0; k < isTouching_.size(); ++k) {
    if (isTouching_[k] != 0) touching_.push_back(static_cast<std::uint32_t>(k));
  }
}

void LayerContacts::settle(SubstepMotion motion, double h, std::vector<std::uint8_t>& supported) {
  pending_ = touching_;
  const auto isSettled = [&](std::uint32_t k) {
    const Contact& contact = contacts_[k];
    return isSupported(contact, 0, contact.corners, supported) &&
           isSupported(contact, contact.corners, 4, supported);
  };
  constexpr int kMostLevels = 32;
  for (int level = 0; level < kMostLevels; ++level) {
    raised_.clear();
    for (const std::uint32_t k : pending_) settleOne(contacts_[k], motion, h, supported);
    for (auto k = pending_.rbegin(); k != pending_.rend(); ++k) {
      settleOne(contacts_[*k], motion, h, supported);
    }
    if (raised_.empty()) return;
    for (const VertexId v : raised_) supported[v] = 1;
    pending_.erase(std::remove_if(pending_.begin(), pending_.end(), isSettled), pending_.end());
  }
}

/// Tells whether the vertices [first, last) of a contact that take part in it are supported.
bool LayerContacts::isSupported(const Contact& contact, int first, int last,
                                const std::vector<std::uint8_t>& supported) {
  for (int k = first; k < last; ++k) {
    if (contact.weight[k] != 0.0 && supported[contact.v[k]] == 0) return false;
  }
  return true;
}

/// Projects a contact with one side that is supported and another that is not.
void LayerContacts::settleOne(Contact& contact, SubstepMotion motion, double h,
                              const std::vector<std::uint8_t>& supported) {
  const bool first = isSupported(contact, 0, contact.corners, supported);
  if (first == isSupported(contact, contact.corners, 4, supported)) return;
  const int begin = first ? contact.corners : 0;
  const int end = first ? 4 : contact.corners;
  // The mobility is that of the whole side, also where a part of it is supported: the rest would
  // be thrown far to make up for it.
  std::array<double, 4> share{};
  double mobility = 0.0;
  for (int k = begin; k < end; ++k) {
    const double w = contact.weight[k] * inverse(motion.mass[contact.v[k]]);
    mobility += contact.weight[k] * w;
    if (supported[contact.v[k]] == 0) share[k] = w;
  }
  if (!projectOne(contact, motion, share, mobility, h)) return;
  for (int k = begin; k < end; ++k) raised_.push_back(contact.v[k]);
}

/// Projects a contact that moves all its vertices.
bool LayerContacts::projectFreely(Contact& contact, SubstepMotion motion, double h) {
  std::array<double, 4> share{};
  double mobility = 0.0;
  for (int k = 0; k < 4; ++k) {
    share[k] = contact.weight[k] * inverse(motion.mass[contact.v[k]]);
    mobility += contact.weight[k] * share[k];
  }
  return projectOne(contact, motion, share, mobility, h);
}

/// Pushes the sides of a contact apart, or lets them come nearer by what it pushed before, and
/// brings friction within its bound.
/// \param share     displacement of each vertex per load [1/kg].
/// \param mobility  displacement of the sides against each other per load [1/kg].
/// \return whether it carries load.
bool LayerContacts::projectOne(Contact& contact, SubstepMotion motion,
                               const std::array<double, 4>& share, double mobility, double h) {
  const std::array<VertexId, 4>& v = contact.v;
  const std::array<double, 4>& w = contact.weight;
  const Vec3& n = contact.normal;
  Vec3 after = Vec3::Zero();
  for (int k = 0; k < 4; ++k) after += w[k] * motion.end[v[k]];
  const double gap = n.dot(after);
  if (gap >= contact.distance && contact.load == 0.0) return false;
  if (!(mobility > 0.0)) return contact.load > 0.0;
  for (const double displacement : share) {
    mobility = std::max(mobility, std::abs(displacement) / kFarthestPush);
  }
  Vec3 before = Vec3::Zero();
  for (int k = 0; k < 4; ++k) before += w[k] * motion.start[v[k]];
  const double aim = std::min(contact.distance, n.dot(before) + kPartingSpeed * h);
  const double load = std::max(0.0, contact.load + (aim - gap) / mobility);
  Vec3 slip = after - before;
  slip -= n.dot(slip) * n;
  Vec3 drag = contact.drag - slip / mobility;
  drag -= n.dot(drag) * n;
  const double bound = contact.friction * load;
  if (drag.squaredNorm() > bound * bound) drag *= bound / drag.norm();
  const Vec3 move = (load - contact.load) * n + drag - contact.drag;
  contact.load = load;
  contact.drag = drag;
  for (int k = 0; k < 4; ++k) motion.end[v[k]] += share[k] * move;
  return load > 0.0;
}

/// Tells whether the contact keeps layers apart, rather than points that are near each other in the
/// cloth laid flat, such as the lips of a cut.
bool LayerContacts::isBetweenLayers(const Contact& contact) const {
  const Layers layers = layersOf(firstFace_[contact.v.front()], firstFace_[contact.v.back()]);
  return contact.distance > 0.5 * layers.thickness;
}

/// Numbers of the contacts that carried load in the last substep, ascending.
std::vector<std::uint32_t> LayerContacts::loaded() const {
  std::vector<std::uint32_t> numbers;
  for (const std::uint32_t k : touching_) {
    if (contacts_[k].load > 0.0) numbers.push_back(k);
  }
  return numbers;
}

double LayerContacts::leastDistance(const std::vector<Vec3>& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t k : loaded()) {
    const Contact& contact = contacts_[k];
    if (!isBetweenLayers(contact)) continue;
    Vec3 apart = Vec3::Zero();
    for (int i = 0; i < 4; ++i) apart += contact.weight[i] * x[contact.v[i]];
    least = std::min(least, apart.norm());
  }
  return least;
}

std::vector<LayerContactPoint> LayerContacts::loadedPoints(const std::vector<Vec3>& x,
                                                           std::size_t most) const {
  const std::vector<std::uint32_t> all = loaded();
  std::vector<LayerContactPoint> points(std::min(all.size(), most));
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Contact& contact = contacts_[all[n * all.size() / points.size()]];
    LayerContactPoint& point = points[n];
    // The weights of either side add up to 1 or -1.
    for (int i = 0; i < 4; ++i) point.place += 0.5 * std::abs(contact.weight[i]) * x[contact.v[i]];
    point.normal = contact.normal;
    point.force = contact.load / (substep_ * substep_);
  }
  return points;
}

}  // namespace cloth_sim
