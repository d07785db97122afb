#include "layer_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Lines whose sine is smaller count as parallel; a vertex and a face then carry the contact.
constexpr double kParallel = 0.05;
/// Edges keep this share of the thickness: so vertices and faces alone carry flat layers, and edges
/// only what rests on ridges.
constexpr double kEdgeShare = 0.993;
bool areAdjacent(const Face& a, const Face& b) {
  return contains(a, b[0]) || contains(a, b[1]) || contains(a, b[2]);
}

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
  sweeps_.clear();
  active_ = 0;
}

LayerContacts::Layers LayerContacts::layersOf(const std::array<VertexId, 4>& v) const {
  const LayerProperties& a = byCloth_[clothOfVertex_[v.front()]];
  const LayerProperties& b = byCloth_[clothOfVertex_[v.back()]];
  return {0.5 * (a.thickness + b.thickness), 0.5 * (a.friction + b.friction)};
}

void LayerContacts::assign(const std::vector<FaceIds>& near, const std::vector<QuickBox>& boxes) {
  // The contacts of the last substep stay, for whoever asks, until the next one refreshes them.
  candidates_.clear();
  extend(near, 0, Renewed(), boxes);
}

void LayerContacts::extend(const std::vector<FaceIds>& near, std::size_t known,
                           const Renewed& moved, const std::vector<QuickBox>& boxes) {
  candidates_.extend(near, known, moved, boxes);
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
  contact.corners = closest.areEdges() ? 2 : 1;
  Vec3 apart = Vec3::Zero();
  Vec2 atRest = Vec2::Zero();
  for (int k = 0; k < 4; ++k) {
    apart += contact.weight[k] * x[contact.v[k]];
    atRest += contact.weight[k] * material_[contact.v[k]];
  }
  contact.normal = apart / apart.norm();
  const double share = closest.areEdges() ? kEdgeShare : 1.0;
  // Points that are near each other in the cloth laid flat are not pushed apart.
  contact.distance = std::min(share * layersOf(contact.v).thickness, 0.9 * atRest.norm());
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
    if (isCloser && areAdjacent(faces_[other.face], faces_[self.face])) return false;
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

void LayerContacts::project(const SubstepMotion& motion, double h) {
  active_ = 0;
  substep_ = h;
  sweeps_.clear();
  if (candidates_.empty()) return;
  if (candidates_.follow(motion)) listContacts(motion.start);
  for (const VertexId v : motion.vertices) {
    inverseMass_[v] = motion.mass[v] > 0.0 ? 1.0 / motion.mass[v] : 0.0;
  }
  findTouching(motion);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (isTouching_[k] != 0) sweeps_.add(pushOf(contacts_[k], motion.start), h);
  }
  active_ = sweeps_.project(motion);
}

/// Tells whether a contact is too near at the end of the substep, or nearly so, or would be if it
/// came nearer by as much as it moves: what pushes one of its sides may come from another layer.
bool LayerContacts::mayTouch(const Contact& contact, const SubstepMotion& motion) {
  constexpr double kSlack = 1.003;  // of the distance to keep, because sweeps move the neighbours
  constexpr double kFar = 1.1;      // from here on it does not matter
  const auto gapOf = [&](const std::vector<Vec3>& x) {
    Vec3 apart = Vec3::Zero();
    for (int k = 0; k < 4; ++k) apart += contact.weight[k] * x[contact.v[k]];
    return contact.normal.dot(apart);
  };
  const double gap = gapOf(motion.end);
  const double near = kSlack * contact.distance;
  if (gap < near) return true;
  if (gap > kFar * contact.distance) return false;
  return gap < near + std::abs(gapOf(motion.start) - gap);
}

/// Finds the contacts that are too near at the end of the substep, or nearly so: sweeps over the
/// others would do nothing.
void LayerContacts::findTouching(const SubstepMotion& motion) {
  constexpr std::int32_t kGrain = 4096;
  isTouching_.resize(contacts_.size());
  parallelFor(static_cast<std::int32_t>(contacts_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last);
                     ++k) {
                  isTouching_[k] = mayTouch(contacts_[k], motion) ? 1 : 0;
                }
              });
}

LayerPush LayerContacts::pushOf(const Contact& contact, const std::vector<Vec3>& start) const {
  LayerPush push;
  push.v = contact.v;
  push.weight = contact.weight;
  push.normal = contact.normal;
  push.distance = contact.distance;
  push.corners = contact.corners;
  push.friction = layersOf(contact.v).friction;
  for (int k = 0; k < 4; ++k) {
    push.share[k] = contact.weight[k] * inverseMass_[contact.v[k]];
    push.before += contact.weight[k] * start[contact.v[k]];
  }
  return push;
}

/// Tells whether the contact keeps layers apart, rather than points that are near each other in the
/// cloth laid flat, such as the lips of a cut.
bool LayerContacts::isBetweenLayers(const LayerPush& push) const {
  return push.distance > 0.5 * layersOf(push.v).thickness;
}

/// The contacts that carried load in the last substep.
std::vector<LayerPush> LayerContacts::loaded() const {
  std::vector<LayerPush> loaded;
  for (const LayerPush& push : sweeps_.pushes()) {
    if (push.load > 0.0) loaded.push_back(push);
  }
  return loaded;
}

double LayerContacts::leastDistance(const std::vector<Vec3>& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (const LayerPush& push : sweeps_.pushes()) {
    if (push.load == 0.0 || !isBetweenLayers(push)) continue;
    Vec3 apart = Vec3::Zero();
    for (int i = 0; i < 4; ++i) apart += push.weight[i] * x[push.v[i]];
    least = std::min(least, apart.norm());
  }
  return least;
}

std::vector<LayerContactPoint> LayerContacts::loadedPoints(const std::vector<Vec3>& x,
                                                           std::size_t most) const {
  const std::vector<LayerPush> all = loaded();
  std::vector<LayerContactPoint> points(std::min(all.size(), most));
  for (std::size_t n = 0; n < points.size(); ++n) {
    const LayerPush& push = all[n * all.size() / points.size()];
    LayerContactPoint& point = points[n];
    // The weights of either side add up to 1 or -1.
    for (int i = 0; i < 4; ++i) point.place += 0.5 * std::abs(push.weight[i]) * x[push.v[i]];
    point.normal = push.normal;
    point.force = push.load / (substep_ * substep_);
  }
  return points;
}

}  // namespace cloth_sim
