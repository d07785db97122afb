#include <cmath>

#include "constraints/reference_projection.h"
#include "methods.h"
#include "plate_projection.h"
#include "position_based.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

/// Extended position-based dynamics with small steps: in each substep positions are predicted,
/// springs are projected colour by colour with their compliance, contacts are enforced, and the
/// displacement is the velocity.
///
/// Macklin, Mueller & Chentanez 2016 (eq. 18, and 26 for damping); small steps with one iteration:
/// Macklin et al. 2019. Unconditionally stable; too few substeps make stiff cloth stretch more than
/// its fabric says, and damp its motion.
class Xpbd final : public SubstepMethod {
 public:
  void begin(Substep& now) override;
  void advance(Substep& now) override;
  void finish(Substep& now) override { findVelocities(now); }

 private:
  /// A spring between a free and a held (kinematic) particle. The sweep projects it as if the held
  /// particle could move; it is projected again once that is back in its place, so that its impulse
  /// on the holder is known.
  struct Attachment {
    std::size_t free = 0;       ///< particle slot
    std::size_t held = 0;       ///< particle slot
    std::int32_t target = 0;    ///< index of the kinematic target
    double restLength = 0.0;    ///< [m]
    ProjectionWeights weights;  ///< a: of the free particle
  };

  void prepareSprings(Substep& now);
  void listAttachments(const Substep& now);
  void projectAttachments(Substep& now) const;

  double decay_ = 1.0;        ///< factor by which drag reduces a velocity in a substep
  double preparedFor_ = 0.0;  ///< length of the substep that springs are prepared for [s]
  std::vector<Attachment> attachments_;
  PlateProjection bending_;
};

void Xpbd::begin(Substep& now) {
  if (now.isNewModel) bending_.build(now);
  if (now.isNewLayout || preparedFor_ != now.h) prepareSprings(now);
  decay_ = std::exp(-now.controls.drag * now.h);
  beginPrediction(now);
}

/// In the sweep a held particle counts as weightless: it takes the whole correction, until it is
/// put back. So springs to it move nothing else.
void Xpbd::prepareSprings(Substep& now) {
  constexpr double kWeightless = 1e200;  // [1/kg]
  ScalarArray& w = now.particles.inverseMass;
  for (const std::int32_t held : now.kinematic.slots()) w[held] = kWeightless;
  now.springs.prepareProjection(w, now.h, now.isNewLayout);
  for (const std::int32_t held : now.kinematic.slots()) w[held] = 0.0;
  preparedFor_ = now.h;
  listAttachments(now);
  bending_.setStep(now, 0.0);
}

void Xpbd::listAttachments(const Substep& now) {
  attachments_.clear();
  if (now.kinematic.empty()) return;
  now.springs.forEach([&](const SpringConstraints::Element& spring) {
    const bool isHeldA = now.kinematic.targetOf(spring.a) != kNone;
    const bool isHeldB = now.kinematic.targetOf(spring.b) != kNone;
    if (isHeldA == isHeldB) return;
    const std::int32_t held = isHeldA ? spring.a : spring.b;
    const auto free = static_cast<std::size_t>(isHeldA ? spring.b : spring.a);
    attachments_.push_back(
        {free, static_cast<std::size_t>(held), now.kinematic.targetOf(held),
         spring.parameters.restLength,
         projectionWeights(spring.parameters, now.particles.inverseMass[free], 0.0, now.h)});
  });
}

void Xpbd::advance(Substep& now) {
  predictPositions(now, decay_, now.particles.inverseMass);
  now.placeKinematic();
  now.springs.project(now.particles);
  now.placeKinematic();
  projectAttachments(now);
  if (!bending_.empty()) bending_.project(now.particles.inverseMass, now);
  now.contacts.project(now.particles.view(), now.time, now.h);
  if (now.controls.hasLoads()) findVelocities(now);  // they depend on velocities
}

void Xpbd::projectAttachments(Substep& now) const {
  Particles& p = now.particles;
  for (const Attachment& at : attachments_) {
    const Vec3 error = projectSpring<true>(at.free, at.held, at.restLength, at.weights, p);
    // Mass times displacement over h: the momentum that the free particle gets.
    const Vec3 impulse = at.weights.a / (p.inverseMass[at.free] * now.h) * error;
    now.kinematic.addImpulse(at.target, -impulse);
  }
}

}  // namespace

SolverInfo xpbdInfo() {
  SolverInfo info;
  info.name = "xpbd";
  info.title = "Extended position-based dynamics with small steps";
  info.reference = "Macklin, Mueller & Chentanez 2016; Macklin et al., Small Steps, 2019";
  info.limitations =
      "too few substeps make stiff cloth stretch more than its fabric says and damp its motion";
  info.order = 1;
  info.hasBendFriction = true;
  info.projectsSpringsAlone = true;
  info.noTearEnergy = "at a tip springs are longer than their tension makes them";
  info.parameters = {substepsParameter(20)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<SubstepSolver>(model, substepsOf(p), std::make_unique<Xpbd>());
  };
  return info;
}

}  // namespace cloth_sim
