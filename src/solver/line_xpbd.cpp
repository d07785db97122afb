#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cloth_sim/validation.h"
#include "constraints/line_projection.h"
#include "error_control.h"
#include "linalg/vector_operations.h"
#include "methods.h"
#include "position_based.h"
#include "sim/archive.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

/// Inertia that is added where the forces of different families of lines cancel each other.
///
/// A substep projects one family of lines after the other. In equilibrium the forces F_f of the
/// families on a particle add up to next to nothing, but each moves it by h^2 F_f / m before the
/// next one moves it back. Where that is no small part of a cell, as beside a pin that bears half
/// of the cloth, the lines find each other out of place, and the cloth is too soft there. So a
/// particle gets the inertia for which the cancelled part of these displacements is `kTolerance` of
/// its shortest spring. Gravity and other loads act as before, so equilibria stay where they are;
/// what changes is how fast these few particles accelerate (selective mass scaling, Olovsson,
/// Simonsson & Unosson 2005).
class AddedInertia {
 public:
  /// Cancelled displacement over rest length [-].
  static constexpr double kTolerance = 0.02;
  /// Most inertia, in masses of the particle.
  static constexpr double kMost = 100.0;
  /// Most force of added inertia, over the force of a family of lines that others cancel [-].
  static constexpr double kDrag = 0.02;
  /// Substeps that are longer do not tell motion from the oscillations that families of lines
  /// excite in each other; that limit would keep those alive [s].
  static constexpr double kCoarse = 1.0 / 900.0;
  /// Acceleration that counts as none [m/s^2].
  static constexpr double kStill = 1e-3;
  /// Time in which added inertia fades by a factor of e when it is no longer needed [s].
  static constexpr double kMemory = 0.0275;
  /// As `kTolerance` and `kMost`, while motion is declared to be quasi-static.
  static constexpr double kQuasiStaticTolerance = 0.002;
  static constexpr double kQuasiStaticMost = 1e4;
  /// Time over which inertia is averaged then [s].
  static constexpr double kQuasiStaticMemory = 0.02;

