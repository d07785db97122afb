#include "cloth_sim/contact/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "clearance.h"
#include "face_pair_search.h"
#include "layer_contacts.h"

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

class LayerContact::Impl {
 public:
  Impl(const Model& model, std::vector<LayerProperties> byCloth) : byCloth_(std::move(byCloth)) {
    build(model);
  }

  void build(const Model& model);
  LayerOverlap findOverlap(const std::vector<Vec3>& x);
  LayerOverlap findOverlap(const std::vector<Vec3>& x, const std::vector<FaceId>& faces);
  void beginStep(StepPart part);
  void load(const ParticleView& particles);
  void project(const ParticleView& particles, double h);
  void settle(const ParticleView& particles, double h);
  void certify(const ParticleView& particles);
  bool endStep(const ParticleView& particles);
  bool mayComeNear() const { return mode_ == Mode::kUndecided && clearance_.isUsable(); }
  bool hasComeNear() const { return mode_ == Mode::kCameNear; }
  bool isBlocked(std::size_t v) const;
  LayerReport wholeReport() const;
  std::vector<LayerContactPoint> contactPoints() const;

  LayerReport report;            ///< but for leastDistance
  std::vector<VertexId> pushed;  ///< by the last `project` that found contacts, ascending

 private:
  /// The way in which a step is done.
  enum class Mode {
    kUndecided,  ///< the next substep finds out
    kClear,      ///< the cloth is nowhere near itself: there is nothing to do
    kCameNear,   ///< it was, and is not any more: the step is thrown away
    kSearching,  ///< faces near each other are searched for
  };

  /// \param isAsked  by face: 1 if pairs with it matter.
  LayerOverlap overlapOf(const std::vector<Vec3>& x, const std::vector<std::uint8_t>& isAsked);
  void checkClearance(const ParticleView& particles);
  void certifyPairs(const ParticleView& particles);
  bool goesOn(const ParticleView& particles) const;
  void forgetPairs();
  void loadSupported(const ParticleView& particles);
  void loadAll(const ParticleView& particles);
  void loadPairs(const ParticleView& particles);
  void store(const ParticleView& particles) const;
  void storePushed(const ParticleView& particles);
  void storeOne(VertexId v, const ParticleView& particles) const;
  double farthestMotion();
  void giveUp(const ParticleView& particles);
  void stop(const ParticleView& particles);
  SubstepMotion motion() { return {start_, end_, mass_, vertices_}; }
  bool isHeldBack(std::size_t v) const { return truncated_[v] != 0 && mass_[v] == 0.0; }
  void search();
  bool searchAroundLeft(const ParticleView& particles);
  void searchAll(const ParticleView& particles);
  void listVertices();

  std::vector<LayerProperties> byCloth_;
  std::vector<Face> faces_;
  double margin_ = 0.0;  ///< half of the largest thickness [m]
  FacePairSearch search_;
  Clearance clearance_;
  FacePairs pairs_;
  LayerContacts contacts_;
  double most_ = 0.0;     ///< most motion in a substep [m]
  bool isFresh_ = false;  ///< pairs are those of this step
  bool mayGoOn_ = false;  ///< pairs are those of an earlier part of this step
  bool isBrief_ = false;  ///< the next search is that of the rest of a step
  Mode mode_ = Mode::kUndecided;
  int unchecked_ = 0;               ///< substeps since the last check of a clear cloth
  std::vector<VertexId> all_;       ///< all vertices
  std::vector<VertexId> vertices_;  ///< those that arrays of the substep are loaded for, ascending
  std::vector<Vec3> start_, end_;   ///< of the substep, by vertex [m]
  std::vector<double> mass_;        ///< by vertex [kg]; 0: prescribed motion
  std::vector<std::uint8_t> truncated_;  ///< by vertex
  std::vector<std::uint8_t> supported_;  ///< by vertex; see LayerContacts::settle
  std::vector<std::uint8_t> isListed_;   ///< by vertex: 1 if it belongs to a pair
  std::size_t listed_ = 0;               ///< pairs whose vertices have that mark
};

void LayerContact::Impl::build(const Model& model) {
  faces_ = model.mesh.faces();
  margin_ = 0.0;
  for (const LayerProperties& cloth : byCloth_) margin_ = std::max(margin_, 0.5 * cloth.thickness);
  search_.build(model, margin_);
  clearance_.build(model, search_, margin_);
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  all_.resize(vertices);
  std::iota(all_.begin(), all_.end(), 0);
  start_.resize(vertices);
  end_.resize(vertices);
  mass_.resize(vertices);
  truncated_.resize(vertices);
  supported_.resize(vertices);
  isListed_.resize(vertices);
  contacts_.build(model, byCloth_);
  beginStep(StepPart::kWhole);
}

LayerOverlap LayerContact::Impl::findOverlap(const std::vector<Vec3>& x) {
  return overlapOf(x, std::vector<std::uint8_t>(faces_.size(), 1));
}

