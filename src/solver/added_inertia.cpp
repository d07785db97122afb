#include "added_inertia.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cloth_sim/validation.h"
#include "linalg/vector_operations.h"
#include "sim/archive.h"
#include "support/simd.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

std::vector<Vec3> entriesOf(const VectorArray& of) {
  std::vector<Vec3> entries(of.x.size());
  for (std::size_t k = 0; k < entries.size(); ++k) entries[k] = of.at(k);
  return entries;
}

void setEntries(const std::vector<Vec3>& entries, VectorArray& of) {
  of.resize(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) of.set(k, entries[k]);
}

}  // namespace

/// Loops over consecutive slots, without branches.
struct AddedInertia::Kernel {
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
  /// The values of `kTolerance` and `kMost` while motion is declared to be quasi-static.
  static constexpr double kQuasiStaticTolerance = 0.01;
  static constexpr double kLayersTolerance = 0.002;  ///< where layers may touch
  static constexpr double kQuasiStaticMost = 1e4;
  /// Time over which inertia is averaged then [s].
  static constexpr double kQuasiStaticMemory = 0.02;
  /// Least inertia of a particle over h^2 sum(T / l): h w is then the root of 2 over it.
  static constexpr double kTight = 2.0;

  /// Of an update; see `AddedInertia::update`.
  struct Update {
    double h;         ///< [s]
    double duration;  ///< [s]
    double fade;      ///< factor by which added inertia fades in it [-]
    double masses;    ///< inertia that is allowed whatever the motion, over the mass [-]
    double drag;      ///< see `kDrag` [-]
  };
  static Update updateOf(double h, double duration) {
    const bool isCoarse = h > kCoarse;
    return {h, duration, std::exp(-duration / kMemory), isCoarse ? kMost : 1.0,
            isCoarse ? 0.0 : kDrag};
  }
  /// Arrays of the particles, from the first slot on.
  struct Arrays {
    const double *mass, *inverse, *shortest, *cancelled, *least;
    double* inertia;
  };
  static Arrays arraysAt(AddedInertia& of, const Particles& p, const ScalarArray& cancelled,
                         std::size_t first) {
    return {p.mass.data() + first,    of.inverse_.data() + first, of.shortest_.data() + first,
            cancelled.data() + first, of.least_.data() + first,   of.inertia_.data() + first};
  }

  [[gnu::always_inline]] static double lesser(double a, double b) { return b < a ? b : a; }
  [[gnu::always_inline]] static double greater(double a, double b) { return a < b ? b : a; }
  /// Inertia with which the displacement in vain would be a fraction `tolerance` of the shortest
  /// spring, up to `most` masses [kg]; no number for held particles.
  [[gnu::always_inline]] static double neededAt(const Arrays& m, std::size_t k, double tolerance,
                                                double most) {
    return lesser(m.cancelled[k] / (tolerance * m.shortest[k] * m.inverse[k]), most * m.mass[k]);
  }

  /// \return number of particles with added inertia.
  CLOTH_SIM_VECTOR_CLONES
  static std::int64_t find(const double* added, const double* mass, const double* inverseMass,
                           std::size_t count, double* whole, double* inverse) {
    std::int64_t heavier = 0;
    CLOTH_SIM_NO_ALIAS_LOOP
    for (std::size_t k = 0; k < count; ++k) {
      const bool isHeavier = inverseMass[k] != 0.0 && added[k] > mass[k];
      whole[k] = isHeavier ? added[k] : mass[k];
      inverse[k] = isHeavier ? 1.0 / added[k] : inverseMass[k];
      heavier += isHeavier ? 1 : 0;
    }
    return heavier;
  }
  /// Follows one coordinate of the velocities, and averages accelerations over about `kMemory`.
  CLOTH_SIM_VECTOR_CLONES
  static void followMotion(const Update& update, const double* x, const double* start,
                           std::size_t count, double* velocity, double* acceleration) {
    const double h = update.h, duration = update.duration, rate = 1.0 - update.fade;
    CLOTH_SIM_NO_ALIAS_LOOP
    for (std::size_t k = 0; k < count; ++k) {
      const double now = (x[k] - start[k]) / h;
      acceleration[k] += rate * ((now - velocity[k]) / duration - acceleration[k]);
      velocity[k] = now;
    }
  }
  CLOTH_SIM_VECTOR_CLONES
  static void update(const Update& update, ConstAxes acceleration, Arrays m, std::size_t count) {
    const double square = update.h * update.h, fade = update.fade;
    const double masses = update.masses, drag = update.drag;
    CLOTH_SIM_NO_ALIAS_LOOP
    for (std::size_t k = 0; k < count; ++k) {
      const double ax = acceleration.x[k], ay = acceleration.y[k], az = acceleration.z[k];
      const double length = std::sqrt(ax * ax + ay * ay + az * az);
      const double force = m.cancelled[k] / (square * m.inverse[k]);
      const double most = masses * m.mass[k] + drag * force / greater(length, kStill);
      const double wanted = greater(neededAt(m, k, kTolerance, kMost), fade * m.inertia[k]);
      m.inertia[k] = m.inverse[k] == 0.0 ? m.inertia[k] : lesser(wanted, most);
    }
  }
  CLOTH_SIM_VECTOR_CLONES
  static void updateQuasiStatic(double rate, double tolerance, Arrays m, std::size_t count) {
    CLOTH_SIM_NO_ALIAS_LOOP
    for (std::size_t k = 0; k < count; ++k) {
      const double needed = greater(neededAt(m, k, tolerance, kQuasiStaticMost), m.least[k]);
      const double before = greater(m.inertia[k], m.mass[k]);
      const double after = before + rate * (needed - before);
      m.inertia[k] = m.inverse[k] == 0.0 ? m.inertia[k] : after;
    }
  }
  CLOTH_SIM_VECTOR_CLONES
  static double largestFraction(const double* cancelled, const double* shortest,
                                const double* inverse, std::size_t count) {
    const Lanes zero{};
    Lanes most = zero;
    std::size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      const Lanes fraction = lanesAt(cancelled + k) / lanesAt(shortest + k);
      const auto isMore = (lanesAt(inverse + k) > zero) & (fraction > most);
      most = isMore ? fraction : most;
    }
    double largest = std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
    for (; k < count; ++k) {
      if (inverse[k] > 0.0) largest = std::max(largest, cancelled[k] / shortest[k]);
    }
    return largest;
  }
};

