#include "layer_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Substeps after which closest points are found again.
constexpr int kRefreshEvery = 4;
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
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) firstFace_[v] = *mesh.facesAround(v).begin();
  clothOfFace_.resize(faces_.size());
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
  candidates_.clear();
  contacts_.clear();
  touching_.clear();
  sinceRefresh_ = 0;
  travel_ = 0.0;
  active_ = 0;
}

LayerContacts::Layers LayerContacts::layersOf(FaceId f, FaceId g) const {
  const LayerProperties& a = byCloth_[clothOfFace_[f]];
  const LayerProperties& b = byCloth_[clothOfFace_[g]];
  return {0.5 * (a.thickness + b.thickness), 0.5 * (a.friction + b.friction)};
}

/// Lists a vertex and a face that may come into contact.
/// \param reach  distance up to which they may [m].
void LayerContacts::addVertexFace(VertexId p, FaceId face, const std::vector<Vec3>& x, double reach,
                                  const Layers& layers) {
  const Face& c = faces_[face];
  if (contains(c, p)) return;
  const std::array<double, 3> w = closestOnTriangle(x[p], {x[c[0]], x[c[1]], x[c[2]]});
  const Vec3 apart = x[p] - w[0] * x[c[0]] - w[1] * x[c[1]] - w[2] * x[c[2]];
  if (apart.squaredNorm() > reach * reach) return;
  candidates_.push_back({{p, c[0], c[1], c[2]}, face, layers.thickness, layers.friction});
}

/// Lists two edges that may come into contact.
void LayerContacts::addEdges(const std::array<VertexId, 4>& v, const std::vector<Vec3>& x,
                             double reach, const Layers& layers) {
  if (v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3]) return;
  const SegmentPoints at = closestOnSegments(x[v[0]], x[v[1]], x[v[2]], x[v[3]]);
  const Vec3 apart = x[v[0]] + at.s * (x[v[1]] - x[v[0]]) - x[v[2]] - at.t * (x[v[3]] - x[v[2]]);
  if (apart.squaredNorm() > reach * reach) return;
  candidates_.push_back({v, kNone, layers.thickness, layers.friction});
}

/// A vertex takes part as a corner of its first face, an edge as a side of its first face; so no
/// contact is listed twice.
void LayerContacts::assign(const std::vector<FaceIds>& near, const std::vector<Vec3>& x,
                           const std::vector<Box>& allowed) {
  // The contacts of the last substep stay, for whoever asks, until the next one refreshes them.
  candidates_.clear();
  sinceRefresh_ = 0;
  travel_ = 0.0;
  const auto allowedOf = [&](const Face& face) {
    Box box = allowed[face[0]];
    box.add(allowed[face[1]]);
    box.add(allowed[face[2]]);
    return box;
  };
  for (const FaceIds& ids : near) {
    const Layers layers = layersOf(ids.first, ids.second);
    const Face& f = faces_[ids.first];
    const Face& g = faces_[ids.second];
    const Box a = allowedOf(f);
    const Box b = allowedOf(g);
    const Vec3 approach = (a.high - b.low).cwiseMax(b.high - a.low);
    const double reach = layers.thickness + approach.maxCoeff();
    for (const VertexId p : f) {
      if (firstFace_[p] == ids.first) addVertexFace(p, ids.second, x, reach, layers);
    }
    for (const VertexId p : g) {
      if (firstFace_[p] == ids.second) addVertexFace(p, ids.first, x, reach, layers);
    }
    for (int i = 0; i < 3; ++i) {
      if (edgeOwner_[ids.first][i] != ids.first) continue;
      for (int j = 0; j < 3; ++j) {
        if (edgeOwner_[ids.second][j] != ids.second) continue;
        addEdges({f[i], f[(i + 1) % 3], g[j], g[(j + 1) % 3]}, x, reach, layers);
      }
    }
  }
  sortByVertex();
  constexpr double kUnknown = -std::numeric_limits<double>::infinity();
  due_.assign(candidates_.size(), kUnknown);
}

/// Brings the faces near each vertex together, in the order of vertices; edges come last. Otherwise
/// the order stays (a counting sort).
void LayerContacts::sortByVertex() {
  const auto keyOf = [this](const Candidate& candidate) {
    return candidate.areEdges() ? firstFace_.size() : static_cast<std::size_t>(candidate.v[0]);
  };
  first_.assign(firstFace_.size() + 2, 0);
  for (const Candidate& candidate : candidates_) ++first_[keyOf(candidate) + 1];
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  sorted_.resize(candidates_.size());
  for (const Candidate& candidate : candidates_) sorted_[first_[keyOf(candidate)]++] = candidate;
  candidates_.swap(sorted_);
}

/// Finds the closest points of a candidate. \return false if they cannot carry a contact; its
/// distance is known all the same.
bool LayerContacts::find(const Candidate& candidate, const std::vector<Vec3>& x,
                         Closest& out) const {
  const std::array<VertexId, 4>& v = candidate.v;
  Contact& contact = out.contact;
  contact.v = v;
  contact.friction = candidate.friction;
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
  contact.distance = std::min(share * candidate.thickness, 0.9 * atRest.norm());
  return true;
}