  /// Follows the model: which particles there are, and their shortest springs.
  void layOut(const Substep& now) {
    const std::size_t n = now.particles.mass.size();
    inertia_.resize(n, 0.0);
    velocity_.resize(n, Vec3::Zero());
    acceleration_.resize(n, Vec3::Zero());
    heavier_.reserve(n);
    shortest_.assign(n, std::numeric_limits<double>::infinity());
    for (const Spring spring : now.model.springs.slots()) {
      if (!spring.exists() || spring.kind == SpringKind::kBend) continue;
      for (const VertexId v : {spring.a, spring.b}) {
        double& shortest = shortest_[now.particles.slotOf[v]];
        shortest = std::min(shortest, spring.restLength);
      }
    }
  }
  /// Finds the inertia of each particle; 0 if it is held.
  void find(const Particles& p) {
    inverse_ = p.inverseMass;
    whole_ = p.mass;
    heavier_.clear();
    for (std::size_t k = 0; k < inverse_.size(); ++k) {
      if (inverse_[k] == 0.0 || inertia_[k] <= p.mass[k]) continue;
      whole_[k] = inertia_[k];
      inverse_[k] = 1.0 / inertia_[k];
      heavier_.push_back(static_cast<std::int32_t>(k));
    }
  }
  /// Updates the inertia that is needed, as far as it does not resist motion.
  /// \param h          length of the substep [s].
  /// \param duration   since the last update [s].
  /// \param cancelled  displacement of each particle by lines in vain [m], by particle slot.
  void update(double h, double duration, const Particles& p, const ScalarArray& cancelled) {
    const double fade = std::exp(-duration / kMemory);
    forParts(inverse_.size(), [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first; k < first + count; ++k) {
        const double acceleration =
            followMotion(k, (p.x.at(k) - p.start.at(k)) / h, duration, fade);
        if (inverse_[k] == 0.0) continue;
        const double force = cancelled[k] / (h * h * inverse_[k]);
        const double needed = std::min(neededAt(k, cancelled[k], kTolerance), kMost * p.mass[k]);
        const double most = h > kCoarse
                                ? kMost * p.mass[k]
                                : p.mass[k] + kDrag * force / std::max(acceleration, kStill);
        inertia_[k] = std::min(std::max(needed, fade * inertia_[k]), most);
      }
    });
  }
  /// The same, while motion is quasi-static: inertia hardly resists it.
  void updateQuasiStatic(double duration, const Particles& p, const ScalarArray& cancelled) {
    const double rate = 1.0 - std::exp(-duration / kQuasiStaticMemory);
    forParts(inverse_.size(), [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first; k < first + count; ++k) {
        if (inverse_[k] == 0.0) continue;
        const double needed = std::min(neededAt(k, cancelled[k], kQuasiStaticTolerance),
                                       kQuasiStaticMost * p.mass[k]);
        const double before = std::max(inertia_[k], p.mass[k]);
        inertia_[k] = before + rate * (needed - before);
      }
    });
  }
  /// Returns what is added to all particles, over their mass [-].
  double addedFraction(const Particles& p) const {
    double mass = 0.0;
    double added = 0.0;
    for (std::size_t k = 0; k < inertia_.size(); ++k) {
      mass += p.mass[k];
      added += std::max(0.0, inertia_[k] - p.mass[k]);
    }
    return mass > 0.0 ? added / mass : 0.0;
  }
  /// The largest displacement in vain of a free particle over its shortest spring [-].
  double largestFraction(const ScalarArray& cancelled) const {
    double largest = 0.0;
    for (std::size_t k = 0; k < inverse_.size(); ++k) {
      if (inverse_[k] > 0.0) largest = std::max(largest, cancelled[k] / shortest_[k]);
    }
    return largest;
  }
  /// [1/kg], by particle slot; 0: held.
  const ScalarArray& inverse() const { return inverse_; }
  /// The inertia of all particles, those without added inertia too [kg], by slot; 0: held.
  const ScalarArray& whole() const { return whole_; }
  /// Tells whether there is a value for each slot, or for fewer: those of new particles follow.
  bool fits(std::size_t slots) const {
    return inertia_.size() <= slots && velocity_.size() == inertia_.size() &&
           acceleration_.size() == inertia_.size() &&
           std::all_of(inertia_.begin(), inertia_.end(), isNotNegative);
  }
  /// Slots of the particles with added inertia.
  const std::vector<std::int32_t>& heavier() const { return heavier_; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(inertia_, velocity_, acceleration_);
  }

 private:
  /// Inertia with which the displacement in vain would be a fraction `tolerance` of the shortest
  /// spring [kg].
  double neededAt(std::size_t k, double cancelled, double tolerance) const {
    return cancelled / (tolerance * shortest_[k] * inverse_[k]);
  }
  /// Averages the acceleration of a particle over about `kMemory`. \return its length [m/s^2].
  double followMotion(std::size_t k, const Vec3& velocity, double duration, double fade) {
    const Vec3 now = (velocity - velocity_[k]) / duration;
    velocity_[k] = velocity;
    acceleration_[k] += (1.0 - fade) * (now - acceleration_[k]);
    return acceleration_[k].norm();
  }

  std::vector<double> inertia_;     ///< by particle slot [kg]; below the mass: nothing is added
  std::vector<Vec3> velocity_;      ///< by particle slot, at the last update [m/s]
  std::vector<Vec3> acceleration_;  ///< by particle slot, averaged [m/s^2]
  std::vector<double> shortest_;    ///< by particle slot: rest length [m]
  ScalarArray inverse_;
  ScalarArray whole_;
  std::vector<std::int32_t> heavier_;
};

/// Extended position-based dynamics with small steps in which whole lines of springs are projected
/// at once, by a direct solve (constraints/line_projection.h): along the threads, across the cells,
/// and along bend springs. Tension reaches from one end of a line to the other within a substep.
///
/// A sweep over single springs is softer than the fabric by T h^2 (w_a + w_b) in a spring of
/// tension T; here that remains only of what lines of different directions bear together, and
/// `AddedInertia` bounds it.
class LineXpbd final : public SubstepMethod {
 public:
  explicit LineXpbd(const ErrorGoal& goal) : control_(goal) {}

  void begin(Substep& now) override;
  void advance(Substep& now) override;
  void finish(Substep& now) override;
  int substepsOfStep(double dt, int substeps) const override {
    return control_.substepsFor(dt, substeps);
  }
  const ErrorEstimate* error() const override { return &control_.estimate(); }
  void save(StateWriter& archive) const override { archive(inertia_, control_, sinceBending_); }
  void load(StateReader& archive, const Particles& particles) override;

