#include "substep_solver.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cloth_sim/contact/layers.h"
#include "sim/archive.h"
#include "step_count.h"

namespace cloth_sim {
namespace {

/// Speed that no cloth reaches [m/s]: a method that diverges is noticed long before its numbers
/// overflow.
constexpr double kFastest = 1e4;

Particles packed(const Model& model) {
  Particles particles;
  particles.layOut(model);
  return particles;
}

}  // namespace

SubstepSolver::SubstepSolver(const Model& model, int substeps,
                             std::unique_ptr<SubstepMethod> method)
    : method_(std::move(method)),
      configured_(substeps),
      substeps_(substeps),
      particles_(packed(model)),
      springs_(model, particles_.slotOf) {}

void SubstepSolver::onModelChanged(const Model& model, const ModelChanges& changes) {
  particles_.applyChanges(changes.mesh);
  applyChanges(model, changes.springs);
}

void SubstepSolver::applyChanges(const Model& model, const SpringChanges& changes) {
  springs_.applyChanges(model, changes, particles_.slotOf);
  substeps_ = method_->substepsFor(model, configured_);
  isNewModel_ = true;
}

void SubstepSolver::save(StateWriter& archive) const {
  archive(particles_);
  method_->save(archive);
}

/// The schedule of the springs follows from the undamaged model and the springs there are now.
void SubstepSolver::load(StateReader& archive, const Model& model) {
  archive(particles_);
  const std::string error = particles_.validationError(model.particleCount());
  if (!error.empty()) throw std::invalid_argument(error);
  particles_.resize();
  applyChanges(model, model.springs.allModified());
  method_->load(archive, particles_);
}

const StepReport& SubstepSolver::step(const Model& model, State& state, const Controls& controls,
                                      Contacts& contacts, const StepLength& length) {
  const Division division = divide(length);
  Substep now{model,      controls, contacts, particles_,  springs_,
              kinematic_, force_,   scratch_, windSpeeds_, division.h};
  now.stop = length.stop;
  particles_.load(state);
  begin(now, state.t + division.dt, division.dt);
  if (contacts.layers != nullptr && contacts.layers->mayComeNear()) method_->remember();
  const int done = advance(now, division, state.t);
  isNewModel_ = false;
  if (now.isStopped()) {
    report_.status = StepStatus::kStopped;
    return report_;
  }
  if (contacts.layers != nullptr && !contacts.layers->endStep(particles_.view())) {
    method_->takeBack();
    report_.status = StepStatus::kCameNear;
    return report_;
  }
  method_->finish(now);
  report_.iterations = now.iterations;
  report_.residual = now.residual;
  report_.addedMass = now.addedMass;
  report_.status = particles_.areSlowerThan(kFastest) ? StepStatus::kOk : StepStatus::kDiverged;
  if (const ErrorEstimate* const error = method_->error()) report_.error = *error;
  if (report_.status == StepStatus::kDiverged) return report_;
  const bool isWhole = done == division.substeps;
  finish(now, length, isWhole ? division.dt : done * division.h, isWhole, state);
  return report_;
}

SubstepSolver::Division SubstepSolver::divide(const StepLength& length) const {
  constexpr double kRounding = 1e-9;
  const double left = 1.0 - length.done;
  const int wanted = method_->substepsOfStep(length.dt, substeps_);
  const int substeps = stepCount(left * wanted * length.substepFactor);
  // Substeps as long as those of a whole step have the same h to the bit: matrices depend on it.
  const double all = std::round(substeps / left);
  const bool isAsLong = std::abs(all * left - substeps) < kRounding;
  return {length.left(), substeps, isAsLong ? length.dt / all : length.left() / substeps};
}

/// \param end  time at the end of the step [s].
void SubstepSolver::begin(Substep& now, double end, double dt) {
  now.isNewModel = isNewModel_;
  now.isNewLayout = kinematic_.load(now.controls, particles_) || isNewModel_;
  if (now.isNewLayout) {
    particles_.loadMasses(now.model, now.controls.kinematic);
    kinematic_.indexSlots(particles_.slots);
  }
  kinematic_.keepOutOf(now.contacts, now.controls, end, dt);
  kinematic_.setVelocities(dt, particles_);
  loadLimits(now.controls);
  report_.passedLimit = false;
  report_.substep = now.h;
  method_->begin(now);
}

/// \return substeps done: all, or those up to the first in which a length limit is passed.
int SubstepSolver::advance(Substep& now, const Division& division, double startTime) {
  int done = 0;
  while (done < division.substeps && !report_.passedLimit && !now.isOver()) {
    now.before = static_cast<double>(done) / division.substeps;
    now.fraction = static_cast<double>(++done) / division.substeps;
    now.time = startTime + now.fraction * division.dt;
    method_->advance(now);
    report_.passedLimit = isLimitPassed();
  }
  return done;
}

/// \param dt  time that has passed [s].
void SubstepSolver::finish(Substep& now, const StepLength& length, double dt, bool isWhole,
                           State& state) {
  particles_.store(state);
  for (const KinematicTarget& target : now.controls.kinematic) {
    state.v[target.vertex] = target.velocity;
  }
  state.t += dt;
  report_.substeps = static_cast<int>(std::lround(length.dt / now.h));
  report_.fraction = isWhole ? 1.0 : length.done + dt / length.dt;
  kinematic_.findReactions(now.model, now.controls, dt, report_.reactions);
}

void SubstepSolver::loadLimits(const Controls& controls) {
  limits_.clear();
  for (const LengthLimit& limit : controls.limits) {
    limits_.push_back({static_cast<std::size_t>(particles_.slotOf[limit.a]),
                       static_cast<std::size_t>(particles_.slotOf[limit.b]),
                       limit.length * limit.length});
  }
}

bool SubstepSolver::isLimitPassed() const {
  return std::any_of(limits_.begin(), limits_.end(), [this](const Limit& limit) {
    return (particles_.x.at(limit.b) - particles_.x.at(limit.a)).squaredNorm() > limit.square;
  });
}

}  // namespace cloth_sim
