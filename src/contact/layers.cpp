#include "cloth_sim/contact/layers.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "layer_contacts.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Particles that are faster than the cloth on average by more have diverged [m/s].
constexpr double kFastest = 500.0;
/// Substeps that a search for pairs allows for, at the speed of the present one.
constexpr double kSubstepsAhead = 4.0;
/// Motion that a search allows for at least [m].
constexpr double kLeastAllowance = 4e-4;
/// Change of a face's gradient that a search allows for at least [-].
constexpr double kLeastTurn = 0.2;
/// Most motion that a search allows for, unless a single substep takes more [m].
constexpr double kMostAllowance = 5e-3;
/// Share of the thickness below which layers do not get nearer where contact gives way.
constexpr double kLeastShare = 0.1;

std::size_t slotOf(const ParticleView& particles, std::size_t vertex) {
  return particles.slotOf != nullptr ? static_cast<std::size_t>(particles.slotOf[vertex]) : vertex;
}

Vec3 startOf(const ParticleView& particles, std::size_t slot) {
  return {particles.startX[slot], particles.startY[slot], particles.startZ[slot]};
}

Vec3 endOf(const ParticleView& particles, std::size_t slot) {
  return {particles.x[slot], particles.y[slot], particles.z[slot]};
}

/// Mean displacement of some vertices, evenly spread over all [m]. Any vector would do for what all
/// have in common, so a sample suffices.
Vec3 meanMotion(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  constexpr std::size_t kSample = 256;
  const std::size_t stride = std::max<std::size_t>(1, to.size() / kSample);
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t v = 0; v < to.size(); v += stride, ++count) sum += to[v] - from[v];
  return count == 0 ? sum : Vec3(sum / static_cast<double>(count));
}

/// Whether `holds(k)` for all k in [0, count); on several threads where that pays.
template <typename Holds>
bool holdsForAll(std::size_t count, const Holds& holds) {
  constexpr std::int32_t kGrain = 4096;
  std::atomic<bool> all{true};
  parallelFor(static_cast<std::int32_t>(count), kGrain, [&](std::int32_t first, std::int32_t last) {
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
      if (holds(k)) continue;
      all = false;
      return;
    }
  });
  return all;
}

}  // namespace

class LayerContact::Impl {
 public:
  Impl(const Model& model, std::vector<LayerProperties> byCloth) : byCloth_(std::move(byCloth)) {
    build(model);
  }

  void build(const Model& model);
  LayerOverlap findOverlap(const std::vector<Vec3>& x);
  void beginStep();
  void load(const ParticleView& particles);
  void project(const ParticleView& particles, double h);
  void settle(const ParticleView& particles, double h);
  void certify(const ParticleView& particles);
  bool isBlocked(std::size_t v) const;
  LayerReport wholeReport() const;
  std::vector<LayerContactPoint> contactPoints() const;

  LayerReport report;  ///< but for leastDistance

 private:
  void loadSupported(const ParticleView& particles);
  void store(const ParticleView& particles) const;
  template <typename Body>
  void forVertices(const Body& body) const;
  void loadStart(const ParticleView& particles);
  void loadEnd(const ParticleView& particles);
  double farthestMotion() const;
  void giveUp(const ParticleView& particles);
  bool isAllowed();
  bool isTurnAllowed(std::size_t f) const;
  bool isHeldBack(std::size_t v) const { return truncated_[v] != 0 && mass_[v] == 0.0; }
  bool isFarFromItself() const { return isFresh_ && pairs_.count() == 0; }
  void search();
  void allow();
  void allowFace(FaceId f);
  Gradient gradient(FaceId f, const std::vector<Vec3>& x) const;