/// Whether no face next to that of `closest_[at]` is closer to the same vertex, of those in
/// [first, last).
bool LayerContacts::isClosestFace(std::size_t first, std::size_t last, std::size_t at) const {
  const Closest& self = closest_[at];
  if (self.isInside) return true;
  for (std::size_t k = first; k < last; ++k) {
    const Closest& other = closest_[k];
    if (k == at) continue;
    const bool isCloser =
        other.apart < self.apart || (other.apart == self.apart && other.face < self.face);
    if (isCloser && areAdjacent(faces_[other.face], faces_[self.face])) return false;
  }
  return true;
}

/// Finds the closest points of the candidates that are within `ahead` [m] of a contact.
void LayerContacts::findClosest(const std::vector<Vec3>& x, double ahead) {
  closest_.clear();
  Closest closest;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    if (due_[k] - travel_ > ahead) continue;
    const Candidate& candidate = candidates_[k];
    const bool holds = find(candidate, x, closest);
    due_[k] = travel_ + closest.apart - candidate.thickness;
    if (!holds || due_[k] - travel_ > ahead) continue;
    closest.face = candidate.face;
    closest_.push_back(closest);
  }
}

/// Lists the contacts that may touch until the next time, and of each vertex only those with the
/// faces that are locally closest.
/// \param motion  largest motion of a vertex in the substep [m].
void LayerContacts::refresh(const std::vector<Vec3>& x, double motion) {
  // At one and a half times the speed, and a little.
  findClosest(x, 3.0 * kRefreshEvery * motion + 1e-4);
  contacts_.clear();
  for (std::size_t first = 0; first < closest_.size();) {
    std::size_t last = first + 1;
    const bool areEdges = closest_[first].face == kNone;
    while (!areEdges && last < closest_.size() && closest_[last].face != kNone &&
           closest_[last].contact.v[0] == closest_[first].contact.v[0]) {
      ++last;
    }
    for (std::size_t k = first; k < last; ++k) {
      const Closest& closest = closest_[k];
      if (!areEdges && !isClosestFace(first, last, k)) continue;
      contacts_.push_back(closest.contact);
    }
    first = last;
  }
}

void LayerContacts::project(SubstepMotion motion, const std::vector<double>& mass, double h,
                            double farthest) {
  active_ = 0;
  substep_ = h;
  if (candidates_.empty()) {
    touching_.clear();
    return;
  }
  if (sinceRefresh_++ % kRefreshEvery == 0) refresh(motion.start, farthest);
  travel_ += 2.0 * farthest;
  findTouching(motion.end);
  for (const std::uint32_t k : touching_) projectFreely(contacts_[k], motion, mass, h);
  for (auto k = touching_.rbegin(); k != touching_.rend(); ++k) {
    if (projectFreely(contacts_[*k], motion, mass, h)) ++active_;
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

void LayerContacts::settle(SubstepMotion motion, const std::vector<double>& mass, double h,
                           std::vector<std::uint8_t>& supported) {
  constexpr int kMostLevels = 32;
  for (int level = 0; level < kMostLevels; ++level) {
    raised_.clear();
    for (const std::uint32_t k : touching_) settleOne(contacts_[k], motion, mass, h, supported);
    for (auto k = touching_.rbegin(); k != touching_.rend(); ++k) {
      settleOne(contacts_[*k], motion, mass, h, supported);
    }
    if (raised_.empty()) return;
    for (const VertexId v : raised_) supported[v] = 1;
  }
}

/// Projects a contact with one side that is supported and another that is not.
void LayerContacts::settleOne(Contact& contact, SubstepMotion motion,
                              const std::vector<double>& mass, double h,
                              const std::vector<std::uint8_t>& supported) {
  const auto isSupported = [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      if (contact.weight[k] != 0.0 && supported[contact.v[k]] == 0) return false;
    }
    return true;
  };
  const bool first = isSupported(0, contact.corners);
  if (first == isSupported(contact.corners, 4)) return;
  const int begin = first ? contact.corners : 0;
  const int end = first ? 4 : contact.corners;
  // The mobility is that of the whole side, also where a part of it is supported: the rest would
  // be thrown far to make up for it.
  std::array<double, 4> share{};
  double mobility = 0.0;
  for (int k = begin; k < end; ++k) {
    const double w = contact.weight[k] * inverse(mass[contact.v[k]]);
    mobility += contact.weight[k] * w;
    if (supported[contact.v[k]] == 0) share[k] = w;
  }
  if (!projectOne(contact, motion, share, mobility, h)) return;
  for (int k = begin; k < end; ++k) raised_.push_back(contact.v[k]);
}

/// Projects a contact that moves all its vertices.
bool LayerContacts::projectFreely(Contact& contact, SubstepMotion motion,
                                  const std::vector<double>& mass, double h) {
  std::array<double, 4> share{};
  double mobility = 0.0;
  for (int k = 0; k < 4; ++k) {
    share[k] = contact.weight[k] * inverse(mass[contact.v[k]]);
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

/// Whether the contact keeps layers apart, rather than points that are near each other in the cloth
/// laid flat, such as the lips of a cut.
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
