#include "layer_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Layers that are nearer than their thickness when a step begins, as after a cut, part at this
/// speed [m/s].
constexpr double kPartingSpeed = 0.2;
/// Lines whose sine is smaller count as parallel; a vertex and a face then carry the contact.
constexpr double kParallel = 0.05;
/// Edges keep this share of the thickness: so vertices and faces alone carry flat layers, and edges
/// only what rests on ridges. Flat edges are left out: they stay farther apart than that.
constexpr double kEdgeShare = 1.0 - 2.0 * Ridges::kFlatShare;
/// A push moves no vertex by more than this many times what is missing in the distance: where the
/// closest point is nearly at a vertex that cannot move, a light one beside it would be thrown far.
constexpr double kFarthestPush = 4.0;
/// Layers that rest on layers are settled more than once: what is left of a load throws them, each
/// one and a half times as fast as the one below.
constexpr int kRoundsAbove = 2;

bool areParallel(const std::array<VertexId, 4>& v, const std::vector<Vec3>& x) {
  const Vec3 a = x[v[1]] - x[v[0]];
  const Vec3 b = x[v[3]] - x[v[2]];
  return a.cross(b).squaredNorm() < kParallel * kParallel * a.squaredNorm() * b.squaredNorm();
}

}  // namespace

void LayerContacts::build(const Model& model, const std::vector<LayerProperties>& byCloth) {
  const TriangleMesh& mesh = model.mesh;
  byCloth_ = byCloth;
  faces_ = mesh.faces();
  material_ = mesh.material();
  clothOfVertex_.resize(material_.size());
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    clothOfVertex_[v] = static_cast<std::uint8_t>(model.clothOf(v));
  }
  std::vector<double> thickness;
  for (const LayerProperties& cloth : byCloth) thickness.push_back(cloth.thickness);
  inverseMass_.resize(material_.size());
  candidates_.build(model, thickness);
  clear();
}

void LayerContacts::clear() {
  candidates_.clear();
  contacts_.clear();
  pushes_.clear();
  touching_.clear();
  active_ = 0;
}

LayerContacts::Layers LayerContacts::layersOf(const Contact& contact) const {
  const LayerProperties& a = byCloth_[clothOfVertex_[contact.v.front()]];
  const LayerProperties& b = byCloth_[clothOfVertex_[contact.v.back()]];
  return {0.5 * (a.thickness + b.thickness), 0.5 * (a.friction + b.friction)};
}

void LayerContacts::assign(const NearFaces& near) {
  // The contacts of the last substep stay, for whoever asks, until the next one refreshes them.
  candidates_.clear();
  extend(near, 0, Renewed());
}

void LayerContacts::extend(const NearFaces& near, std::size_t known, const Renewed& moved) {
  candidates_.extend(near, known, moved);
}

/// Tells whether closest points can carry a contact.
bool LayerContacts::canCarry(const ClosestPoints& closest, const std::vector<Vec3>& x) {
  return closest.apart > 0.0 && !(closest.areEdges() && areParallel(closest.v, x));
}

LayerContacts::Contact LayerContacts::contactAt(const ClosestPoints& closest,
                                                const std::vector<Vec3>& x) const {
  Contact contact;
  contact.v = closest.v;
  contact.weight = closest.weight;
  Vec3 apart = Vec3::Zero();
  Vec2 atRest = Vec2::Zero();
  for (int k = 0; k < 4; ++k) {
    apart += contact.weight[k] * x[contact.v[k]];
    atRest += contact.weight[k] * material_[contact.v[k]];
  }
  contact.normal = apart / apart.norm();
  const double share = closest.areEdges() ? kEdgeShare : 1.0;
  // Points that are near each other in the cloth laid flat are not pushed apart.
  contact.distance = std::min(share * layersOf(contact).thickness, 0.9 * atRest.norm());
  return contact;
}

/// Tells whether no face next to that of number `at` of the order is closer to the same vertex, of
/// those in [first, last) of it.
bool LayerContacts::isClosestFace(std::size_t first, std::size_t last, std::size_t at) const {
  const ClosestPoints& self = pointsAt(at);
  if (self.areInside()) return true;
  for (std::size_t k = first; k < last; ++k) {
    const ClosestPoints& other = pointsAt(k);
    if (k == at) continue;
    const bool isCloser =
        other.apart < self.apart || (other.apart == self.apart && other.face < self.face);
    if (isCloser && haveCommonCorner(faces_[other.face], faces_[self.face])) return false;
  }
  return true;
}

