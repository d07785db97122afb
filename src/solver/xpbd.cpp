#include <cmath>

#include "constraints/bend_projection.h"
#include "constraints/spring_projection.h"
#include "support/vector_clones.h"
#include "linalg/vector_operations.h"
#include "methods.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

/// d = decay d + h^2 g (statics are not touched by the drag) along one axis, start = x, x += d,
/// with d the displacement of the substep before: x - start.
CLOTH_SIM_VECTOR_CLONES
void predictDraggedAxis(std::size_t count, double decay, double fall, const double* w, double* x,
                        double* start) {
  for (std::size_t k = 0; k < count; ++k) {
    const double moved = decay * (x[k] - start[k]);
    start[k] = x[k];
    x[k] += moved + (w[k] > 0.0 ? fall : 0.0);
  }
}

/// The same without drag.
CLOTH_SIM_VECTOR_CLONES
void predictAxis(std::size_t count, double fall, const double* w, double* x, double* start) {
  for (std::size_t k = 0; k < count; ++k) {
    const double moved = x[k] - start[k];
    start[k] = x[k];
    x[k] += moved + (w[k] > 0.0 ? fall : 0.0);
  }
}

/// Extended position-based dynamics with small steps: in each substep positions are predicted,
/// springs are projected colour by colour with their compliance, contacts are enforced, and the
/// displacement is the velocity.
///
/// Macklin, Mueller & Chentanez 2016 (eq. 18, and 26 for damping); small steps with one iteration:
/// Macklin et al. 2019. Unconditionally stable; too few substeps make stiff cloth stretch more than
/// its fabric says, and damp its motion.
class Xpbd final : public SubstepSolver {
 public:
  Xpbd(const Model& model, int substeps) : SubstepSolver(model, substeps) {}

 private:
  /// A spring between a free and a prescribed particle; solved after the others, one by one, so
  /// that its impulse on the holder is known.
  struct Attachment {
    std::int32_t freeSlot = kNone;
    std::int32_t heldSlot = kNone;
    std::size_t held = 0;  ///< index of the kinematic target
    double restLength = 0.0;
    Compliance compliance;
  };

  void loadBending(const Model& model) override;
  void prepare(const Controls& controls, double h) override;
  void substep(const Substep& now) override;
  void findVelocities(double h) override;

  void setMasses();
  void listAttachments();
  void sweep(const Prepare& prepare);
  template <typename Act>
  void asIfWeightless(const Act& act);
  void predict(const Substep& now, std::size_t first, std::size_t last);
  void predictWithLoads(const Substep& now);
  void solveAttachments(double h);
  void solveBending(double h);

  double decay_ = 1.0;           ///< what drag leaves of a velocity in a substep
  double complianceStep_ = 0.0;  ///< the h that springs give way for
  SpringProjection springs_;
  std::vector<Attachment> attachments_;
  BendSweep bending_;
  double retardation_ = 0.0;  ///< of bending [s]
};

void Xpbd::loadBending(const Model& model) {
  bending_.build(model.bending, particles_);
  retardation_ = model.bendRetardation();
}

void Xpbd::prepare(const Controls& controls, double h) {
  if (layoutChanged_ || complianceStep_ != h) {
    complianceStep_ = h;
    if (layoutChanged_) setMasses();
    springs_.setStep(schedule_, h);
    listAttachments();
    if (!bending_.empty()) bending_.setStep(h, retardation_, particles_.inverseMass);
  }
  decay_ = std::exp(-controls.drag * h);
  setSum(particles_.x, -h, particles_.v, particles_.start);
}

void Xpbd::setMasses() {
  asIfWeightless([&] { springs_.setMasses(schedule_, particles_.inverseMass); });
}

void Xpbd::listAttachments() {
  attachments_.clear();
  if (kinematicSlots_.empty()) return;
  schedule_.forEach([this](const SpringSchedule::Element& spring) {
    const bool heldA = targetOf()[spring.a] != kNone;
    const bool heldB = targetOf()[spring.b] != kNone;
    if (heldA == heldB) return;
    const std::int32_t held = heldA ? spring.a : spring.b;
    attachments_.push_back(
        {heldA ? spring.b : spring.a, held, static_cast<std::size_t>(targetOf()[held]),
         spring.parameters.restLength, complianceOf(spring.parameters, complianceStep_)});
  });
}

