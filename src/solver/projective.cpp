#include <Eigen/SparseCholesky>
#include <cmath>

#include "bend_matrix.h"
#include "cloth_sim/sim/archive.h"
#include "cloth_sim/solver/packed_solver.h"
#include "methods.h"
#include "packed_ops.h"

namespace cloth_sim {
namespace {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;
/// Conjugate gradients after which a new factorisation is cheaper.
constexpr int kStale = 6;
constexpr int kMostLinear = 200;
constexpr double kLinearTolerance = 0.1;  ///< of the residual, per iteration

/// Projective dynamics for springs (Liu, Bargteil, O'Brien & Kavan 2013): backward Euler,
/// alternating between the direction of each spring (local) and the positions given the directions
/// (global). The matrix of the global step, M (1 + drag h) / h^2 + sum of (k + c/h) S^T S, does not
/// depend on the state and is factorised once. A dashpot is a projection too: of the relative
/// motion in the substep on its part across the spring. A bending energy is quadratic already: its
/// matrix is part of the global step's.
///
/// After cuts and tears, and while clamps hold other particles, the old factorisation goes on as
/// the preconditioner of conjugate gradients on the new matrix: exact but for the rows that
/// changed, so it takes about as many iterations as the change has rank. Only when they become too
/// many is it made anew.
class Projective final : public PackedSolver {
 public:
  Projective(const Model& model, const SolverParameters& parameters)
      : PackedSolver(model, static_cast<int>(parameters.at("substeps"))),
        iterations_(static_cast<int>(parameters.at("iterations"))),
        tolerance_(parameters.at("tolerance")) {}

 private:
  using Matrix = Eigen::SparseMatrix<double>;

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
    if (scaled || factorised() == 0) factorise();
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

  /// preconditioned = (old factorisation)^-1 rest; the diagonal for particles that came later.
  void precondition() {
    const Eigen::Index n = matrix_.rows();
    preconditioned_.resize(diagonal_.size());
    forAxes(
        [&](const auto& from, auto& to) {
          right_ = Eigen::Map<const Eigen::VectorXd>(from.data(), n);
          solution_ = factor_.solve(right_);
          Eigen::Map<Eigen::VectorXd>(to.data(), n) = solution_;
          for (std::size_t k = factorised(); k < to.size(); ++k) {
            to[k] = diagonal_[k] > 0.0 ? from[k] / diagonal_[k] : 0.0;
          }
        },
        rest_, preconditioned_);
    hold(preconditioned_);
  }

  /// Zero for particles with prescribed motion.
  void hold(PackedVectors& q) const {
    for (std::size_t k = 0; k < diagonal_.size(); ++k) {
      if (diagonal_[k] <= 0.0) q.set(k, Vec3::Zero());
    }
  }

  void factorise() {
    const auto n = static_cast<Eigen::Index>(diagonal_.size());
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(diagonal_.size() + 4 * weight_.size());
    for (Eigen::Index k = 0; k < n; ++k) {
      const double m = diagonal_[static_cast<std::size_t>(k)];
      entries.emplace_back(k, k, m > 0.0 ? m : 1.0);
    }
    for (std::size_t p = 0; p < weight_.size(); ++p) {
      if (weight_[p] == 0.0) continue;
      const std::int32_t a = schedule_.endA[p];
      const std::int32_t b = schedule_.endB[p];
      const bool heldA = diagonal_[static_cast<std::size_t>(a)] <= 0.0;
      const bool heldB = diagonal_[static_cast<std::size_t>(b)] <= 0.0;
      if (!heldA) entries.emplace_back(a, a, weight_[p]);
      if (!heldB) entries.emplace_back(b, b, weight_[p]);
      if (!heldA && !heldB) entries.emplace_back(std::max(a, b), std::min(a, b), -weight_[p]);
    }
    bending_.forLower([&](std::size_t row, std::int32_t column, double value) {
      const bool held = diagonal_[row] <= 0.0 || diagonal_[static_cast<std::size_t>(column)] <= 0.0;
      if (!held) entries.emplace_back(row, column, bendWeight() * value);
    });
    matrix_.resize(n, n);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(matrix_);
    linear_ = 0;
  }

  /// The old factorisation, as the matrix that it is of.
  void saveMemory(StateWriter& archive) const override {
    archive(step_, drag_, static_cast<std::int64_t>(matrix_.rows()));
    std::vector<std::int32_t> row, column;
    std::vector<double> value;
    for (Eigen::Index k = 0; k < matrix_.outerSize(); ++k) {
      for (Matrix::InnerIterator entry(matrix_, k); entry; ++entry) {
        row.push_back(static_cast<std::int32_t>(entry.row()));
        column.push_back(static_cast<std::int32_t>(entry.col()));
        value.push_back(entry.value());
      }
    }
    archive(row, column, value);
  }

  void loadMemory(StateReader& archive) override {
    std::int64_t n = 0;
    std::vector<std::int32_t> row, column;
    std::vector<double> value;
    archive(step_, drag_, n, row, column, value);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < value.size(); ++k)
      entries.emplace_back(row[k], column[k], value[k]);
    matrix_.resize(n, n);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    if (n > 0) factor_.compute(matrix_);
  }

  /// Particles that factor_ knows.
  std::size_t factorised() const { return static_cast<std::size_t>(matrix_.rows()); }

  BendMatrix bending_;
  int iterations_;
  double tolerance_;  ///< of the residual [m/s^2]
  double step_ = 0.0;
  double drag_ = 0.0;
  std::vector<double> diagonal_;  ///< mass (1 + drag h) by particle; 0: prescribed [kg]
  std::vector<double> weight_;    ///< h^2 k + h c by position of the schedule [kg]
  Matrix matrix_;                 ///< that factor_ is of
  Eigen::SimplicialLDLT<Matrix> factor_;
  int linear_ = 0;          ///< iterations of the last solve
  PackedVectors velocity_;  ///< at the start of the substep [m/s]
  PackedVectors wind_, residual_, change_, rest_, preconditioned_, search_, product_, moved_;
  Eigen::VectorXd right_, solution_;
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
