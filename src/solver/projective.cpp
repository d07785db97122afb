#include <algorithm>
#include <cmath>

#include "bend_matrix.h"
#include "cloth_sim/sim/archive.h"
#include "cloth_sim/solver/packed_solver.h"
#include "methods.h"
#include "packed_ops.h"
#include "updatable_factor.h"

namespace cloth_sim {
namespace {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;
/// Conjugate gradients after which rounding has spoilt the factorisation.
constexpr int kStale = 6;
/// On the diagonal for a particle that is held, relative to the largest entry there: what is left
/// of its motion is taken out of the solution, and letting it go costs six digits out of sixteen.
constexpr double kHold = 1e6;
constexpr int kMostLinear = 200;
constexpr double kLinearTolerance = 0.1;  ///< of the residual, per iteration

/// Projective dynamics for springs (Liu, Bargteil, O'Brien & Kavan 2013): backward Euler,
/// alternating between the direction of each spring (local) and the positions given the directions
/// (global). The matrix of the global step, M (1 + drag h) / h^2 + sum of (k + c/h) S^T S, does not
/// depend on the state and is factorised once. A dashpot is a projection too: of the relative
/// motion in the substep on its part across the spring. A bending energy is quadratic already: its
/// matrix is part of the global step's.
///
/// After cuts and tears, and when clamps take or leave particles, the factorisation is updated
/// (UpdatableFactor); only when that would cost more is it made anew. Conjugate gradients with the
/// factorisation before them take one iteration then, and say if rounding has spoilt it.
class Projective final : public PackedSolver {
 public:
  Projective(const Model& model, const SolverParameters& parameters)
      : PackedSolver(model, static_cast<int>(parameters.at("substeps"))),
        iterations_(static_cast<int>(parameters.at("iterations"))),
        tolerance_(parameters.at("tolerance")) {}

 private:
  void loadBending(const Model& model) override { bending_.build(model, particles_); }

  void prepare(const Controls& controls, double h) override {
    if (h == step_ && controls.drag == drag_ && !layoutChanged_) return;
    const bool scaled = h != step_ || controls.drag != drag_;
    step_ = h;
    drag_ = controls.drag;
    const std::size_t n = particles_.mass.size();
    diagonal_.resize(n);
    for (std::size_t k = 0; k < n; ++k) diagonal_[k] = particles_.mass[k] * (1.0 + h * drag_);
    weight_.resize(static_cast<std::size_t>(schedule_.size()));
    for (std::size_t p = 0; p < weight_.size(); ++p) {
      weight_[p] = h * h * schedule_.stiffness[p] + h * schedule_.damping[p];
    }
    if (scaled || factor_.rows() == 0) {
      factorise();
    } else {
      const UpdatableFactor::Matrix matrix = globalMatrix();
      if (!factor_.follow(matrix)) factor_.compute(matrix);
    }
  }

  void substep(const Substep& now) override {
    markStart();
    velocity_ = particles_.v;
    findWind(now);
    setSum(particles_.start, now.h, particles_.v, particles_.x);
    placeKinematic(now.fraction);
    int k = 0;
    double residual = findResidual(now);
    for (; k < iterations_ && residual > tolerance_; ++k) {
      solveGlobal();
      forAxes(
          [](auto& x, const auto& d) {
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += d[i];
          },
          particles_.x, change_);
      residual = findResidual(now);
    }
    noteIterations(k, residual);
    addForcesToReactions(now.h);
    setSum(particles_.x, -1.0, particles_.start, particles_.v);
    forAxes(
        [&](auto& axis) {
          for (double& v : axis) v /= now.h;
        },
        particles_.v);
    enforceContacts(now);
    if (linear_ > kStale) factorise();
  }

  void findWind(const Substep& now) {
    setZero(particles_.mass.size(), force_);
    if (now.controls.hasLoads()) addLoads(now.model, now.controls);
    wind_ = force_;
  }

  /// h^2 times the forces that are out of balance, in `residual_`; as a mean acceleration [m/s^2].
  /// Forces of springs and dashpots, and the wind, in `force_` [N].
  double findResidual(const Substep& now) {
    setZero(particles_.mass.size(), force_);
    schedule_.sweep([&](std::int32_t p) { addPull(p, now.h); });
    bending_.addProduct(-1.0, particles_.x, force_);
    if (bending_.retardation() > 0.0) {
      setSum(particles_.x, -1.0, particles_.start, moved_);
      bending_.addProduct(-bending_.retardation() / now.h, moved_, force_);
    }
    addScaled(1.0, wind_, force_);
    residual_.resize(particles_.mass.size());
    double square = 0.0;
    double total = 0.0;
    const double h = now.h;
    for (std::size_t k = 0; k < particles_.mass.size(); ++k) {
      const double mass = particles_.mass[k];
      if (mass <= 0.0) {
        residual_.set(k, Vec3::Zero());
        continue;
      }
      const Vec3 moved = particles_.x.at(k) - particles_.start.at(k);
      const Vec3 aim = h * velocity_.at(k) + h * h * now.controls.gravity;
      const Vec3 r = mass * aim + h * h * force_.at(k) - diagonal_[k] * moved;
      residual_.set(k, r);
      square += r.squaredNorm() / mass;
      total += mass;
    }
    return total > 0.0 ? std::sqrt(square / total) / (h * h) : 0.0;
  }

