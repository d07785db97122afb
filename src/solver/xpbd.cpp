#include <cmath>

#include "bend_sweep.h"
#include "cloth_sim/solver/packed_solver.h"
#include "cloth_sim/solver/vector_clones.h"
#include "methods.h"
#include "packed_ops.h"

namespace cloth_sim {
namespace {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;

/// Per spring, by position in the schedule. A correction along the spring by
/// gain * (C + lag * dC), where dC is what C has changed by in this substep, is the damped XPBD
/// update of Macklin et al. 2016, eqs. 18 and 26, with one iteration.
struct Gains {
  std::vector<double> gain;  ///< 1 / ((1 + lag) (w_a + w_b) + 1 / (k h^2)) [kg]
  std::vector<double> lag;   ///< c / (k h) [-]
};

struct Ends {
  double* x;
  double* y;
  double* z;
  const double* sx;
  const double* sy;
  const double* sz;
  const double* w;
};

Ends endsAt(PackedParticles& p, std::int32_t slot) {
  return {p.x.x.data() + slot,        p.x.y.data() + slot,     p.x.z.data() + slot,
          p.start.x.data() + slot,    p.start.y.data() + slot, p.start.z.data() + slot,
          p.inverseMass.data() + slot};
}

CLOTH_SIM_VECTOR_CLONES
void sweepRun(std::int32_t count, Ends a, Ends b, const double* rest, const double* gain) {
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const double dx = b.x[k] - a.x[k];
    const double dy = b.y[k] - a.y[k];
    const double dz = b.z[k] - a.z[k];
    const double length = std::sqrt(dx * dx + dy * dy + dz * dz + kTinySquare);
    const double f = gain[k] - gain[k] * rest[k] / length;
    const double fa = f * a.w[k];
    const double fb = f * b.w[k];
    a.x[k] += fa * dx;
    a.y[k] += fa * dy;
    a.z[k] += fa * dz;
    b.x[k] -= fb * dx;
    b.y[k] -= fb * dy;
    b.z[k] -= fb * dz;
  }
}

CLOTH_SIM_VECTOR_CLONES
void sweepDampedRun(std::int32_t count, Ends a, Ends b, const double* rest, const double* gain,
                    const double* lag) {
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const double dx = b.x[k] - a.x[k];
    const double dy = b.y[k] - a.y[k];
    const double dz = b.z[k] - a.z[k];
    const double squared = dx * dx + dy * dy + dz * dz + kTinySquare;
    const double length = std::sqrt(squared);
    const double moved =
        squared - dx * (b.sx[k] - a.sx[k]) - dy * (b.sy[k] - a.sy[k]) - dz * (b.sz[k] - a.sz[k]);
    const double inverse = 1.0 / length;
    const double f = gain[k] * (length - rest[k] + lag[k] * (moved * inverse)) * inverse;
    const double fa = f * a.w[k];
    const double fb = f * b.w[k];
    a.x[k] += fa * dx;
    a.y[k] += fa * dy;
    a.z[k] += fa * dz;
    b.x[k] -= fb * dx;
    b.y[k] -= fb * dy;
    b.z[k] -= fb * dz;
  }
}

/// d = decay d + h^2 g (statics are not touched by the drag) along one axis, start = x, x += d,
/// with d the displacement of the substep before: x - start.
CLOTH_SIM_VECTOR_CLONES
void predictAxis(std::size_t count, double decay, double fall, const double* w, double* x,
                 double* start) {
  for (std::size_t k = 0; k < count; ++k) {
    const double moved = decay * (x[k] - start[k]);
    start[k] = x[k];
    x[k] += moved + (w[k] > 0.0 ? fall : 0.0);
  }
}

CLOTH_SIM_VECTOR_CLONES
void differenceAxis(std::size_t count, double scale, const double* x, const double* start,
                    double* v) {
  for (std::size_t k = 0; k < count; ++k) v[k] = scale * (x[k] - start[k]);
}

/// Extended position-based dynamics with small steps: in each substep positions are predicted,
/// springs are projected colour by colour with their compliance, contacts are enforced, and the
/// displacement is the velocity.
///
/// Macklin, Mueller & Chentanez 2016 (eq. 18, and 26 for damping); small steps with one iteration:
/// Macklin et al. 2019. Unconditionally stable; too few substeps make stiff cloth stretch more than
/// its fabric says, and damp its motion.
class Xpbd final : public PackedSolver {
 public:
  Xpbd(const Model& model, int substeps) : PackedSolver(model, substeps) {}

 private:
  /// A spring between a free and a prescribed particle; solved after the others, one by one, so
  /// that its impulse on the holder is known.
  struct Attachment {
    std::int32_t position = kNone;  ///< in the schedule
    std::int32_t freeSlot = kNone;
    std::int32_t heldSlot = kNone;
    std::size_t held = 0;  ///< index of the kinematic target
    double gain = 0.0;
    double lag = 0.0;
  };

  void loadBending(const Model& model) override;
  void prepare(const Controls& controls, double h) override;
  void substep(const Substep& now) override;

  void computeGains(double h);
  void takeAttachments();
  void predict(const Substep& now);
  void applyLoads(const Substep& now);
  void sweep();
  void solveAttachments(double h);
  void solveBending(double h);

