#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "constraints/contact_warm_start.h"
#include "linalg/bend_matrix.h"
#include "linalg/updatable_factor.h"
#include "linalg/vector_operations.h"
#include "methods.h"
#include "sim/archive.h"
#include "substep_solver.h"
#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// On the diagonal for a particle that is held, relative to the largest entry there; letting it go
/// costs six digits out of sixteen.
constexpr double kHold = 1e6;

/// Particles that a thread takes at once.
constexpr std::size_t kPart = 4096;

/// The terms of the residual along one axis, arrays by particle slot.
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

/// v = (x - start) / h.
void findVelocity(Substep& now) {
  Particles& p = now.particles;
  setDifference(p.x, p.start, 1.0 / now.h, p.v);
}

/// Makes the step fail: it is then refused.
void setNaN(VectorArray& q) {
  forAxes(
      [](auto& axis) {
        std::fill(axis.begin(), axis.end(), std::numeric_limits<double>::quiet_NaN());
      },
      q);
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
class Projective final : public SubstepMethod {
 public:
  explicit Projective(const SolverParameters& parameters)
      : iterations_(static_cast<int>(parameters.at("iterations"))),
        tolerance_(parameters.at("tolerance")) {}

  void begin(Substep& now) override;
  void advance(Substep& now) override;
  void save(StateWriter& archive) const override {
    archive(h_, drag_, holdWeight_, factor_, warmStart_);
  }
  void load(StateReader& archive, const Particles& particles) override;

 private:
  void prepareMatrix(const Substep& now);
  void factorise(const Substep& now);
  UpdatableFactor::Matrix globalMatrix(const Substep& now) const;
  void listHeldSprings(const Substep& now);

  void findLoads(Substep& now);
  double findResidual(Substep& now);
  double findResidualOf(std::size_t part, const Substep& now);
  void moveBySolution(Substep& now);
  double removeMeanMotion(const ScalarArray& mass, ScalarArray& residual) const;
  void restoreMeanMotion(const ScalarArray& mass, double mean, ScalarArray& change) const;
  void addReactions(Substep& now);

  /// Coefficient of the bending matrix in the global matrix [s^2].
  double bendWeight() const { return h_ * (h_ + bending_.retardation()); }
  /// Coefficient of a spring in the global matrix [kg].
  double weight(const SpringParameters& spring) const {
    return h_ * h_ * spring.stiffness + h_ * spring.damping;
  }

  int iterations_;           ///< at most, in a substep
  double tolerance_;         ///< of the residual [m/s^2]
  double h_ = 0.0;           ///< length of the substep that the matrix is for [s]
  double drag_ = 0.0;        ///< that the matrix is for [1/s]
  double holdWeight_ = 0.0;  ///< on the diagonal, for particles that are held [kg]
  double freeMass_ = 0.0;    ///< of particles that are not held [kg]
  BendMatrix bending_;
  UpdatableFactor factor_;
  bool isSolvable_ = true;  ///< the matrix was positive definite in spite of rounding
  std::vector<SpringConstraints::Element> heldSprings_;  ///< at kinematic particles
  ContactWarmStart warmStart_;
  VectorArray velocity_;         ///< at the start of the substep [m/s]
  VectorArray loads_;            ///< [N]
  VectorArray residual_;         ///< h^2 times the force out of balance [kg m]
  VectorArray change_;           ///< of positions [m]
  std::vector<double> squares_;  ///< of the residual, by part
};

void Projective::load(StateReader& archive, const Particles& particles) {
  archive(h_, drag_, holdWeight_, factor_, warmStart_);
  const auto slots = static_cast<std::size_t>(particles.slots);
  if (factor_.rows() > slots) throw std::invalid_argument("the factorisation has too many rows");
  if (!warmStart_.fits(slots)) throw std::invalid_argument("contact acts on no particle");
}

void Projective::begin(Substep& now) {
  if (now.isNewModel && !now.model.bending.empty()) bending_.build(now.model, now.particles);
  prepareMatrix(now);
}

void Projective::prepareMatrix(const Substep& now) {
  const bool isScaled = now.h != h_ || now.controls.drag != drag_;
  if (!isScaled && !now.isNewLayout) return;
  h_ = now.h;
  drag_ = now.controls.drag;
  freeMass_ = std::accumulate(now.particles.mass.begin(), now.particles.mass.end(), 0.0);
  listHeldSprings(now);
  if (isScaled || !isSolvable_ || factor_.rows() == 0) return factorise(now);
  const UpdatableFactor::Matrix matrix = globalMatrix(now);
  isSolvable_ = factor_.tryUpdate(matrix) || factor_.compute(matrix);
}

void Projective::listHeldSprings(const Substep& now) {
  heldSprings_.clear();
  now.springs.forEach([&](const SpringConstraints::Element& spring) {
    const bool isHeld =
        now.kinematic.targetOf(spring.a) != kNone || now.kinematic.targetOf(spring.b) != kNone;
    if (isHeld) heldSprings_.push_back(spring);
  });
}

void Projective::factorise(const Substep& now) {
  double largest = 0.0;
  for (const double m : now.particles.mass) largest = std::max(largest, m);
  now.springs.forEach([&](const SpringConstraints::Element& spring) {
    largest = std::max(largest, weight(spring.parameters));
  });
  holdWeight_ = kHold * (largest > 0.0 ? largest : 1.0);
  isSolvable_ = factor_.compute(globalMatrix(now));
}

/// M (1 + drag h) + h^2 K of springs, dashpots and bending [kg]; a particle that is held is tied to
/// its place.
UpdatableFactor::Matrix Projective::globalMatrix(const Substep& now) const {
  std::vector<Eigen::Triplet<double>> entries;
  const std::size_t n = now.particles.mass.size();
  entries.reserve(n + 3 * static_cast<std::size_t>(now.springs.size()));
  for (std::size_t k = 0; k < n; ++k) {
    const double m = now.particles.mass[k] * (1.0 + h_ * drag_);
    entries.emplace_back(k, k, m > 0.0 ? m : holdWeight_);
  }
  now.springs.forEach([&](const SpringConstraints::Element& spring) {
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

void Projective::advance(Substep& now) {
  Particles& p = now.particles;
  if (now.before == 0.0) warmStart_.begin(now.contacts, p, now.time - now.h, now.h);
  now.markStart();
  copy(p.v, velocity_);
  findLoads(now);
  setSum(p.start, now.h, p.v, p.x);
  now.placeKinematic();
  int k = 0;
  now.residual = 0.0;
  for (; k < iterations_; ++k) {
    now.residual = findResidual(now);
    if (now.residual <= tolerance_ || now.isStopped()) break;
    moveBySolution(now);
    now.placeKinematic();
  }
  now.iterations += k;
  findVelocity(now);
  addReactions(now);
  warmStart_.enforce(now.time, now.h, now.contacts, p);
}

void Projective::findLoads(Substep& now) {
  if (!now.controls.hasLoads()) return;
  setZero(now.particles.mass.size(), now.force);
  now.addLoads();
  loads_ = now.force;
}

/// Finds h^2 times the forces that are out of balance.
/// \return their size as a mean acceleration [m/s^2].
double Projective::findResidual(Substep& now) {
  const Particles& p = now.particles;
  if (now.controls.hasLoads()) {
    copy(loads_, now.force);
  } else {
    setZero(p.mass.size(), now.force);
  }
  warmStart_.addForces(p.mass, now.force);
  // Dashpots act on the motion in the substep.
  if (now.springs.areDamped() || bending_.retardation() > 0.0) findVelocity(now);
  now.springs.addForces(p.x, p.v, now.force);
  bending_.addForces(p.x, p.v, now.force);
  const std::size_t n = p.mass.size();
  residual_.resize(n);
  squares_.assign((n + kPart - 1) / kPart, 0.0);
  parallelForEach(squares_.size(),
                  [&](std::size_t part) { squares_[part] = findResidualOf(part, now); });
  const double square = std::accumulate(squares_.begin(), squares_.end(), 0.0);
  return freeMass_ > 0.0 ? std::sqrt(square / freeMass_) / (now.h * now.h) : 0.0;
}

/// \return the sum of the squares over the masses, of one part of the particles.
double Projective::findResidualOf(std::size_t part, const Substep& now) {
  const Particles& p = now.particles;
  const std::size_t begin = part * kPart;
  const std::size_t count = std::min(kPart, residual_.x.size() - begin);
  const double* const m = p.mass.data() + begin;
  const double* const w = p.inverseMass.data() + begin;
  double square = 0.0;
  int axis = 0;
  forAxes(
      [&](const auto& v, const auto& f, const auto& start, const auto& x, auto& r) {
        square += residualAxis(
            count, now.h, now.controls.gravity[axis++], now.controls.drag,
            {m, w, v.data() + begin, f.data() + begin, start.data() + begin, x.data() + begin},
            r.data() + begin);
      },
      velocity_, now.force, p.start, p.x, residual_);
  return square;
}

/// x += A^-1 residual. The solution is in single precision. Where nothing is held, the motion of
/// the centre of mass is kept out of it, so that linear momentum is right to round-off.
void Projective::moveBySolution(Substep& now) {
  Particles& p = now.particles;
  if (!isSolvable_) return setNaN(p.x);
  const bool isFree = now.kinematic.empty();
  std::array<double, 3> mean{};
  int axis = 0;
  if (isFree) forAxes([&](auto& r) { mean[axis++] = removeMeanMotion(p.mass, r); }, residual_);
  factor_.solve(residual_, change_);
  axis = 0;
  if (isFree) forAxes([&](auto& d) { restoreMeanMotion(p.mass, mean[axis++], d); }, change_);
  addScaled(1.0, change_, p.x);
}

/// \return the displacement of the centre of mass that belongs to what is removed [m].
double Projective::removeMeanMotion(const ScalarArray& mass, ScalarArray& residual) const {
  const double mean = std::accumulate(residual.begin(), residual.end(), 0.0) / freeMass_;
  for (std::size_t k = 0; k < residual.size(); ++k) residual[k] -= mass[k] * mean;
  const double inertia = freeMass_ * (1.0 + h_ * drag_);
  return mean * freeMass_ / inertia;
}

void Projective::restoreMeanMotion(const ScalarArray& mass, double mean,
                                   ScalarArray& change) const {
  const double error = std::inner_product(change.begin(), change.end(), mass.begin(), 0.0);
  for (double& d : change) d += mean - error / freeMass_;
}

/// Adds the forces on held particles where the substep ends.
void Projective::addReactions(Substep& now) {
  const Particles& p = now.particles;
  for (const std::int32_t k : now.kinematic.slots()) {
    const auto slot = static_cast<std::size_t>(k);
    now.force.set(slot, now.controls.hasLoads() ? loads_.at(slot) : Vec3::Zero());
  }
  for (const SpringConstraints::Element& spring : heldSprings_) {
    SpringConstraints::addForce(spring, p.x, p.v, now.force);
  }
  for (const std::int32_t k : now.kinematic.slots()) {
    bending_.addForce(static_cast<std::size_t>(k), p.x, p.v, now.force);
  }
  now.kinematic.addForces(now.h, now.force);
}

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
  info.meetsSharpFeatures = false;  // in its long steps they throw the cloth away
  info.noLayers = "its global solve does not know of them";
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
    return std::make_unique<SubstepSolver>(model, substepsOf(p), std::make_unique<Projective>(p));
  };
  return info;
}

}  // namespace cloth_sim