  void addPull(std::int32_t p, double h) {
    const auto a = static_cast<std::size_t>(schedule_.endA[p]);
    const auto b = static_cast<std::size_t>(schedule_.endB[p]);
    const Vec3 d = particles_.x.at(b) - particles_.x.at(a);
    const double length = std::sqrt(d.squaredNorm() + kTinySquare);
    const Vec3 n = d / length;
    const double moved = n.dot(d - (particles_.start.at(b) - particles_.start.at(a)));
    const double f = schedule_.stiffness[p] * (length - schedule_.restLength[p]) +
                     schedule_.damping[p] * moved / h;
    force_.set(a, force_.at(a) + f * n);
    force_.set(b, force_.at(b) - f * n);
  }

  /// Solves A change = residual by conjugate gradients with the factorisation before them.
  void solveGlobal() {
    const std::size_t n = particles_.mass.size();
    setZero(n, change_);
    rest_ = residual_;
    precondition();
    search_ = preconditioned_;
    double rz = dot(rest_, preconditioned_);
    const double enough = kLinearTolerance * kLinearTolerance * dot(residual_, residual_);
    for (linear_ = 1; linear_ <= kMostLinear; ++linear_) {
      multiply();
      const double curvature = dot(search_, product_);
      if (!(curvature > 0.0)) return;
      addScaled(rz / curvature, search_, change_);
      addScaled(-rz / curvature, product_, rest_);
      if (dot(rest_, rest_) <= enough) return;
      precondition();
      const double next = dot(rest_, preconditioned_);
      setSum(preconditioned_, next / rz, search_, search_);
      rz = next;
    }
  }

  /// product = A search.
  void multiply() {
    const std::size_t n = diagonal_.size();
    product_.resize(n);
    for (std::size_t k = 0; k < n; ++k) product_.set(k, diagonal_[k] * search_.at(k));
    schedule_.sweep([&](std::int32_t p) {
      const auto a = static_cast<std::size_t>(schedule_.endA[p]);
      const auto b = static_cast<std::size_t>(schedule_.endB[p]);
      const Vec3 f = weight_[p] * (search_.at(a) - search_.at(b));
      product_.set(a, product_.at(a) + f);
      product_.set(b, product_.at(b) - f);
    });
    bending_.addProduct(bendWeight(), search_, product_);
    hold(product_);
  }

  /// What the matrix of the bending energy counts in the global step's.
  double bendWeight() const { return step_ * (step_ + bending_.retardation()); }

  void precondition() {
    factor_.solve(rest_, preconditioned_);
    hold(preconditioned_);
  }

  /// Zero for particles with prescribed motion.
  void hold(PackedVectors& q) const {
    for (std::size_t k = 0; k < diagonal_.size(); ++k) {
      if (diagonal_[k] <= 0.0) q.set(k, Vec3::Zero());
    }
  }

  void factorise() {
    const double largest = *std::max_element(diagonal_.begin(), diagonal_.end());
    const double stiffest =
        weight_.empty() ? 0.0 : *std::max_element(weight_.begin(), weight_.end());
    holdWeight_ = kHold * std::max({largest, stiffest, kTinySquare});
    factor_.compute(globalMatrix());
    linear_ = 0;
  }

  /// The matrix of the global step; a particle that is held is tied to its place.
  UpdatableFactor::Matrix globalMatrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(diagonal_.size() + 3 * weight_.size());
    const auto n = static_cast<Eigen::Index>(diagonal_.size());
    for (Eigen::Index k = 0; k < n; ++k) {
      const double m = diagonal_[static_cast<std::size_t>(k)];
      entries.emplace_back(k, k, m > 0.0 ? m : holdWeight_);
    }
    for (std::size_t p = 0; p < weight_.size(); ++p) {
      if (weight_[p] == 0.0) continue;
      const std::int32_t a = schedule_.endA[p];
      const std::int32_t b = schedule_.endB[p];
      entries.emplace_back(a, a, weight_[p]);
      entries.emplace_back(b, b, weight_[p]);
      entries.emplace_back(std::max(a, b), std::min(a, b), -weight_[p]);
    }
    bending_.forLower([&](std::size_t row, std::int32_t column, double value) {
      entries.emplace_back(row, column, bendWeight() * value);
    });
    UpdatableFactor::Matrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  void saveMemory(StateWriter& archive) const override {
    archive(step_, drag_, holdWeight_, factor_);
  }
  void loadMemory(StateReader& archive) override { archive(step_, drag_, holdWeight_, factor_); }

  BendMatrix bending_;
  int iterations_;
  double tolerance_;  ///< of the residual [m/s^2]
  double step_ = 0.0;
  double drag_ = 0.0;
  std::vector<double> diagonal_;  ///< mass (1 + drag h) by particle; 0: prescribed [kg]
  std::vector<double> weight_;    ///< h^2 k + h c by position of the schedule [kg]
  double holdWeight_ = 0.0;       ///< on the diagonal, for particles that are held [kg]
  UpdatableFactor factor_;
  int linear_ = 0;          ///< iterations of the last solve
  PackedVectors velocity_;  ///< at the start of the substep [m/s]
  PackedVectors wind_, residual_, change_, rest_, preconditioned_, search_, product_, moved_;
};

}  // namespace

SolverInfo projectiveInfo() {
  SolverInfo info;
  info.name = "projective";
  info.title = "Projective dynamics (fast mass-spring)";
  info.reference = "Liu, Bargteil, O'Brien & Kavan, Fast Simulation of Mass-Spring Systems, 2013";
  info.limitations =
      "backward Euler's damping; converges slowly where stiff cloth turns in a substep";
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