  std::vector<LayerProperties> byCloth_;
  std::vector<Face> faces_;
  std::vector<Eigen::Matrix2d> inverseRest_;  ///< by face: of its edges in the material plane
  std::vector<MaterialTree> trees_;           ///< by cloth
  double margin_ = 0.0;                       ///< half of the largest thickness [m]
  FacePairs pairs_;
  LayerContacts contacts_;
  double most_ = 0.0;                ///< most motion in a substep [m]
  bool isFresh_ = false;             ///< pairs are those of this step
  std::vector<Vec3> start_, end_;    ///< of the substep, by vertex [m]
  std::vector<double> mass_;         ///< by vertex [kg]; 0: prescribed motion
  std::vector<Vec3> searched_;       ///< positions at the last search, by vertex [m]
  std::vector<Vec3> moved_;          ///< motion since then, against the mean, by vertex [m]
  std::vector<Box> allowed_;         ///< motion that it allowed, by vertex [m]
  std::vector<GradientBall> balls_;  ///< gradients that it allowed, by face
  std::vector<double> turn_;         ///< square of the edges' change within these, by face [m^2]
  std::vector<Box> boxes_;           ///< by face
  std::vector<FaceIds> near_;
  std::vector<std::uint8_t> truncated_;  ///< by vertex
  std::vector<std::uint8_t> supported_;  ///< by vertex; see LayerContacts::settle
};

void LayerContact::Impl::build(const Model& model) {
  faces_ = model.mesh.faces();
  inverseRest_.resize(faces_.size());
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    const Face& face = faces_[f];
    Eigen::Matrix2d rest;
    rest.col(0) = model.mesh.material(face[1]) - model.mesh.material(face[0]);
    rest.col(1) = model.mesh.material(face[2]) - model.mesh.material(face[0]);
    inverseRest_[f] = rest.inverse();
  }
  trees_.resize(model.cloths.size());
  for (std::size_t k = 0; k < trees_.size(); ++k) trees_[k].build(model, k);
  margin_ = 0.0;
  for (const LayerProperties& cloth : byCloth_) margin_ = std::max(margin_, 0.5 * cloth.thickness);
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  for (auto* array : {&start_, &end_, &searched_, &moved_}) array->resize(vertices);
  mass_.resize(vertices);
  allowed_.resize(vertices);
  truncated_.resize(vertices);
  supported_.resize(vertices);
  balls_.resize(faces_.size());
  turn_.resize(faces_.size());
  boxes_.resize(faces_.size());
  contacts_.build(model, byCloth_);
  beginStep();
}

LayerOverlap LayerContact::Impl::findOverlap(const std::vector<Vec3>& x) {
  start_ = x;
  end_ = x;
  search();
  LayerOverlap overlap;
  for (const FaceIds& ids : near_) {
    if (FacePairs::areApart(faces_[ids.first], faces_[ids.second], x)) continue;
    if (overlap.pairs++ > 0) continue;
    for (const FaceId f : {ids.first, ids.second}) {
      for (const VertexId v : faces_[f]) overlap.place += x[v] / 6.0;
    }
  }
  beginStep();
  return overlap;
}

void LayerContact::Impl::beginStep() {
  report = LayerReport();
  isFresh_ = false;
  pairs_.clear();
  contacts_.clear();
}

template <typename Body>
void LayerContact::Impl::forVertices(const Body& body) const {
  constexpr std::int32_t kGrain = 4096;
  parallelFor(static_cast<std::int32_t>(end_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (std::int32_t v = first; v < last; ++v) body(static_cast<std::size_t>(v));
              });
}

void LayerContact::Impl::load(const ParticleView& particles) {
  if (isFarFromItself()) return;
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    start_[v] = startOf(particles, k);
    end_[v] = endOf(particles, k);
    mass_[v] = particles.mass[k];
    supported_[v] = mass_[v] == 0.0 ? 1 : 0;
  });
}

/// Loads the ends of a substep, and marks vertices that were moved since they were stored.
void LayerContact::Impl::loadSupported(const ParticleView& particles) {
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    const Vec3 moved = endOf(particles, k);
    if (moved != end_[v]) supported_[v] = 1;
    end_[v] = moved;
  });
}

void LayerContact::Impl::loadStart(const ParticleView& particles) {
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    start_[v] = startOf(particles, k);
  });
}

void LayerContact::Impl::loadEnd(const ParticleView& particles) {
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    end_[v] = endOf(particles, k);
  });
}

