#include "near_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace cloth_sim {
namespace {

/// Particles that are faster than the cloth on average by more have diverged [m/s].
constexpr double kFastest = 500.0;
/// Reach of searches where cloth is far from itself.
constexpr Reach kFar{16.0, 1.5e-3, 8e-3, 0.35};
/// Reach of searches where it is not: boxes that meet cost more than another search.
constexpr Reach kNear{4.0, 4e-4, 5e-3, 0.2};
/// Reach of the first search after an edit in the middle of a step: the next one is often near.
constexpr Reach kBrief{2.5, 2e-4, 5e-3, 0.15};
/// Reach of searches for what touches where it is.
constexpr Reach kNowhere{0.0, 0.0, 0.0, 0.0};
/// Share of the number of faces that there are pairs of where cloth is near itself.
constexpr double kNearShare = 1.0 / 64.0;
/// Share of the faces around which is searched at a time, before all are; and where there are more
/// pairs than faces, because a search of all has more to find again then.
constexpr double kFew = 0.05;
constexpr double kFewOfMany = 0.15;
/// Share of the thickness below which layers do not get nearer where contact gives way.
constexpr double kLeastShare = 0.1;

}  // namespace

double marginOf(const std::vector<LayerProperties>& byCloth) {
  double margin = 0.0;
  for (const LayerProperties& cloth : byCloth) margin = std::max(margin, 0.5 * cloth.thickness);
  return margin;
}

void NearLayers::build(const Model& model, const std::vector<LayerProperties>& byCloth) {
  faces_ = model.mesh.faces();
  margin_ = marginOf(byCloth);
  search_.build(model, margin_);
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  all_.resize(vertices);
  std::iota(all_.begin(), all_.end(), 0);
  start_.resize(vertices);
  end_.resize(vertices);
  mass_.resize(vertices);
  truncated_.resize(vertices);
  supported_.resize(vertices);
  isListed_.resize(vertices);
  contacts_.build(model, byCloth);
}

LayerOverlap NearLayers::overlapOf(const std::vector<Vec3>& x,
                                   const std::vector<std::uint8_t>& isAsked) {
  search_.findPairs(x, x, kNowhere, NearPairs::kAll);
  LayerOverlap overlap;
  for (const FaceIds& ids : search_.near()) {
    if ((isAsked[ids.first] | isAsked[ids.second]) == 0) continue;
    if (areApart(faces_[ids.first], faces_[ids.second], x)) continue;
    overlap.pairs.push_back({ids.first, ids.second});
    if (overlap.pairs.size() > 1) continue;
    for (const FaceId f : {ids.first, ids.second}) {
      for (const VertexId v : faces_[f]) overlap.place += x[v] / 6.0;
    }
  }
  return overlap;
}

void NearLayers::beginStep(StepPart part) {
  report_ = LayerReport();
  isBrief_ = part == StepPart::kRest;
  mayGoOn_ = isBrief_ && isFresh_;
  if (!mayGoOn_) forgetPairs();
}

/// Forgets what the last search allowed.
void NearLayers::forgetPairs() {
  isFresh_ = false;
  vertices_ = all_;
  pairs_.clear();
  contacts_.clear();
}

void NearLayers::load(const ParticleView& particles) {
  if (std::exchange(mayGoOn_, false) && !goesOn(particles)) forgetPairs();
  std::fill(supported_.begin(), supported_.end(), 0);
  loadMotion(particles);
}

/// Loads both ends of the substep.
void NearLayers::loadMotion(const ParticleView& particles) {
  for (const VertexId v : vertices_) {
    const std::int32_t k = particles.slot(v);
    start_[v] = particles.startAt(k);
    end_[v] = particles.at(k);
    mass_[v] = particles.mass[k];
    if (mass_[v] == 0.0) supported_[v] = 1;
  }
}

/// Tells whether a substep begins where the last one ended.
bool NearLayers::goesOn(const ParticleView& particles) const {
  return search_.allowance().isFollowing(particles) &&
         std::all_of(vertices_.begin(), vertices_.end(),
                     [&](VertexId v) { return particles.startAt(particles.slot(v)) == end_[v]; });
}

/// Loads the ends of a substep, and marks vertices that were moved since they were stored.
void NearLayers::loadSupported(const ParticleView& particles) {
  for (const VertexId v : vertices_) {
    const Vec3 moved = particles.at(particles.slot(v));
    if (moved != end_[v]) supported_[v] = 1;
    end_[v] = moved;
  }
}

/// Loads both ends of the substep of all vertices.
void NearLayers::loadAll(const ParticleView& particles) {
  vertices_ = all_;
  loadMotion(particles);
}

/// Loads the vertices of pairs: their ends, and the whole substep of all where there are new ones.
void NearLayers::loadPairs(const ParticleView& particles) {
  if (vertices_.size() == all_.size() || listed_ < pairs_.faces().size()) {
    listVertices();
    loadMotion(particles);
  } else {
    for (const VertexId v : vertices_) end_[v] = particles.at(particles.slot(v));
  }
}

void NearLayers::store(const ParticleView& particles) const {
  for (const VertexId v : vertices_) storeOne(v, particles);
}

/// Stores the vertices that contacts have pushed, and lists them.
void NearLayers::storePushed(const ParticleView& particles) {
  pushed_.clear();
  for (const VertexId v : vertices_) {
    if (particles.at(particles.slot(v)) == end_[v]) continue;
    pushed_.push_back(v);
    storeOne(v, particles);
  }
}

void NearLayers::storeOne(VertexId v, const ParticleView& particles) const {
  const std::int32_t k = particles.slot(v);
  particles.x[k] = end_[v].x();
  particles.y[k] = end_[v].y();
  particles.z[k] = end_[v].z();
}

