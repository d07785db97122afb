#include "cloth_sim/contact/layers.h"

#include <utility>

#include "clearance.h"
#include "near_layers.h"

namespace cloth_sim {

class LayerContact::Impl {
 public:
  Impl(const Model& model, std::vector<LayerProperties> byCloth) : byCloth_(std::move(byCloth)) {
    build(model);
  }

  void build(const Model& model);
  LayerOverlap findOverlap(const Model& model, const std::vector<Vec3>& x);
  LayerOverlap findOverlap(const Model& model, const std::vector<Vec3>& x,
                           const std::vector<FaceId>& faces);
  void beginStep(const Model& model, StepPart part);
  void load(const ParticleView& particles);
  void project(const ParticleView& particles, double h);
  void certify(const ParticleView& particles);
  bool endStep(const ParticleView& particles);
  bool mayComeNear() const { return mode_ == Mode::kUndecided && clearance_.isUsable(); }
  bool hasComeNear() const { return mode_ == Mode::kCameNear; }
  LayerReport report() const;
  /// Null if the cloth has never been near itself.
  const NearLayers* nearOrNull() const { return near_.get(); }
  NearLayers& near();

 private:
  /// The way in which a step is done.
  enum class Mode {
    kUndecided,  ///< the next substep finds out
    kClear,      ///< the cloth is nowhere near itself: there is nothing to do
    kCameNear,   ///< it was, and is not any more: the step is thrown away
    kSearching,  ///< faces near each other are searched for
  };

  void checkClearance(const ParticleView& particles);

  std::vector<LayerProperties> byCloth_;
  const Model* model_ = nullptr;  ///< of the step
  Clearance clearance_;
  std::unique_ptr<NearLayers> near_;  ///< made when it is needed first: most cloths never are
  StepPart part_ = StepPart::kWhole;
  Mode mode_ = Mode::kUndecided;
  double h_ = 0.0;          ///< length of a substep [s]
  int unchecked_ = 0;       ///< substeps since the last check of a clear cloth
  std::int64_t moves_ = 0;  ///< see LayerReport
};

void LayerContact::Impl::build(const Model& model) {
  clearance_.build(model, marginOf(byCloth_));
  if (near_) near_->build(model, byCloth_);
  beginStep(model, StepPart::kWhole);
}

NearLayers& LayerContact::Impl::near() {
  if (!near_) {
    near_ = std::make_unique<NearLayers>();
    near_->build(*model_, byCloth_);
    near_->beginStep(part_);
  }
  return *near_;
}

LayerOverlap LayerContact::Impl::findOverlap(const Model& model, const std::vector<Vec3>& x) {
  beginStep(model, StepPart::kWhole);
  if (clearance_.isClearAt(x)) return {};
  return near().overlapOf(x, std::vector<std::uint8_t>(model.mesh.faces().size(), 1));
}

LayerOverlap LayerContact::Impl::findOverlap(const Model& model, const std::vector<Vec3>& x,
                                             const std::vector<FaceId>& faces) {
  beginStep(model, StepPart::kWhole);
  std::vector<std::uint8_t> isAsked(model.mesh.faces().size(), 0);
  for (const FaceId f : faces) isAsked[f] = 1;
  return near().overlapOf(x, isAsked);
}

void LayerContact::Impl::beginStep(const Model& model, StepPart part) {
  model_ = &model;
  part_ = part;
  if (near_) near_->beginStep(part);
  const bool mayGoOn = near_ && near_->mayGoOn();
  mode_ = part == StepPart::kAgain || mayGoOn ? Mode::kSearching : Mode::kUndecided;
  unchecked_ = 0;
  moves_ = 0;
}

void LayerContact::Impl::load(const ParticleView& particles) {
  if (mode_ == Mode::kUndecided) {
    mode_ = clearance_.begin(particles) ? Mode::kClear : Mode::kSearching;
  }
  if (mode_ == Mode::kSearching) near().load(particles);
}

void LayerContact::Impl::project(const ParticleView& particles, double h) {
  h_ = h;
  if (mode_ == Mode::kSearching) near().project(particles, h);
}

void LayerContact::Impl::certify(const ParticleView& particles) {
  moves_ += model_->particleCount();
  if (mode_ == Mode::kSearching) {
    near().certify(particles);
  } else if (mode_ == Mode::kClear && ++unchecked_ >= Clearance::interval(h_)) {
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

LayerReport LayerContact::Impl::report() const {
  LayerReport report = near_ ? near_->report() : LayerReport();
  report.moves = moves_;
  return report;
}

LayerContact::LayerContact(const Model& model, std::vector<LayerProperties> byCloth)
    : impl_(std::make_unique<Impl>(model, std::move(byCloth))) {}

LayerContact::~LayerContact() = default;

void LayerContact::onModelChanged(const Model& model) { impl_->build(model); }

LayerOverlap LayerContact::findOverlap(const Model& model, const std::vector<Vec3>& x) {
  return impl_->findOverlap(model, x);
}

LayerOverlap LayerContact::findOverlap(const Model& model, const std::vector<Vec3>& x,
                                       const std::vector<FaceId>& faces) {
  return impl_->findOverlap(model, x, faces);
}

void LayerContact::beginStep(const Model& model, StepPart part) { impl_->beginStep(model, part); }

void LayerContact::load(const ParticleView& particles) { impl_->load(particles); }

void LayerContact::project(const ParticleView& particles, double h) {
  impl_->project(particles, h);
}

void LayerContact::settle(const ParticleView& particles, double h) {
  impl_->near().settle(particles, h);
}

void LayerContact::certify(const ParticleView& particles) { impl_->certify(particles); }

bool LayerContact::endStep(const ParticleView& particles) { return impl_->endStep(particles); }

bool LayerContact::mayComeNear() const { return impl_->mayComeNear(); }

bool LayerContact::hasComeNear() const { return impl_->hasComeNear(); }

LayerReport LayerContact::report() const { return impl_->report(); }

bool LayerContact::isBlocked(VertexId v) const {
  const NearLayers* near = impl_->nearOrNull();
  return near != nullptr && near->isBlocked(static_cast<std::size_t>(v));
}

bool LayerContact::carriesLoad() const {
  const NearLayers* near = impl_->nearOrNull();
  return near != nullptr && near->carriesLoad();
}

const std::vector<VertexId>& LayerContact::pushed() const { return impl_->near().pushed(); }

std::vector<LayerContactPoint> LayerContact::contactPoints() const {
  const NearLayers* near = impl_->nearOrNull();
  return near == nullptr ? std::vector<LayerContactPoint>() : near->contactPoints();
}

}  // namespace cloth_sim