void LayerContact::Impl::store(const ParticleView& particles) const {
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    particles.x[k] = end_[v].x();
    particles.y[k] = end_[v].y();
    particles.z[k] = end_[v].z();
  });
}

Gradient LayerContact::Impl::gradient(FaceId f, const std::vector<Vec3>& x) const {
  const Face& face = faces_[f];
  return Gradient::of(x[face[1]] - x[face[0]], x[face[2]] - x[face[0]], inverseRest_[f]);
}

/// The largest motion of a vertex in the substep, against the mean of all [m]; NaN if one is.
double LayerContact::Impl::farthestMotion() const {
  const Vec3 common = meanMotion(start_, end_);
  double square = 0.0;
  for (std::size_t v = 0; v < end_.size(); ++v) {
    const double moved = (end_[v] - start_[v] - common).squaredNorm();
    if (!(moved <= square)) square = moved;  // also for NaN, which stays then
    if (std::isnan(square)) return square;
  }
  return std::sqrt(square);
}

/// Whether the end of the substep is within what the last search allowed. Motion that all vertices
/// have in common does not count: it brings nothing together.
bool LayerContact::Impl::isAllowed() {
  if (!isFresh_) return false;
  const Vec3 common = meanMotion(searched_, end_);
  const bool areNear = holdsForAll(end_.size(), [&](std::size_t v) {
    moved_[v] = end_[v] - searched_[v] - common;
    return allowed_[v].contains(moved_[v]);
  });
  return areNear && holdsForAll(faces_.size(), [&](std::size_t f) { return isTurnAllowed(f); });
}

/// Whether the gradient of a face has changed by no more than the last search allowed.
bool LayerContact::Impl::isTurnAllowed(std::size_t f) const {
  const Face& face = faces_[f];
  const Vec3 first = moved_[face[1]] - moved_[face[0]];
  const Vec3 second = moved_[face[2]] - moved_[face[0]];
  // The norm of the edges' change bounds that of the gradient.
  if (first.squaredNorm() + second.squaredNorm() <= turn_[f]) return true;
  return Gradient::of(first, second, inverseRest_[f]).norm() <= balls_[f].radius;
}

/// Sets where vertices and gradients may go until the next search, seen from the mean of all
/// vertices: some substeps ahead like this one, or stopped by an obstacle, in this substep at
/// least.
void LayerContact::Impl::allow() {
  const Vec3 common = meanMotion(start_, end_);
  const auto aheadOf = [](const Vec3& motion) {
    const double length = motion.cwiseAbs().maxCoeff();
    const double most = length > 0.0 ? kMostAllowance / length : kSubstepsAhead;
    return Vec3(std::max(1.5, std::min(kSubstepsAhead, most)) * motion);
  };
  const Vec3 stopped = aheadOf(-common);
  forVertices([&](std::size_t v) {
    const Vec3 ahead = aheadOf(end_[v] - start_[v] - common);
    const Vec3 low = ahead.cwiseMin(stopped).cwiseMin(0.0).array() - kLeastAllowance;
    const Vec3 high = ahead.cwiseMax(stopped).cwiseMax(0.0).array() + kLeastAllowance;
    allowed_[v] = {low, high};
  });
  constexpr std::int32_t kGrain = 2048;
  parallelFor(static_cast<std::int32_t>(faces_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (FaceId f = first; f < last; ++f) allowFace(f);
              });
}

void LayerContact::Impl::allowFace(FaceId f) {
  GradientBall& ball = balls_[f];
  ball.centre = gradient(f, start_);
  const double turned = (gradient(f, end_) - ball.centre).norm();
  ball.radius = std::max(kLeastTurn, kSubstepsAhead * turned);
  turn_[f] = ball.radius * ball.radius / inverseRest_[f].squaredNorm();
  Box box;
  for (const VertexId v : faces_[f]) {
    const Vec3 margin = Vec3::Constant(margin_);
    box.add({start_[v] + allowed_[v].low - margin, start_[v] + allowed_[v].high + margin});
  }
  boxes_[f] = box;
}

