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
constexpr double kLeastAllowance = 2e-4;
/// Change of a face's gradient that a search allows for at least [-].
constexpr double kLeastTurn = 0.2;
/// Most motion that a search allows for, unless a single substep takes more [m].
constexpr double kMostAllowance = 5e-3;
/// Share of the thickness below which layers do not get nearer where contact gives way.
constexpr double kLeastShare = 0.1;

std::size_t slotOf(const ParticleView& particles, std::size_t vertex) {
  return particles.slotOf != nullptr ? static_cast<std::size_t>(particles.slotOf[vertex]) : vertex;
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

  LayerReport report;

 private:
  void loadSupported(const ParticleView& particles);
  void store(const ParticleView& particles) const;
  template <typename Body>
  void forVertices(const Body& body) const;
  void loadEnd(const ParticleView& particles);
  double farthestMotion() const;
  void giveUp(const ParticleView& particles);
  Vec3 meanMotion(const std::vector<Vec3>& from) const;
  double farthestSinceSearch(const Vec3& common) const;
  bool isAllowed() const;
  void search();
  void allow();
  void allowFace(FaceId f);
  Gradient gradient(FaceId f, const std::vector<Vec3>& x) const;

  std::vector<LayerProperties> byCloth_;
  std::vector<Face> faces_;
  std::vector<Eigen::Matrix2d> inverseRest_;  ///< by face: of its edges in the material plane
  double sharpest_ = 0.0;                     ///< largest norm of these [1/m]
  std::vector<MaterialTree> trees_;           ///< by cloth
  double margin_ = 0.0;                       ///< half of the largest thickness [m]
  FacePairs pairs_;
  LayerContacts contacts_;
  double most_ = 0.0;                ///< most motion in a substep [m]
  bool isFresh_ = false;             ///< pairs are those of this step
  std::vector<Vec3> start_, end_;    ///< of the substep, by vertex [m]
  std::vector<double> mass_;         ///< by vertex [kg]; 0: prescribed motion
  std::vector<Vec3> searched_;       ///< positions at the last search, by vertex [m]
  std::vector<Box> allowed_;         ///< motion that it allowed, by vertex [m]
  std::vector<GradientBall> balls_;  ///< gradients that it allowed, by face
  std::vector<Box> boxes_;           ///< by face
  std::vector<FaceIds> near_;
  std::vector<std::uint8_t> truncated_;  ///< by vertex
  std::vector<std::uint8_t> supported_;  ///< by vertex; see LayerContacts::settle
};

void LayerContact::Impl::build(const Model& model) {
  faces_ = model.mesh.faces();
  inverseRest_.resize(faces_.size());
  sharpest_ = 0.0;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    const Face& face = faces_[f];
    Eigen::Matrix2d rest;
    rest.col(0) = model.mesh.material(face[1]) - model.mesh.material(face[0]);
    rest.col(1) = model.mesh.material(face[2]) - model.mesh.material(face[0]);
    inverseRest_[f] = rest.inverse();
    sharpest_ = std::max(sharpest_, inverseRest_[f].norm());
  }
  trees_.resize(model.cloths.size());
  for (std::size_t k = 0; k < trees_.size(); ++k) trees_[k].build(model, k);
  margin_ = 0.0;
  for (const LayerProperties& cloth : byCloth_) margin_ = std::max(margin_, 0.5 * cloth.thickness);
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  for (auto* array : {&start_, &end_, &searched_}) array->resize(vertices);
  mass_.resize(vertices);
  allowed_.resize(vertices);
  truncated_.resize(vertices);
  supported_.resize(vertices);
  balls_.resize(faces_.size());
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
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    start_[v] = Vec3(particles.startX[k], particles.startY[k], particles.startZ[k]);
    end_[v] = Vec3(particles.x[k], particles.y[k], particles.z[k]);
    mass_[v] = particles.mass[k];
    supported_[v] = mass_[v] == 0.0 ? 1 : 0;
  });
}

/// Loads the ends of a substep, and marks vertices that were moved since they were stored.
void LayerContact::Impl::loadSupported(const ParticleView& particles) {
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    const Vec3 moved(particles.x[k], particles.y[k], particles.z[k]);
    if (moved != end_[v]) supported_[v] = 1;
    end_[v] = moved;
  });
}

