#include <cmath>
#include <stdexcept>

#include "added_inertia.h"
#include "constraints/line_projection.h"
#include "error_control.h"
#include "linalg/vector_operations.h"
#include "methods.h"
#include "plate_projection.h"
#include "position_based.h"
#include "sim/archive.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

/// Extended position-based dynamics with small steps in which whole lines of springs are projected
/// at once, by a direct solve (constraints/line_projection.h): along the threads, across the cells,
/// and along bend springs. Tension reaches from one end of a line to the other within a substep.
///
/// A sweep over single springs is softer than the fabric by T h^2 (w_a + w_b) in a spring of
/// tension T; here that remains only of what lines of different directions bear together, and
/// `AddedInertia` bounds it.
class LineXpbd final : public SubstepMethod {
 public:
  explicit LineXpbd(const ErrorGoal& goal) : control_(goal), before_{{}, control_} {}

  void begin(Substep& now) override;
  void advance(Substep& now) override;
  void finish(Substep& now) override;
  void remember() override;
  void takeBack() override;
  int substepsOfStep(double dt, int substeps) const override {
    return control_.substepsFor(dt, substeps);
  }
  const ErrorEstimate* error() const override { return &control_.estimate(); }
  void save(StateWriter& archive) const override;
  void load(StateReader& archive, const Particles& particles) override;

 private:
  /// Substeps from one measurement of the displacements in vain to the next, from the first one of
  /// a step; while motion is quasi-static they are measured in every substep.
  static constexpr int kMeasureEvery = 4;
  /// Substeps by which the bending of a plate lags, as if by a dashpot: contact excites corners
  /// that are free, and a backward difference alone damps too little for heaps to come to rest.
  static constexpr double kBendLag = 1.0;

  /// The memory that outlives a substep.
  struct Memory {
    AddedInertia inertia;
    ErrorControl control;
  };

  void layOut(Substep& now);
  void keepFall(Substep& now) const;
  void projectLines(Substep& now);
  bool measures(const Substep& now) const;
  void projectContacts(Substep& now);
  void updateInertia(const Substep& now);
  void passOnPull(Substep& now);

  SpringLines lines_;
  LineProjection projection_;
  AddedInertia inertia_;
  ErrorControl control_;
  PlateProjection bending_;
  double preparedFor_ = 0.0;  ///< length of the substep that lines are prepared for [s]
  double decay_ = 1.0;        ///< factor by which drag reduces a velocity in a substep
  int substep_ = 0;           ///< of the step
  int sinceMeasured_ = 0;     ///< substeps
  Memory before_;             ///< at the start of a part of a step that may be thrown away
  VectorArray pull_;
  ScalarArray cancelled_;
};

void LineXpbd::save(StateWriter& archive) const {
  inertia_.save(archive);
  archive(control_);
}

void LineXpbd::load(StateReader& archive, const Particles& particles) {
  inertia_.load(archive);
  archive(control_);
  const auto slots = static_cast<std::size_t>(particles.slots);
  if (!inertia_.fits(slots)) throw std::invalid_argument("inertia is added to no particle");
  if (!control_.isPlausible()) throw std::invalid_argument("the control of errors is in no state");
}

void LineXpbd::begin(Substep& now) {
  if (now.isNewModel) layOut(now);
  if (now.isNewLayout || preparedFor_ != now.h) {
    projection_.setStep(now.h);
    bending_.setStep(now, kBendLag * now.h);
    inertia_.setStep(now.h);
    preparedFor_ = now.h;
  }
  if (now.controls.quasiStatic) inertia_.followTension(now.model, now.particles, now.h);
  decay_ = std::exp(-now.controls.drag * now.h);
  beginPrediction(now);
  control_.begin(now.particles);
  substep_ = 0;
  sinceMeasured_ = kMeasureEvery;
}

void LineXpbd::finish(Substep& now) {
  findVelocities(now);
  now.addedMass = inertia_.addedFraction(now.particles);
  control_.end(now.particles, now.h, substep_ * now.h, now.fraction == 1.0);
}

void LineXpbd::remember() {
  before_.inertia = inertia_;
  before_.control = control_;
}

void LineXpbd::takeBack() {
  inertia_ = before_.inertia;
  control_ = before_.control;
}

