#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "constraints/spring_forces.h"
#include "support/vector_clones.h"
#include "contact_warm_start.h"
#include "linalg/bend_matrix.h"
#include "linalg/updatable_factor.h"
#include "linalg/vector_operations.h"
#include "methods.h"
#include "sim/archive.h"
#include "substep_solver.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// On the diagonal for a particle that is held, relative to the largest entry there; letting it go
/// costs six digits out of sixteen.
constexpr double kHold = 1e6;

/// Particles that a thread takes at once.
constexpr std::size_t kPart = 4096;

/// What the residual of one coordinate is made of.
struct Terms {
  const double* mass;         ///< [kg]
  const double* inverseMass;  ///< 0: prescribed motion
  const double* velocity;     ///< at the start of the substep [m/s]
  const double* force;        ///< [N]
  const double* start;        ///< [m]
  const double* x;            ///< [m]
};

/// h^2 times the force that is out of balance, m (h v + h^2 g) + h^2 f - m (1 + drag h) (x -
/// start), of free particles; the sum of its squares over the masses, in an order of its own.
CLOTH_SIM_VECTOR_CLONES
double residualAxis(std::size_t n, double h, double g, double drag, const Terms& terms,
                    double* residual) {
  constexpr std::size_t kLanes = 8;
  const Terms t = terms;
  const double inertia = 1.0 + h * drag;
  const auto at = [&](std::size_t k) {
    const double aim = h * t.velocity[k] + h * h * g - inertia * (t.x[k] - t.start[k]);
    const double r = t.inverseMass[k] > 0.0 ? t.mass[k] * aim + h * h * t.force[k] : 0.0;
    residual[k] = r;
    return r * r * t.inverseMass[k];
  };
  std::array<double, kLanes> part{};
  std::size_t k = 0;
  for (; k + kLanes <= n; k += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) part[lane] += at(k + lane);
  }
  double sum = 0.0;
  for (; k < n; ++k) sum += at(k);
  for (double value : part) sum += value;
  return sum;
}

/// Projective dynamics for springs (Liu, Bargteil, O'Brien & Kavan 2013): backward Euler,
/// alternating between the direction of each spring (local) and the positions given the directions
/// (global). The matrix of the global step, M (1 + drag h) / h^2 + sum of (k + c/h) S^T S, does not
/// depend on the state and is factorised once. A dashpot is a projection too: of the relative
/// motion in the substep on its part across the spring. A bending energy is quadratic already: its
/// matrix is part of the global step's.
///
/// After cuts and tears, and when clamps take or leave particles, the factorisation is updated
/// (UpdatableFactor); only when that would cost more is it made anew.
class Projective final : public SubstepSolver {
 public:
  Projective(const Model& model, const SolverParameters& parameters)
      : SubstepSolver(model, static_cast<int>(parameters.at("substeps"))),
        iterations_(static_cast<int>(parameters.at("iterations"))),
        tolerance_(parameters.at("tolerance")) {}

 private:
  void loadBending(const Model& model) override { bending_.build(model, particles_); }

  void prepare(const Controls& controls, double h) override {
    if (h == step_ && controls.drag == drag_ && !layoutChanged_) return;
    const bool scaled = h != step_ || controls.drag != drag_;
    step_ = h;
    drag_ = controls.drag;
    freeMass_ = std::accumulate(particles_.mass.begin(), particles_.mass.end(), 0.0);
    listHeldSprings();
    if (scaled || !isSolvable_ || factor_.rows() == 0) return factorise();
    const UpdatableFactor::Matrix matrix = globalMatrix();
    isSolvable_ = factor_.tryUpdate(matrix) || factor_.compute(matrix);
  }

  void substep(const Substep& now) override {
    if (now.before == 0.0) obstacles_.begin(now.contacts, particles_, now.time - now.h, now.h);
    markStart();
    copy(particles_.v, velocity_);
    findWind(now);
    setSum(particles_.start, now.h, particles_.v, particles_.x);
    placeKinematic(now.fraction);
    int k = 0;
    double residual = 0.0;
    for (; k < iterations_; ++k) {
      residual = findResidual(now);
      if (residual <= tolerance_) break;
      moveBySolution();
      placeKinematic(now.fraction);
    }
    noteIterations(k, residual);
    findVelocity(now.h);
    bearForces(now);
    obstacles_.enforce(now.time, now.h, now.contacts, particles_);
  }