 private:
  /// Substeps from one measurement of the added inertia to the next, from the first one of a step;
  /// while motion is quasi-static it is measured in every substep.
  static constexpr int kMeasureEvery = 4;

  void layOut(Substep& now);
  void keepFall(Substep& now) const;
  void bend(Substep& now);
  void projectLines(Substep& now);
  void projectContacts(Substep& now);
  void updateInertia(const Substep& now);
  void passOnPull(Substep& now);

  SpringLines lines_;
  LineProjection projection_;
  AddedInertia inertia_;
  ErrorControl control_;
  PlateProjection bending_;
  double preparedFor_ = 0.0;       ///< length of the substep that lines are prepared for [s]
  double decay_ = 1.0;             ///< factor by which drag reduces a velocity in a substep
  int substep_ = 0;                ///< of the step
  std::int32_t sinceBending_ = 0;  ///< substeps since bending has acted
  bool bends_ = false;             ///< whether it acts in this one
  VectorArray pull_;
  ScalarArray cancelled_;
};

void LineXpbd::load(StateReader& archive, const Particles& particles) {
  archive(inertia_, control_, sinceBending_);
  const auto slots = static_cast<std::size_t>(particles.slots);
  if (!inertia_.fits(slots)) throw std::invalid_argument("inertia is added to no particle");
  if (!control_.isPlausible()) throw std::invalid_argument("the control of errors is in no state");
  constexpr std::int32_t kMost = 1 << 30;  // it counts on
  if (sinceBending_ < 0 || sinceBending_ > kMost) {
    throw std::invalid_argument("bending has not acted for no time");
  }
}

void LineXpbd::begin(Substep& now) {
  if (now.isNewModel) layOut(now);
  if (now.isNewLayout || preparedFor_ != now.h) {
    projection_.setStep(now.h);
    bending_.setStep(now, projection_.bendInterval());
    preparedFor_ = now.h;
  }
  decay_ = std::exp(-now.controls.drag * now.h);
  beginPrediction(now);
  control_.begin(now.particles);
  substep_ = 0;
}

void LineXpbd::finish(Substep& now) {
  findVelocities(now);
  now.addedMass = inertia_.addedFraction(now.particles);
  control_.end(now.particles, now.h, substep_ * now.h, now.fraction == 1.0);
}

void LineXpbd::layOut(Substep& now) {
  lines_.build(now.model, now.particles.slotOf);
  projection_.prepare(lines_, now.model.springs, now.particles.slotOf);
  bending_.build(now);
  inertia_.layOut(now);
  control_.layOut(now.model);
  const std::size_t n = now.particles.mass.size();
  setZero(n, pull_);
  cancelled_.assign(n, 0.0);
}

void LineXpbd::advance(Substep& now) {
  if (now.controls.quasiStatic || substep_ == 0 || substep_ % kMeasureEvery == 1) {
    inertia_.find(now.particles);
  }
  predictPositions(now, decay_, inertia_.inverse());
  keepFall(now);
  now.placeKinematic();
  bend(now);
  projectLines(now);
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

/// Decides whether bending acts in this substep, and projects the elements of a plate if it does.
void LineXpbd::bend(Substep& now) {
  const int interval = bending_.empty() ? projection_.bendInterval() : bending_.step.interval;
  bends_ = ++sinceBending_ >= interval;
  if (bends_) sinceBending_ = 0;
  if (bends_ && !bending_.empty()) projectBending(bending_, inertia_.inverse(), now);
}

void LineXpbd::projectLines(Substep& now) {
  Particles& p = now.particles;
  const bool measures = now.controls.quasiStatic || substep_ % kMeasureEvery == 0;
  ++substep_;
  if (!measures) {
    return projection_.project(lines_, inertia_.inverse(), bends_, p, pull_);
  }
  projection_.projectAndMeasure(lines_, inertia_.inverse(), bends_, p, pull_, cancelled_);
  control_.addCancelled(inertia_.largestFraction(cancelled_));
  updateInertia(now);
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
    inertia_.updateQuasiStatic(now.h, now.particles, cancelled_);
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