/// Finds the pairs of faces that may touch before the next search.
void LayerContact::Impl::search() {
  allow();
  searched_ = start_;
  near_.clear();
  for (MaterialTree& tree : trees_) tree.refit(boxes_, balls_);
  for (std::size_t a = 0; a < trees_.size(); ++a) {
    trees_[a].collectOwn(boxes_, near_);
    for (std::size_t b = a + 1; b < trees_.size(); ++b) {
      MaterialTree::collectBetween(trees_[a], trees_[b], boxes_, near_);
    }
  }
  pairs_.assign(near_, faces_, kLeastShare * 2.0 * margin_);
  contacts_.assign(near_, start_, allowed_);
  isFresh_ = true;
  ++report.detections;
}

void LayerContact::Impl::project(const ParticleView& particles, double h) {
  most_ = kFastest * h;
  report.contacts = 0;
  if (isFarFromItself()) return;
  loadSupported(particles);
  const double farthest = farthestMotion();
  if (!(farthest <= most_)) return;
  if (!isFresh_) search();
  if (pairs_.count() == 0) return;
  contacts_.project({start_, end_}, mass_, h, farthest);
  report.contacts = contacts_.active();
  if (report.contacts > 0) store(particles);
}

void LayerContact::Impl::settle(const ParticleView& particles, double h) {
  loadSupported(particles);
  contacts_.settle({start_, end_}, mass_, h, supported_);
  store(particles);
}

/// Tells the method that it has diverged.
void LayerContact::Impl::giveUp(const ParticleView& particles) {
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  std::fill(end_.begin(), end_.end(), Vec3::Constant(kNotANumber));
  store(particles);
}

/// Shortening a motion may take faces out of what the search allowed: then there is another search,
/// from the start of the substep.
void LayerContact::Impl::certify(const ParticleView& particles) {
  loadEnd(particles);
  report.moves += static_cast<std::int64_t>(end_.size());
  report.blocked = 0;
  bool isAllowedNow = isAllowed();
  if (isFarFromItself()) {
    if (isAllowedNow) return;
    loadStart(particles);
  }
  // A comparison that is false for NaN. The motion would meet everything.
  if (!isAllowedNow && !(farthestMotion() <= most_)) return giveUp(particles);
  std::fill(truncated_.begin(), truncated_.end(), 0);
  const Truncation now{{start_, end_}, mass_, truncated_};
  constexpr int kMostSearches = 8;
  for (int searches = 0; searches < kMostSearches; ++searches) {
    if (!isAllowedNow) search();
    const PairOutcome outcome = pairs_.keepApart(now);
    report.unproven += outcome.unproven;
    isAllowedNow = !outcome.changed || isAllowed();
    if (isAllowedNow) break;
  }
  if (!isAllowedNow) FacePairs::stop(now);
  report.pairs = static_cast<int>(pairs_.count());
  const auto count = std::count(truncated_.begin(), truncated_.end(), 1);
  report.truncated += count;
  for (std::size_t v = 0; count > 0 && v < mass_.size(); ++v) {
    if (isHeldBack(v)) ++report.blocked;
  }
  if (count > 0) store(particles);
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

void LayerContact::beginStep() { impl_->beginStep(); }

void LayerContact::load(const ParticleView& particles) { impl_->load(particles); }

void LayerContact::project(const ParticleView& particles, double h) {
  impl_->project(particles, h);
}

void LayerContact::settle(const ParticleView& particles, double h) { impl_->settle(particles, h); }

void LayerContact::certify(const ParticleView& particles) { impl_->certify(particles); }

LayerReport LayerContact::report() const { return impl_->wholeReport(); }

bool LayerContact::isBlocked(VertexId v) const {
  return impl_->isBlocked(static_cast<std::size_t>(v));
}

bool LayerContact::carriesLoad() const { return impl_->report.contacts > 0; }

std::vector<LayerContactPoint> LayerContact::contactPoints() const {
  return impl_->contactPoints();
}

}  // namespace cloth_sim