  void findWind(const Substep& now) {
    if (!now.controls.hasLoads()) return;
    setZero(particles_.mass.size(), force_);
    addLoads(now.model, now.controls);
    wind_ = force_;
  }

  /// v = (x - start) / h.
  void findVelocity(double h) {
    setDifference(particles_.x, particles_.start, 1.0 / h, particles_.v);
  }

  /// h^2 times the forces that are out of balance, in `residual_`; as a mean acceleration [m/s^2].
  double findResidual(const Substep& now) {
    if (now.controls.hasLoads()) {
      copy(wind_, force_);
    } else {
      setZero(particles_.mass.size(), force_);
    }
    obstacles_.addForces(particles_.mass, force_);
    // Dashpots: of the motion in the substep.
    if (schedule_.parameters.damped() || bending_.retardation() > 0.0) findVelocity(now.h);
    addSpringForces(schedule_, particles_.x, particles_.v, force_);
    bending_.addForces(particles_.x, particles_.v, force_);
    const std::size_t n = particles_.mass.size();
    residual_.resize(n);
    squares_.assign((n + kPart - 1) / kPart, 0.0);
    parallelForEach(squares_.size(),
                    [&](std::size_t part) { squares_[part] = findResidualOf(part, now); });
    const double square = std::accumulate(squares_.begin(), squares_.end(), 0.0);
    return freeMass_ > 0.0 ? std::sqrt(square / freeMass_) / (now.h * now.h) : 0.0;
  }

  /// \return the sum of the squares over the masses.
  double findResidualOf(std::size_t part, const Substep& now) {
    const std::size_t begin = part * kPart;
    const std::size_t count = std::min(kPart, residual_.x.size() - begin);
    const double* const m = particles_.mass.data() + begin;
    const double* const w = particles_.inverseMass.data() + begin;
    double square = 0.0;
    int axis = 0;
    forAxes(
        [&](const auto& v, const auto& f, const auto& start, const auto& x, auto& r) {
          square += residualAxis(
              count, now.h, now.controls.gravity[axis++], now.controls.drag,
              {m, w, v.data() + begin, f.data() + begin, start.data() + begin, x.data() + begin},
              r.data() + begin);
        },
        velocity_, force_, particles_.start, particles_.x, residual_);
    return square;
  }

  /// x += A^-1 residual. Where nothing is held, the motion of the whole is kept out of the
  /// solution, which is in single precision: so linear momentum is right to round-off.
  void moveBySolution() {
    const bool isFree = kinematicSlots_.empty();
    const ScalarArray& mass = particles_.mass;
    const double inertia = freeMass_ * (1.0 + step_ * drag_);
    std::array<double, 3> mean{};
    int axis = 0;
    if (isFree) {
      forAxes(
          [&](auto& r) {
            const double whole = std::accumulate(r.begin(), r.end(), 0.0) / freeMass_;
            for (std::size_t k = 0; k < r.size(); ++k) r[k] -= mass[k] * whole;
            mean[axis++] = whole * freeMass_ / inertia;
          },
          residual_);
    }
    if (!isSolvable_) return setNaN(particles_.x);
    factor_.solve(residual_, change_);
    if (isFree) {
      axis = 0;
      forAxes(
          [&](auto& d) {
            const double wrong = std::inner_product(d.begin(), d.end(), mass.begin(), 0.0);
            for (double& value : d) value += mean[axis] - wrong / freeMass_;
            ++axis;
          },
          change_);
    }
    addScaled(1.0, change_, particles_.x);
  }

  /// The step is then refused.
  static void setNaN(VectorArray& q) {
    forAxes(
        [](auto& axis) {
          std::fill(axis.begin(), axis.end(), std::numeric_limits<double>::quiet_NaN());
        },
        q);
  }

  /// What kinematic targets bear: the forces on them where the substep ends.
  void bearForces(const Substep& now) {
    if (kinematicSlots_.empty()) return;
    for (const std::int32_t k : kinematicSlots_) {
      const auto slot = static_cast<std::size_t>(k);
      force_.set(slot, now.controls.hasLoads() ? wind_.at(slot) : Vec3::Zero());
    }
    for (const SpringSchedule::Element& spring : heldSprings_) {
      addSpringForce(spring, particles_.x, particles_.v, force_);
    }
    for (const std::int32_t k : kinematicSlots_) {
      bending_.addForce(static_cast<std::size_t>(k), particles_.x, particles_.v, force_);
    }
    addForcesToReactions(now.h);
  }