void AddedInertia::layOut(const Model& model, const Particles& p) {
  const std::size_t n = p.mass.size();
  inertia_.resize(n, 0.0);
  velocity_.resize(n);
  acceleration_.resize(n);
  heavier_.reserve(n);
  least_.resize(n, 0.0);
  shortest_.assign(n, std::numeric_limits<double>::infinity());
  for (const Spring spring : model.springs.slots()) {
    if (!spring.exists() || spring.kind == SpringKind::kBend) continue;
    for (const VertexId v : {spring.a, spring.b}) {
      double& shortest = shortest_[p.slotOf[v]];
      shortest = std::min(shortest, spring.restLength);
    }
  }
}

void AddedInertia::setStep(double h) {
  if (h <= step_) return;
  const double before = std::exchange(step_, h);
  if (before == 0.0) return;
  const double growth = h * h / (before * before);
  for (double& inertia : inertia_) inertia *= growth;
}

void AddedInertia::followTension(const Model& model, const Particles& p, double h) {
  std::fill(least_.begin(), least_.end(), 0.0);
  for (const Spring spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    const auto a = static_cast<std::size_t>(p.slotOf[spring.a]);
    const auto b = static_cast<std::size_t>(p.slotOf[spring.b]);
    const double length = (p.x.at(b) - p.x.at(a)).norm();
    if (length <= spring.restLength) continue;
    const double tension = spring.stiffness * (length - spring.restLength);
    const double inertia = Kernel::kTight * h * h * tension / length;
    least_[a] += inertia;
    least_[b] += inertia;
  }
  for (std::size_t k = 0; k < least_.size(); ++k) inertia_[k] = std::max(inertia_[k], least_[k]);
}

void AddedInertia::find(const Particles& p) {
  const std::size_t n = p.mass.size();
  inverse_.resize(n);
  whole_.resize(n);
  heavier_.clear();
  const std::int64_t heavier = Kernel::find(inertia_.data(), p.mass.data(), p.inverseMass.data(), n,
                                            whole_.data(), inverse_.data());
  if (heavier == 0) return;
  for (std::size_t k = 0; k < n; ++k) {
    if (whole_[k] != p.mass[k]) heavier_.push_back(static_cast<std::int32_t>(k));
  }
}

void AddedInertia::update(double h, double duration, const Particles& p,
                          const ScalarArray& cancelled) {
  const Kernel::Update update = Kernel::updateOf(h, duration);
  step_ = std::max(h, std::sqrt(update.fade) * step_);  // inertia that is not needed fades so
  forParts(inverse_.size(), [&](std::size_t first, std::size_t count) {
    forAxes(
        [&](const auto& x, const auto& start, auto& velocity, auto& acceleration) {
          Kernel::followMotion(update, x.data() + first, start.data() + first, count,
                               velocity.data() + first, acceleration.data() + first);
        },
        p.x, p.start, velocity_, acceleration_);
    Kernel::update(update, axesAt(std::as_const(acceleration_), static_cast<std::int32_t>(first)),
                   Kernel::arraysAt(*this, p, cancelled, first), count);
  });
}

void AddedInertia::updateQuasiStatic(double h, bool hasLayers, const Particles& p,
                                     const ScalarArray& cancelled) {
  const double tolerance = hasLayers ? Kernel::kLayersTolerance : Kernel::kQuasiStaticTolerance;
  const double fade = std::exp(-h / Kernel::kQuasiStaticMemory), rate = 1.0 - fade;
  step_ = std::max(h, std::sqrt(fade) * step_);
  forParts(inverse_.size(), [&](std::size_t first, std::size_t count) {
    Kernel::updateQuasiStatic(rate, tolerance, Kernel::arraysAt(*this, p, cancelled, first), count);
  });
}

double AddedInertia::addedFraction(const Particles& p) const {
  double mass = 0.0;
  double added = 0.0;
  for (std::size_t k = 0; k < inertia_.size(); ++k) {
    mass += p.mass[k];
    added += std::max(0.0, inertia_[k] - p.mass[k]);
  }
  return mass > 0.0 ? added / mass : 0.0;
}

double AddedInertia::largestFraction(const ScalarArray& cancelled) const {
  return Kernel::largestFraction(cancelled.data(), shortest_.data(), inverse_.data(),
                                 inverse_.size());
}

bool AddedInertia::fits(std::size_t slots) const {
  const std::size_t n = inertia_.size();
  return n <= slots && velocity_.x.size() == n && acceleration_.x.size() == n && step_ >= 0.0 &&
         std::all_of(inertia_.begin(), inertia_.end(), isNotNegative);
}

void AddedInertia::save(StateWriter& archive) const {
  archive(step_, inertia_, entriesOf(velocity_), entriesOf(acceleration_));
}

void AddedInertia::load(StateReader& archive) {
  std::vector<Vec3> velocity, acceleration;
  archive(step_, inertia_, velocity, acceleration);
  setEntries(velocity, velocity_);
  setEntries(acceleration, acceleration_);
}

}  // namespace cloth_sim