/// The largest motion of a loaded vertex in the substep, against the mean of them [m]; NaN if one
/// is.
double NearLayers::farthestMotion() {
  const Vec3 common = meanMotion(motion());
  double square = 0.0;
  for (const VertexId v : vertices_) {
    const double moved = (end_[v] - start_[v] - common).squaredNorm();
    if (!(moved <= square)) square = moved;  // also for NaN, which stays then
    if (std::isnan(square)) return square;
  }
  return std::sqrt(square);
}

/// Finds the pairs of faces that may touch before the next search. Far reach spares searches where
/// there are few of them.
void NearLayers::search() {
  const auto many = static_cast<std::size_t>(kNearShare * static_cast<double>(faces_.size()));
  const bool wereMany = isFresh_ && search_.near().size() > many;
  const auto find = [this](const Reach& reach, std::size_t most) {
    return search_.findPairs(start_, end_, reach, most);
  };
  if (std::exchange(isBrief_, false)) {
    find(kBrief, NearPairs::kAll);
  } else if (wereMany || !find(kFar, many)) {
    find(kNear, NearPairs::kAll);
  }
  listed_ = 0;
  std::fill(isListed_.begin(), isListed_.end(), 0);
  pairs_.assign(search_.near(), faces_, kLeastShare * 2.0 * margin_);
  contacts_.assign(nearFaces());
  isFresh_ = true;
  ++report_.detections;
}

/// Searches around what has left where it was allowed to be, from the start of the substep on.
/// \return whether that is little; if not, there was no search.
bool NearLayers::searchAroundLeft(const ParticleView& particles) {
  const std::size_t known = search_.near().size();
  const double few = known > faces_.size() ? kFewOfMany : kFew;
  if (!isFresh_ || !search_.allowance().renewLeft(particles, few, most_)) return false;
  search_.findAround();
  pairs_.append(search_.near(), known);
  contacts_.extend(nearFaces(), known, search_.allowance().renewed());
  return true;
}

/// Searches from the start of the substep on. All vertices are loaded.
void NearLayers::searchAll(const ParticleView& particles) {
  search();
  search_.allowance().follow(particles);
}

/// Lists the vertices of pairs: only these are loaded from now on.
void NearLayers::listVertices() {
  for (; listed_ < pairs_.faces().size(); ++listed_) {
    for (const VertexId v : faces_[pairs_.faces()[listed_]]) isListed_[v] = 1;
  }
  vertices_.clear();
  for (std::size_t v = 0; v < isListed_.size(); ++v) {
    if (isListed_[v] != 0) vertices_.push_back(static_cast<VertexId>(v));
  }
}

void NearLayers::project(const ParticleView& particles, double h) {
  most_ = kFastest * h;
  report_.contacts = 0;
  if (isFresh_ && pairs_.count() == 0) return;
  loadSupported(particles);
  if (!(farthestMotion() <= most_)) return;
  if (!isFresh_) searchAll(particles);
  if (pairs_.count() == 0) return;
  contacts_.project(motion(), h, nearFaces());
  report_.contacts = contacts_.active();
  storePushed(particles);
}

void NearLayers::settle(const ParticleView& particles, double h) {
  loadSupported(particles);
  contacts_.settle(motion(), h, supported_);
  store(particles);
}

/// Tells the method that it has diverged.
void NearLayers::giveUp(const ParticleView& particles) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  std::fill(end_.begin(), end_.end(), Vec3::Constant(kNotANumber));
  store(particles);
}

/// Shortening a motion may take faces out of what the search allowed: then there is another search,
/// from the start of the substep.
void NearLayers::certify(const ParticleView& particles) {
  report_.blocked = 0;
  std::fill(truncated_.begin(), truncated_.end(), 0);
  bool isAllowed =
      isFresh_ && (search_.allowance().isKept(particles) || searchAroundLeft(particles));
  if (isAllowed) {
    loadPairs(particles);
    if (pairs_.count() == 0) return;
  } else {
    loadAll(particles);
    // A comparison that is false for NaN. The motion would meet everything.
    if (!(farthestMotion() <= most_)) return giveUp(particles);
  }
  constexpr int kMostSearches = 8;
  for (int searches = 0; searches < kMostSearches; ++searches) {
    if (!isAllowed && (searches == 0 || !searchAroundLeft(particles))) searchAll(particles);
    const PairOutcome outcome = pairs_.keepApart({motion(), truncated_, supported_});
    report_.unproven += outcome.unproven;
    if (outcome.changed) store(particles);
    isAllowed = !outcome.changed || search_.allowance().isKept(particles);
    if (isAllowed) break;
    loadAll(particles);
  }
  if (!isAllowed) stop(particles);
  report_.pairs = static_cast<int>(pairs_.count());
  for (const VertexId v : vertices_) {
    report_.truncated += truncated_[v] != 0 ? 1 : 0;
    if (isHeldBack(v)) ++report_.blocked;
  }
  if (vertices_.size() == all_.size()) listVertices();
}

/// Takes all motion of the substep back.
void NearLayers::stop(const ParticleView& particles) {
  loadAll(particles);
  pairs_.stop({motion(), truncated_, supported_});
  store(particles);
}

LayerReport NearLayers::report() const {
  LayerReport report = report_;
  if (report.contacts > 0) report.leastDistance = contacts_.leastDistance(end_);
  return report;
}

std::vector<LayerContactPoint> NearLayers::contactPoints() const {
  if (report_.contacts == 0) return {};
  return contacts_.loadedPoints(end_, kMostContactPoints);
}

}  // namespace cloth_sim