LayerOverlap LayerContact::Impl::findOverlap(const std::vector<Vec3>& x,
                                             const std::vector<FaceId>& faces) {
  std::vector<std::uint8_t> isAsked(faces_.size(), 0);
  for (const FaceId f : faces) isAsked[f] = 1;
  return overlapOf(x, isAsked);
}

LayerOverlap LayerContact::Impl::overlapOf(const std::vector<Vec3>& x,
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
  beginStep(StepPart::kWhole);
  return overlap;
}

void LayerContact::Impl::beginStep(StepPart part) {
  report = LayerReport();
  isBrief_ = part == StepPart::kRest;
  mayGoOn_ = isBrief_ && isFresh_;
  mode_ = part == StepPart::kAgain || mayGoOn_ ? Mode::kSearching : Mode::kUndecided;
  unchecked_ = 0;
  if (!mayGoOn_) forgetPairs();
}

/// Forgets what the last search allowed.
void LayerContact::Impl::forgetPairs() {
  isFresh_ = false;
  vertices_ = all_;
  pairs_.clear();
  contacts_.clear();
}

void LayerContact::Impl::load(const ParticleView& particles) {
  if (mode_ == Mode::kUndecided) {
    mode_ = clearance_.begin(particles) ? Mode::kClear : Mode::kSearching;
  }
  if (mode_ != Mode::kSearching) return;
  if (std::exchange(mayGoOn_, false) && !goesOn(particles)) forgetPairs();
  for (const VertexId v : vertices_) {
    const std::int32_t k = particles.slot(v);
    start_[v] = particles.startAt(k);
    end_[v] = particles.at(k);
    mass_[v] = particles.mass[k];
    supported_[v] = mass_[v] == 0.0 ? 1 : 0;
  }
}

/// Tells whether a substep begins where the last one ended.
bool LayerContact::Impl::goesOn(const ParticleView& particles) const {
  return search_.allowance().isFollowing(particles) &&
         std::all_of(vertices_.begin(), vertices_.end(),
                     [&](VertexId v) { return particles.startAt(particles.slot(v)) == end_[v]; });
}

/// Loads the ends of a substep, and marks vertices that were moved since they were stored.
void LayerContact::Impl::loadSupported(const ParticleView& particles) {
  for (const VertexId v : vertices_) {
    const Vec3 moved = particles.at(particles.slot(v));
    if (moved != end_[v]) supported_[v] = 1;
    end_[v] = moved;
  }
}

/// Loads both ends of the substep of all vertices.
void LayerContact::Impl::loadAll(const ParticleView& particles) {
  vertices_ = all_;
  load(particles);
}

/// Loads the vertices of pairs: their ends, and the whole substep of all where there are new ones.
void LayerContact::Impl::loadPairs(const ParticleView& particles) {
  if (vertices_.size() == all_.size() || listed_ < search_.near().size()) {
    listVertices();
    load(particles);
  } else {
    for (const VertexId v : vertices_) end_[v] = particles.at(particles.slot(v));
  }
}

void LayerContact::Impl::store(const ParticleView& particles) const {
  for (const VertexId v : vertices_) storeOne(v, particles);
}

/// Stores the vertices that contacts have pushed, and lists them.
void LayerContact::Impl::storePushed(const ParticleView& particles) {
  pushed.clear();
  for (const VertexId v : vertices_) {
    if (particles.at(particles.slot(v)) == end_[v]) continue;
    pushed.push_back(v);
    storeOne(v, particles);
  }
}

void LayerContact::Impl::storeOne(VertexId v, const ParticleView& particles) const {
  const std::int32_t k = particles.slot(v);
  particles.x[k] = end_[v].x();
  particles.y[k] = end_[v].y();
  particles.z[k] = end_[v].z();
}

/// The largest motion of a loaded vertex in the substep, against the mean of them [m]; NaN if one
/// is.
double LayerContact::Impl::farthestMotion() {
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
void LayerContact::Impl::search() {
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
  contacts_.assign(search_.near(), search_.corners());
  isFresh_ = true;
  ++report.detections;
}

/// Searches around what has left where it was allowed to be, from the start of the substep on.
/// \return whether that is little; if not, there was no search.
bool LayerContact::Impl::searchAroundLeft(const ParticleView& particles) {
  const std::size_t known = search_.near().size();
  const double few = known > faces_.size() ? kFewOfMany : kFew;
  if (!isFresh_ || !search_.allowance().renewLeft(particles, few, most_)) return false;
  search_.findAround();
  pairs_.append(search_.near(), known);
  contacts_.extend(search_.near(), known, search_.allowance().renewed(), search_.corners());
  return true;
}

/// Searches from the start of the substep on. All vertices are loaded.
void LayerContact::Impl::searchAll(const ParticleView& particles) {
  search();
  search_.allowance().follow(particles);
}

/// Lists the vertices of pairs: only these are loaded from now on.
void LayerContact::Impl::listVertices() {
  for (; listed_ < search_.near().size(); ++listed_) {
    for (const FaceId f : {search_.near()[listed_].first, search_.near()[listed_].second}) {
      for (const VertexId v : faces_[f]) isListed_[v] = 1;
    }
  }
  vertices_.clear();
  for (std::size_t v = 0; v < isListed_.size(); ++v) {
    if (isListed_[v] != 0) vertices_.push_back(static_cast<VertexId>(v));
  }
}

void LayerContact::Impl::project(const ParticleView& particles, double h) {
  most_ = kFastest * h;
  report.contacts = 0;
  if (mode_ != Mode::kSearching) return;
  if (isFresh_ && pairs_.count() == 0) return;
  loadSupported(particles);
  if (!(farthestMotion() <= most_)) return;
  if (!isFresh_) searchAll(particles);
  if (pairs_.count() == 0) return;
  contacts_.project(motion(), h);
  report.contacts = contacts_.active();
  storePushed(particles);
}

void LayerContact::Impl::settle(const ParticleView& particles, double h) {
  loadSupported(particles);
  contacts_.settle(motion(), h, supported_);
  store(particles);
}

/// Tells the method that it has diverged.
void LayerContact::Impl::giveUp(const ParticleView& particles) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  std::fill(end_.begin(), end_.end(), Vec3::Constant(kNotANumber));
  store(particles);
}