void LayerContact::Impl::loadEnd(const ParticleView& particles) {
  forVertices([&](std::size_t v) {
    const auto k = slotOf(particles, v);
    end_[v] = Vec3(particles.x[k], particles.y[k], particles.z[k]);
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
  Gradient edges;
  edges.col(0) = x[face[1]] - x[face[0]];
  edges.col(1) = x[face[2]] - x[face[0]];
  return edges * inverseRest_[f];
}

/// Mean displacement of all vertices [m].
Vec3 LayerContact::Impl::meanMotion(const std::vector<Vec3>& from) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < end_.size(); ++v) sum += end_[v] - from[v];
  return end_.empty() ? sum : Vec3(sum / static_cast<double>(end_.size()));
}

/// The largest motion of a vertex in the substep, against the mean of all [m]; NaN if one is.
double LayerContact::Impl::farthestMotion() const {
  const Vec3 common = meanMotion(start_);
  double square = 0.0;
  for (std::size_t v = 0; v < end_.size(); ++v) {
    const double moved = (end_[v] - start_[v] - common).squaredNorm();
    if (!(moved <= square)) square = moved;  // also for NaN, which stays then
    if (std::isnan(square)) return square;
  }
  return std::sqrt(square);
}

/// The largest distance of a vertex from where the last search would have it, if it had moved like
/// all on average: such a motion brings nothing together [m].
double LayerContact::Impl::farthestSinceSearch(const Vec3& common) const {
  double square = 0.0;
  for (std::size_t v = 0; v < end_.size(); ++v) {
    square = std::max(square, (end_[v] - searched_[v] - common).squaredNorm());
  }
  return std::sqrt(square);
}

/// Whether the end of the substep is within what the last search allowed.
bool LayerContact::Impl::isAllowed() const {
  if (!isFresh_) return false;
  const Vec3 common = meanMotion(searched_);
  const double farthest = farthestSinceSearch(common);
  if (farthest > kLeastAllowance) {
    const bool areNear = holdsForAll(end_.size(), [&](std::size_t v) {
      return allowed_[v].contains(end_[v] - searched_[v] - common);
    });
    if (!areNear) return false;
  }
  // The columns of a face's edges change by twice the farthest motion at most.
  if (2.0 * std::sqrt(2.0) * farthest * sharpest_ <= kLeastTurn) return true;
  return holdsForAll(faces_.size(), [&](std::size_t f) {
    const GradientBall& ball = balls_[f];
    const Gradient now = gradient(static_cast<FaceId>(f), end_);
    return (now - ball.centre).squaredNorm() <= ball.radius * ball.radius;
  });
}

/// Sets where vertices and gradients may go until the next search, seen from the mean of all
/// vertices: some substeps ahead like this one, or stopped by an obstacle, in this substep at
/// least.
void LayerContact::Impl::allow() {
  const Vec3 common = meanMotion(start_);
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
  loadSupported(particles);
  most_ = kFastest * h;
  report.contacts = 0;
  const double farthest = farthestMotion();
  if (!(farthest <= most_)) return;
  if (!isFresh_) search();
  if (pairs_.count() == 0) return;
  contacts_.project({start_, end_}, mass_, h, farthest);
  report.contacts = contacts_.active();
  report.leastDistance = contacts_.leastDistance();
  store(particles);
}

void LayerContact::Impl::settle(const ParticleView& particles, double h) {
  if (report.contacts == 0) return;
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
  // A comparison that is false for NaN. The motion would meet everything.
  if (!(farthestMotion() <= most_)) return giveUp(particles);
  report.moves += static_cast<std::int64_t>(end_.size());
  std::fill(truncated_.begin(), truncated_.end(), 0);
  const Truncation now{{start_, end_}, mass_, truncated_};
  constexpr int kMostSearches = 8;
  bool isAllowedNow = isAllowed();
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
  report.blocked = 0;
  for (std::size_t v = 0; count > 0 && v < mass_.size(); ++v) {
    if (truncated_[v] != 0 && mass_[v] == 0.0) ++report.blocked;
  }
  if (count > 0) store(particles);
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

const LayerReport& LayerContact::report() const { return impl_->report; }

}  // namespace cloth_sim