  double gainStep_ = 0.0;  ///< the h that gains_ are for
  Gains gains_;
  std::vector<Attachment> attachments_;
  BendSweep bending_;
  double retardation_ = 0.0;  ///< of bending [s]
};

void Xpbd::loadBending(const Model& model) {
  bending_.build(model.bending, particles_);
  retardation_ = model.bendRetardation();
}

void Xpbd::prepare(const Controls& /*controls*/, double h) {
  if (layoutChanged_ || gainStep_ != h) {
    computeGains(h);
    takeAttachments();
    if (!bending_.empty()) bending_.setStep(h, retardation_, particles_.inverseMass);
  }
  setSum(particles_.x, -h, particles_.v, particles_.start);
}

void Xpbd::computeGains(double h) {
  gainStep_ = h;
  const auto n = static_cast<std::size_t>(schedule_.size());
  gains_.gain.assign(n, 0.0);
  gains_.lag.assign(n, 0.0);
  for (std::size_t p = 0; p < n; ++p) {
    const double stiffness = schedule_.stiffness[p];
    if (stiffness <= 0.0) continue;
    const double w =
        particles_.inverseMass[schedule_.endA[p]] + particles_.inverseMass[schedule_.endB[p]];
    const double lag = schedule_.damping[p] / (stiffness * h);
    gains_.lag[p] = lag;
    gains_.gain[p] = 1.0 / ((1.0 + lag) * w + 1.0 / (stiffness * h * h));
  }
}

void Xpbd::takeAttachments() {
  attachments_.clear();
  if (kinematicSlots_.empty()) return;
  for (std::int32_t p = 0; p < schedule_.size(); ++p) {
    const std::int32_t a = schedule_.endA[p];
    const std::int32_t b = schedule_.endB[p];
    const bool heldA = targetOf()[a] != kNone;
    const bool heldB = targetOf()[b] != kNone;
    if (heldA == heldB) continue;
    const std::int32_t held = heldA ? a : b;
    attachments_.push_back({p, heldA ? b : a, held, static_cast<std::size_t>(targetOf()[held]),
                            gains_.gain[p], gains_.lag[p]});
    gains_.gain[p] = 0.0;
  }
}

void Xpbd::substep(const Substep& now) {
  predict(now);
  placeKinematic(now.fraction);
  sweep();
  solveAttachments(now.h);
  if (!bending_.empty()) solveBending(now.h);
  now.contacts.project(particles_.view(), now.time, now.h);
  if (now.fraction == 1.0 || now.controls.hasLoads()) {
    const auto n = static_cast<std::size_t>(particles_.slots);
    const double rate = 1.0 / now.h;
    const PackedVectors& x = particles_.x;
    const PackedVectors& start = particles_.start;
    differenceAxis(n, rate, x.x.data(), start.x.data(), particles_.v.x.data());
    differenceAxis(n, rate, x.y.data(), start.y.data(), particles_.v.y.data());
    differenceAxis(n, rate, x.z.data(), start.z.data(), particles_.v.z.data());
  }
}

void Xpbd::predict(const Substep& now) {
  const auto n = static_cast<std::size_t>(particles_.slots);
  const double decay = std::exp(-now.controls.drag * now.h);
  const Vec3 fall = now.h * now.h * now.controls.gravity;
  if (now.controls.hasLoads()) {
    for (std::vector<double>* axis : {&force_.x, &force_.y, &force_.z}) {
      axis->assign(axis->size(), 0.0);
    }
    addLoads(now.model, now.controls);
  }
  const double* w = particles_.inverseMass.data();
  predictAxis(n, decay, fall.x(), w, particles_.x.x.data(), particles_.start.x.data());
  predictAxis(n, decay, fall.y(), w, particles_.x.y.data(), particles_.start.y.data());
  predictAxis(n, decay, fall.z(), w, particles_.x.z.data(), particles_.start.z.data());
  if (now.controls.hasLoads()) applyLoads(now);
}

void Xpbd::applyLoads(const Substep& now) {
  for (std::size_t k = 0; k < particles_.inverseMass.size(); ++k) {
    const double scale = now.h * now.h * particles_.inverseMass[k];
    particles_.x.set(k, particles_.x.at(k) + scale * force_.at(k));
  }
  for (std::size_t k = 0; k < kinematicSlots_.size(); ++k) {
    addReaction(k, now.h * force_.at(static_cast<std::size_t>(kinematicSlots_[k])));
  }
}

void Xpbd::sweep() {
  const SpringSchedule& s = schedule_;
  const auto project = [&](std::int32_t first, std::int32_t count) {
    const Ends a = endsAt(particles_, s.endA[first]);
    const Ends b = endsAt(particles_, s.endB[first]);
    const double* rest = s.restLength.data() + first;
    const double* gain = gains_.gain.data() + first;
    if (s.damped) {
      sweepDampedRun(count, a, b, rest, gain, gains_.lag.data() + first);
    } else {
      sweepRun(count, a, b, rest, gain);
    }
  };
  s.sweep(project, [&](std::int32_t position) { project(position, 1); });
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
    // The multiplier of eq. 18: the impulse is this over h.
    const double pull = at.gain * (length - schedule_.restLength[at.position] + at.lag * moved);
    particles_.x.set(free, particles_.x.at(free) + particles_.inverseMass[free] * pull * direction);
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