void LayerContact::Impl::certify(const ParticleView& particles) {
  report.moves += static_cast<std::int64_t>(end_.size());
  report.blocked = 0;
  if (mode_ == Mode::kSearching) {
    certifyPairs(particles);
  } else if (mode_ == Mode::kClear && ++unchecked_ == Clearance::kInterval) {
    checkClearance(particles);
  }
}

void LayerContact::Impl::checkClearance(const ParticleView& particles) {
  unchecked_ = 0;
  if (!clearance_.follow(particles)) mode_ = Mode::kCameNear;
}

bool LayerContact::Impl::endStep(const ParticleView& particles) {
  if (unchecked_ > 0) checkClearance(particles);
  return !hasComeNear();
}

/// Shortening a motion may take faces out of what the search allowed: then there is another search,
/// from the start of the substep.
void LayerContact::Impl::certifyPairs(const ParticleView& particles) {
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
    const PairOutcome outcome = pairs_.keepApart({motion(), truncated_});
    report.unproven += outcome.unproven;
    if (outcome.changed) store(particles);
    isAllowed = !outcome.changed || search_.allowance().isKept(particles);
    if (isAllowed) break;
    loadAll(particles);
  }
  if (!isAllowed) stop(particles);
  report.pairs = static_cast<int>(pairs_.count());
  for (const VertexId v : vertices_) {
    report.truncated += truncated_[v] != 0 ? 1 : 0;
    if (isHeldBack(v)) ++report.blocked;
  }
  if (vertices_.size() == all_.size()) listVertices();
}

/// Takes all motion of the substep back.
void LayerContact::Impl::stop(const ParticleView& particles) {
  loadAll(particles);
  pairs_.stop({motion(), truncated_});
  store(particles);
}

bool LayerContact::Impl::isBlocked(std::size_t v) const {
  return report.blocked > 0 && isHeldBack(v);
}

LayerReport LayerContact::Impl::wholeReport() const {
  LayerReport whole = report;
  if (report.contacts > 0) whole.leastDistance = contacts_.leastDistance(end_);
  return whole;
}

std::vector<LayerContactPoint> LayerContact::Impl::contactPoints() const {
  if (report.contacts == 0) return {};
  return contacts_.loadedPoints(end_, kMostContactPoints);
}

LayerContact::LayerContact(const Model& model, std::vector<LayerProperties> byCloth)
    : impl_(std::make_unique<Impl>(model, std::move(byCloth))) {}

LayerContact::~LayerContact() = default;

void LayerContact::onModelChanged(const Model& model) { impl_->build(model); }

LayerOverlap LayerContact::findOverlap(const std::vector<Vec3>& x) { return impl_->findOverlap(x); }

LayerOverlap LayerContact::findOverlap(const std::vector<Vec3>& x,
                                       const std::vector<FaceId>& faces) {
  return impl_->findOverlap(x, faces);
}

void LayerContact::beginStep(StepPart part) { impl_->beginStep(part); }

void LayerContact::load(const ParticleView& particles) { impl_->load(particles); }

void LayerContact::project(const ParticleView& particles, double h) {
  impl_->project(particles, h);
}

void LayerContact::settle(const ParticleView& particles, double h) { impl_->settle(particles, h); }

void LayerContact::certify(const ParticleView& particles) { impl_->certify(particles); }

bool LayerContact::endStep(const ParticleView& particles) { return impl_->endStep(particles); }

bool LayerContact::mayComeNear() const { return impl_->mayComeNear(); }

bool LayerContact::hasComeNear() const { return impl_->hasComeNear(); }

LayerReport LayerContact::report() const { return impl_->wholeReport(); }

bool LayerContact::isBlocked(VertexId v) const {
  return impl_->isBlocked(static_cast<std::size_t>(v));
}

bool LayerContact::carriesLoad() const { return impl_->report.contacts > 0; }

const std::vector<VertexId>& LayerContact::pushed() const { return impl_->pushed; }

std::vector<LayerContactPoint> LayerContact::contactPoints() const {
  return impl_->contactPoints();
}

}  // namespace cloth_sim