/// Puts the faces near each vertex together, in the order of vertices, then edges by their first
/// vertex (a counting sort).
void LayerContacts::sortByVertex(const std::vector<Vec3>& x) {
  const std::vector<ClosestPoints>& found = candidates_.found();
  const std::size_t vertices = material_.size();
  const auto keyOf = [&](const ClosestPoints& of) {
    return static_cast<std::size_t>(of.v[0]) + (of.areEdges() ? vertices : 0);
  };
  carrying_.clear();
  first_.assign(2 * vertices + 1, 0);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!canCarry(found[k], x)) continue;
    carrying_.push_back(static_cast<std::uint32_t>(k));
    ++first_[keyOf(found[k]) + 1];
  }
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  order_.resize(carrying_.size());
  for (const std::uint32_t k : carrying_) order_[first_[keyOf(found[k])]++] = k;
}

/// Lists the contacts that may touch until the next time, and of each vertex only those with the
/// faces that are locally closest. Candidates that are listed twice count once.
void LayerContacts::listContacts(const std::vector<Vec3>& x) {
  sortByVertex(x);
  contacts_.clear();
  pushes_.clear();
  for (std::size_t first = 0; first < order_.size();) {
    const ClosestPoints& group = pointsAt(first);
    std::size_t last = first + 1;
    while (last < order_.size() && pointsAt(last).v[0] == group.v[0] &&
           pointsAt(last).areEdges() == group.areEdges()) {
      ++last;
    }
    for (std::size_t k = first; k < last; ++k) {
      const ClosestPoints& closest = pointsAt(k);
      if (isListed(first, k) || (!closest.areEdges() && !isClosestFace(first, last, k))) continue;
      contacts_.push_back(contactAt(closest, x));
      pushes_.emplace_back();
      pushes_.back().corners = closest.areEdges() ? 2 : 1;
      pushes_.back().friction = layersOf(contacts_.back()).friction;
    }
    first = last;
  }
}

/// Tells whether the same vertices as in number `at` of the order are in [first, at) of it.
bool LayerContacts::isListed(std::size_t first, std::size_t at) const {
  for (std::size_t k = first; k < at; ++k) {
    if (pointsAt(k).v == pointsAt(at).v) return true;
  }
  return false;
}

void LayerContacts::project(const SubstepMotion& motion, double h, const NearFaces& near) {
  active_ = 0;
  substep_ = h;
  if (candidates_.follow(motion, near)) listContacts(motion.start);
  for (const VertexId v : motion.vertices) {
    inverseMass_[v] = motion.mass[v] > 0.0 ? 1.0 / motion.mass[v] : 0.0;
  }
  findTouching(motion.end);
  for (const std::uint32_t k : touching_) projectFreely(k, motion, h);
  for (auto k = touching_.rbegin(); k != touching_.rend(); ++k) {
    if (projectFreely(*k, motion, h)) ++active_;
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
                  const Contact& contact = contacts_[k];
                  Vec3 apart = Vec3::Zero();
                  for (int i = 0; i < 4; ++i) apart += contact.weight[i] * x[contact.v[i]];
                  isTouching_[k] = contact.normal.dot(apart) < kSlack * contact.distance ? 1 : 0;
                }
              });
  touching_.clear();
  for (std::size_t k = 0; k < isTouching_.size(); ++k) {
    if (isTouching_[k] == 0) continue;
    touching_.push_back(static_cast<std::uint32_t>(k));
    pushes_[k].load = 0.0;
    pushes_[k].drag.setZero();
  }
}

void LayerContacts::settle(const SubstepMotion& motion, double h,
                           std::vector<std::uint8_t>& supported) {
  pending_ = touching_;
  const auto isSettled = [&](std::uint32_t k) {
    return isSideSupported(k, true, supported) && isSideSupported(k, false, supported);
  };
  constexpr int kMostLevels = 32;
  for (int level = 0; level < kMostLevels; ++level) {
    raised_.clear();
    const int rounds = level == 0 ? 1 : kRoundsAbove;
    for (int round = 0; round < rounds; ++round) settleLevel(motion, h, supported);
    if (raised_.empty()) return;
    for (const VertexId v : raised_) supported[v] = 1;
    pending_.erase(std::remove_if(pending_.begin(), pending_.end(), isSettled), pending_.end());
  }
}

/// Sweeps once forwards and once backwards over the contacts with one side that is supported.
void LayerContacts::settleLevel(const SubstepMotion& motion, double h,
                                const std::vector<std::uint8_t>& supported) {
  for (const std::uint32_t k : pending_) settleOne(k, motion, h, supported);
  for (auto k = pending_.rbegin(); k != pending_.rend(); ++k) {
    settleOne(*k, motion, h, supported);
  }
}

/// Tells whether all vertices that take part on a side of a contact are supported.
bool LayerContacts::isSideSupported(std::size_t k, bool first,
                                    const std::vector<std::uint8_t>& supported) const {
  const Contact& contact = contacts_[k];
  const int corners = pushes_[k].corners;
  for (int i = first ? 0 : corners; i < (first ? corners : 4); ++i) {
    if (contact.weight[i] != 0.0 && supported[contact.v[i]] == 0) return false;
  }
  return true;
}