void Xpbd::substep(const Substep& now) {
  if (now.controls.hasLoads()) {
    predictWithLoads(now);
    sweep({});
  } else {
    sweep([&](std::size_t first, std::size_t last) { predict(now, first, last); });
  }
  placeKinematic(now.fraction);
  solveAttachments(now.h);
  if (!bending_.empty()) solveBending(now.h);
  now.contacts.project(particles_.view(), now.time, now.h);
  if (now.controls.hasLoads()) findVelocities(now.h);
}

void Xpbd::sweep(const Prepare& prepare) {
  asIfWeightless([&] { springs_.correct(schedule_, particles_, prepare); });
}

/// Springs between a free and a prescribed particle have their turn later: in the sweep the
/// prescribed one counts as weightless and takes the whole correction, until it is put back.
template <typename Act>
void Xpbd::asIfWeightless(const Act& act) {
  constexpr double kWeightless = 1e200;  // [1/kg]
  for (const std::int32_t held : kinematicSlots_) particles_.inverseMass[held] = kWeightless;
  act();
  for (const std::int32_t held : kinematicSlots_) particles_.inverseMass[held] = 0.0;
}

void Xpbd::findVelocities(double h) {
  setDifference(particles_.x, particles_.start, 1.0 / h, particles_.v);
}

void Xpbd::predict(const Substep& now, std::size_t first, std::size_t last) {
  const Vec3 fall = now.h * now.h * now.controls.gravity;
  const double* const w = particles_.inverseMass.data() + first;
  int axis = 0;
  forAxes(
      [&](auto& x, auto& start) {
        double* const to = x.data() + first;
        double* const from = start.data() + first;
        const double g = fall[axis++];
        if (decay_ != 1.0) {
          predictDraggedAxis(last - first, decay_, g, w, to, from);
        } else {
          predictAxis(last - first, g, w, to, from);
        }
      },
      particles_.x, particles_.start);
  placeKinematic(now.fraction, first, last);
}

/// Loads act on where particles were.
void Xpbd::predictWithLoads(const Substep& now) {
  setZero(particles_.mass.size(), force_);
  addLoads(now.model, now.controls);
  forParts(particles_.mass.size(),
           [&](std::size_t first, std::size_t count) { predict(now, first, first + count); });
  for (std::size_t k = 0; k < particles_.inverseMass.size(); ++k) {
    const double scale = now.h * now.h * particles_.inverseMass[k];
    particles_.x.set(k, particles_.x.at(k) + scale * force_.at(k));
  }
  for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
    addReaction(k, now.h * force_.at(static_cast<std::size_t>(kinematicSlots_[k])));
  }
}

void Xpbd::solveAttachments(double h) {
  for (const Attachment& at : attachments_) {
    const auto free = static_cast<std::size_t>(at.freeSlot);
    const auto held = static_cast<std::size_t>(at.heldSlot);
    const Vec3 d = particles_.x.at(held) - particles_.x.at(free);
    const double length = std::sqrt(d.squaredNorm() + kTinySquare);
    const Vec3 direction = d / length;
    const double moved =
        length - direction.dot(particles_.start.at(held) - particles_.start.at(free));
    const double w = particles_.inverseMass[free];
    const auto [alpha, lag] = at.compliance;
    // The multiplier of eq. 18: the impulse is this over h.
    const double pull = (length - at.restLength + lag * moved) / ((1.0 + lag) * w + alpha);
    particles_.x.set(free, particles_.x.at(free) + w * pull * direction);
    addReaction(at.held, -pull / h * direction);
  }
}

void Xpbd::solveBending(double h) {
  bending_.project(particles_,
                   [&](std::size_t slot, const Vec3& impulse) { bear(slot, impulse / h); });
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
  info.parameters = {substepsParameter(20)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<Xpbd>(model, static_cast<int>(p.at("substeps")));
  };
  return info;
}

}  // namespace cloth_sim