void LineXpbd::layOut(Substep& now) {
  lines_.build(now.model, now.particles.slotOf);
  projection_.prepare(lines_, now.model.springs);
  bending_.build(now);
  inertia_.layOut(now.model, now.particles);
  control_.layOut(now.model);
  const std::size_t n = now.particles.mass.size();
  setZero(n, pull_);
  cancelled_.assign(n, 0.0);
}

void LineXpbd::advance(Substep& now) {
  if (substep_ == 0 || sinceMeasured_ == 0) inertia_.find(now.particles);
  predictPositions(now, decay_, inertia_.inverse());
  keepFall(now);
  now.placeKinematic();
  if (!bending_.empty()) bending_.project(inertia_.inverse(), now);
  projectLines(now);
  ++substep_;
  passOnPull(now);
  projectContacts(now);
  if (now.controls.hasLoads()) findVelocities(now);  // they depend on velocities
}

/// Takes back the fall of added inertia, which has no weight.
void LineXpbd::keepFall(Substep& now) const {
  Particles& p = now.particles;
  const Vec3 fall = now.h * now.h * now.controls.gravity;
  for (const std::int32_t slot : inertia_.heavier()) {
    const auto k = static_cast<std::size_t>(slot);
    p.x.set(k, p.x.at(k) - (1.0 - p.mass[k] * inertia_.inverse()[k]) * fall);
  }
}

void LineXpbd::projectLines(Substep& now) {
  Particles& p = now.particles;
  ++sinceMeasured_;
  if (!measures(now)) {
    return projection_.project(lines_, inertia_.inverse(), p, pull_);
  }
  sinceMeasured_ = 0;
  projection_.projectAndMeasure(lines_, inertia_.inverse(), p, pull_, cancelled_);
  control_.addCancelled(inertia_.largestFraction(cancelled_));
  updateInertia(now);
}

/// Tells whether displacements in vain are measured in this substep.
bool LineXpbd::measures(const Substep& now) const {
  return now.controls.quasiStatic || sinceMeasured_ >= kMeasureEvery;
}

/// Contacts move particles by their inertia, as lines and bending do: the two sides of a contact
/// would be out of balance otherwise, and layers under tension would drive themselves.
void LineXpbd::projectContacts(Substep& now) {
  ParticleView view = now.particles.view();
  view.mass = inertia_.whole().data();
  now.contacts.project(view, now.time, now.h);
}

void LineXpbd::updateInertia(const Substep& now) {
  if (now.controls.quasiStatic) {
    const bool hasLayers = now.contacts.layers != nullptr;
    inertia_.updateQuasiStatic(now.h, hasLayers, now.particles, cancelled_);
  } else {
    inertia_.update(now.h, kMeasureEvery * now.h, now.particles, cancelled_);
  }
}

/// Tells holders what the lines have done to their particles.
void LineXpbd::passOnPull(Substep& now) {
  for (const std::int32_t slot : now.kinematic.slots()) {
    const auto k = static_cast<std::size_t>(slot);
    now.kinematic.addImpulseAt(k, pull_.at(k) / now.h);
    pull_.set(k, Vec3::Zero());
  }
}

SolverParameter errorParameter() {
  SolverParameter parameter;
  parameter.name = "error";
  parameter.maximum = 1.0;
  parameter.description =
      "bound on the errors of the largest strain and, over the side, of positions: chooses the "
      "substeps; 0: as many as `substeps` says";
  return parameter;
}

SolverParameter budgetParameter() {
  SolverParameter parameter = substepsParameter(40);
  parameter.name = "budget";
  parameter.description = "most parts that `error` may divide a step into";
  return parameter;
}

}  // namespace

SolverInfo lineXpbdInfo() {
  SolverInfo info;
  info.name = "line_xpbd";
  info.title = "Extended position-based dynamics, line by line";
  info.reference =
      "Macklin, Mueller & Chentanez 2016; direct solves of chains: Deul et al. 2018; added "
      "inertia: Olovsson, Simonsson & Unosson 2005";
  info.limitations =
      "first order in time; particles next to a concentrated load accelerate too slowly";
  info.order = 1;
  info.hasBendFriction = true;
  info.usesQuasiStatic = true;
  info.noTearEnergy = "at a tip springs are longer than their tension makes them";
  info.parameters = {substepsParameter(30), errorParameter(), budgetParameter()};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    const ErrorGoal goal{p.at("error"), static_cast<int>(p.at("budget"))};
    return std::make_unique<SubstepSolver>(model, substepsOf(p), std::make_unique<LineXpbd>(goal));
  };
  return info;
}

}  // namespace cloth_sim