/// Projects a contact with one side that is supported and another that is not.
void LayerContacts::settleOne(std::size_t number, const SubstepMotion& motion, double h,
                              const std::vector<std::uint8_t>& supported) {
  const bool first = isSideSupported(number, true, supported);
  if (first == isSideSupported(number, false, supported)) return;
  const Contact& contact = contacts_[number];
  const int corners = pushes_[number].corners;
  const int begin = first ? corners : 0;
  const int end = first ? 4 : corners;
  // The mobility is that of the whole side, also where a part of it is supported: the rest would
  // be thrown far to make up for it.
  std::array<double, 4> share{};
  double mobility = 0.0;
  for (int k = begin; k < end; ++k) {
    const double w = contact.weight[k] * inverseMass_[contact.v[k]];
    mobility += contact.weight[k] * w;
    if (supported[contact.v[k]] == 0) share[k] = w;
  }
  if (!projectOne(number, motion, share, mobility, h)) return;
  for (int k = begin; k < end; ++k) raised_.push_back(contact.v[k]);
}

/// Projects a contact that moves all its vertices.
bool LayerContacts::projectFreely(std::size_t number, const SubstepMotion& motion, double h) {
  const Contact& contact = contacts_[number];
  std::array<double, 4> share{};
  double mobility = 0.0;
  for (int k = 0; k < 4; ++k) {
    share[k] = contact.weight[k] * inverseMass_[contact.v[k]];
    mobility += contact.weight[k] * share[k];
  }
  return projectOne(number, motion, share, mobility, h);
}

/// Pushes the sides of a contact apart, or lets them come nearer by what it pushed before, and
/// brings friction within its bound.
/// \param share     displacement of each vertex per load [1/kg].
/// \param mobility  displacement of the sides against each other per load [1/kg].
/// \return whether it carries load.
bool LayerContacts::projectOne(std::size_t number, const SubstepMotion& motion,
                               const std::array<double, 4>& share, double mobility, double h) {
  const Contact& contact = contacts_[number];
  Push& push = pushes_[number];
  const std::array<VertexId, 4>& v = contact.v;
  const std::array<double, 4>& w = contact.weight;
  const Vec3& n = contact.normal;
  Vec3 after = Vec3::Zero();
  for (int k = 0; k < 4; ++k) after += w[k] * motion.end[v[k]];
  const double gap = n.dot(after);
  if (gap >= contact.distance && push.load == 0.0) return false;
  if (!(mobility > 0.0)) return push.load > 0.0;
  for (const double displacement : share) {
    mobility = std::max(mobility, std::abs(displacement) / kFarthestPush);
  }
  Vec3 before = Vec3::Zero();
  for (int k = 0; k < 4; ++k) before += w[k] * motion.start[v[k]];
  const double aim = std::min(contact.distance, n.dot(before) + kPartingSpeed * h);
  const double load = std::max(0.0, push.load + (aim - gap) / mobility);
  Vec3 slip = after - before;
  slip -= n.dot(slip) * n;
  Vec3 drag = push.drag - slip / mobility;
  drag -= n.dot(drag) * n;
  const double bound = push.friction * load;
  if (drag.squaredNorm() > bound * bound) drag *= bound / drag.norm();
  const Vec3 move = (load - push.load) * n + drag - push.drag;
  push.load = load;
  push.drag = drag;
  for (int k = 0; k < 4; ++k) motion.end[v[k]] += share[k] * move;
  return load > 0.0;
}

/// Tells whether the contact keeps layers apart, rather than points that are near each other in the
/// cloth laid flat, such as the lips of a cut.
bool LayerContacts::isBetweenLayers(const Contact& contact) const {
  return contact.distance > 0.5 * layersOf(contact).thickness;
}

/// Numbers of the contacts that carried load in the last substep, ascending.
std::vector<std::uint32_t> LayerContacts::loaded() const {
  std::vector<std::uint32_t> numbers;
  for (const std::uint32_t k : touching_) {
    if (pushes_[k].load > 0.0) numbers.push_back(k);
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
    const std::uint32_t k = all[n * all.size() / points.size()];
    const Contact& contact = contacts_[k];
    LayerContactPoint& point = points[n];
    // The weights of either side add up to 1 or -1.
    for (int i = 0; i < 4; ++i) point.place += 0.5 * std::abs(contact.weight[i]) * x[contact.v[i]];
    point.normal = contact.normal;
    point.force = pushes_[k].load / (substep_ * substep_);
  }
  return points;
}

}  // namespace cloth_sim
