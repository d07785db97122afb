#pragma once
/// \file A sparse factorisation that follows small changes of its matrix.

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>

#include "supernodal_solver.h"

namespace cloth_sim {

/// P A P^T = L D L^T of a sparse symmetric positive definite matrix A.
///
/// A change of A is a sum of terms s u u^T with one or two entries in u: a spring that came or went
/// is one of them, a particle that is held or let go another. Each passes through the columns of L
/// on one path of the elimination tree, from the first entry of u to the root (Davis & Hager,
/// Modifying a sparse Cholesky factorization, 1999), by method C1 of Gill, Golub, Murray & Saunders
/// (Methods for modifying matrix factorizations, 1974). Rows that come later are last in the order.
/// What is added goes before what is taken away, so that no matrix on the way is indefinite.
class UpdatableFactor {
 public:
  /// Of these, the lower triangle is read.
  using Matrix = Eigen::SparseMatrix<double>;

  /// Orders (approximate minimum degree) and factorises. False: the matrix is not positive
  /// definite, or not finite; all is as before.
  bool compute(const Matrix& matrix);

  /// Goes from the matrix before to this one, which may have more rows but not fewer.
  /// False: to compute it anew costs less, or is due after many changes, or rounding made it
  /// indefinite; then compute it.
  bool follow(const Matrix& matrix);

  /// x = A^-1 right, of three right-hand sides; see SupernodalSolver::solve.
  void solve(const VectorArray& right, VectorArray& x);

  std::size_t rows() const { return factor_.size(); }
  const SparseFactor& factor() const { return factor_; }
  /// Row of L by row of the matrix.
  const std::vector<std::int32_t>& position() const { return position_; }

  /// \tparam Archive StateWriter or StateReader
  template <class Archive>
  void serialize(Archive& archive) {
    std::vector<std::int32_t> row, column;
    std::vector<double> value;
    if constexpr (Archive::is_saving::value) listEntries(row, column, value);
    archive(factor_, position_, entriesAtFirst_, changes_, row, column, value);
    if constexpr (Archive::is_loading::value) readEntries(row, column, value);
  }

 private:
  /// weight u u^T, u being 1 at a and, if there is a b, -1 at b. These are columns of L.
  struct Change {
    std::int32_t a = 0;
    std::int32_t b = kNone;
    double weight = 0.0;
  };

  /// Changes that go through L together, and a value of each.
  static constexpr std::size_t kTogether = 8;
  using Weights = std::array<double, kTogether>;

  std::vector<Change> changesTo(const Matrix& matrix, std::vector<double>& rest) const;
  void append(double diagonal);
  bool isCheap(const std::vector<Change>& changes) const;
  static std::int32_t firstOf(const Change& change) {
    return change.b == kNone ? change.a : std::min(change.a, change.b);
  }
  bool apply(const Change* begin, const Change* end);
  void fillIn(const Change& change);
  void listPath(std::int32_t j);
  bool applyTo(std::int32_t j, Weights& weight);
  bool takeIn(std::int32_t j);
  void widen(std::int32_t j);
  void listEntries(std::vector<std::int32_t>& row, std::vector<std::int32_t>& column,
                   std::vector<double>& value) const;
  void readEntries(const std::vector<std::int32_t>& row, const std::vector<std::int32_t>& column,
                   const std::vector<double>& value);

  Matrix matrix_;  ///< that L and D are of
  SparseFactor factor_;
  std::vector<std::int32_t> position_;  ///< column of L by row of the matrix
  std::size_t entriesAtFirst_ = 0;      ///< of L, when it was computed
  std::int64_t changes_ = 0;            ///< since then
  /// Of each change, by column of L; zeros between changes.
  std::array<std::vector<double>, kTogether> u_;
  std::vector<std::int32_t> path_;     ///< columns that changes pass
  std::vector<char> isOnPath_;         ///< by column of L; zeros between changes
  std::vector<std::int32_t> support_;  ///< rows below the current one that a change reaches
  std::vector<std::int32_t> merged_;   ///< for takeIn
  SupernodalSolver panels_;            ///< of factor_ ...
  bool panelsFollow_ = false;          ///< ... as it is now
};

}  // namespace cloth_sim