  void listHeldSprings() {
    const auto isHeld = [this](std::int32_t slot) {
      return targetOf()[static_cast<std::size_t>(slot)] != kNone;
    };
    heldSprings_.clear();
    schedule_.forEach([&](const SpringSchedule::Element& spring) {
      if (isHeld(spring.a) || isHeld(spring.b)) heldSprings_.push_back(spring);
    });
  }

  /// What the matrix of the bending energy counts in the global step's.
  double bendWeight() const { return step_ * (step_ + bending_.retardation()); }

  void factorise() {
    double largest = 0.0;
    for (double m : particles_.mass) largest = std::max(largest, m);
    schedule_.forEach([&](const SpringSchedule::Element& spring) {
      largest = std::max(largest, weight(spring.parameters));
    });
    holdWeight_ = kHold * (largest > 0.0 ? largest : 1.0);
    isSolvable_ = factor_.compute(globalMatrix());
  }

  /// What a spring counts in the global step's matrix [kg].
  double weight(const SpringParameters& parameters) const {
    return step_ * step_ * parameters.stiffness + step_ * parameters.damping;
  }

  /// The matrix of the global step; a particle that is held is tied to its place.
  UpdatableFactor::Matrix globalMatrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    const std::size_t n = particles_.mass.size();
    entries.reserve(n + 3 * static_cast<std::size_t>(schedule_.size()));
    for (std::size_t k = 0; k < n; ++k) {
      const double m = particles_.mass[k] * (1.0 + step_ * drag_);
      entries.emplace_back(k, k, m > 0.0 ? m : holdWeight_);
    }
    schedule_.forEach([&](const SpringSchedule::Element& spring) {
      const double w = weight(spring.parameters);
      if (w == 0.0) return;
      entries.emplace_back(spring.a, spring.a, w);
      entries.emplace_back(spring.b, spring.b, w);
      entries.emplace_back(std::max(spring.a, spring.b), std::min(spring.a, spring.b), -w);
    });
    bending_.forLower([&](std::size_t row, std::int32_t column, double value) {
      entries.emplace_back(row, column, bendWeight() * value);
    });
    UpdatableFactor::Matrix matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  void saveMemory(StateWriter& archive) const override {
    archive(step_, drag_, holdWeight_, factor_, obstacles_);
  }
  void loadMemory(StateReader& archive) override {
    archive(step_, drag_, holdWeight_, factor_, obstacles_);
  }

  BendMatrix bending_;
  int iterations_;
  double tolerance_;  ///< of the residual [m/s^2]
  double step_ = 0.0;
  double drag_ = 0.0;
  double holdWeight_ = 0.0;  ///< on the diagonal, for particles that are held [kg]
  double freeMass_ = 0.0;    ///< of particles that are not held [kg]
  UpdatableFactor factor_;
  bool isSolvable_ = true;  ///< the matrix was positive definite in spite of rounding
  std::vector<SpringSchedule::Element> heldSprings_;  ///< at kinematic particles
  VectorArray velocity_;                              ///< at the start of the substep [m/s]
  ContactWarmStart obstacles_;
  VectorArray wind_, residual_, change_;
  std::vector<double> squares_;  ///< of the residual, by part
};

}  // namespace

SolverInfo projectiveInfo() {
  SolverInfo info;
  info.name = "projective";
  info.title = "Projective dynamics (fast mass-spring)";
  info.reference = "Liu, Bargteil, O'Brien & Kavan, Fast Simulation of Mass-Spring Systems, 2013";
  info.limitations =
      "backward Euler's damping; converges slowly where stiff cloth turns in a substep; "
      "single edges strain near obstacles at long substeps";
  info.order = 1;
  SolverParameter iterations = substepsParameter(10);
  iterations.name = "iterations";
  iterations.description = "local and global steps in a substep, at most";
  SolverParameter tolerance;
  tolerance.name = "tolerance";
  tolerance.defaultValue = 1e-2;
  tolerance.maximum = 10.0;
  tolerance.unit = "m/s^2";
  tolerance.description = "residual, as a mean acceleration, at which a substep counts as solved";
  info.parameters = {substepsParameter(4), iterations, tolerance};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<Projective>(model, p);
  };
  return info;
}

}  // namespace cloth_sim
