#pragma once
/// \file Sparse LDL^T factorisation that is updated when its matrix changes a little.

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>

#include "supernodal_solver.h"

namespace cloth_sim {

/// P A P^T = L D L^T of a sparse symmetric positive definite matrix A.
///
/// A change of A is written as a sum of rank-one terms alpha z z^T with one or two entries in z: a
/// spring that is added or removed is one term, a particle that is held or released is one. A term
/// changes only the columns on one path of the elimination tree, from the first entry of P z to the
/// root (Davis & Hager, Modifying a sparse Cholesky factorization, 1999). Along it,
/// method C1 of Gill, Golub, Murray & Saunders (Methods for modifying matrix factorizations, 1974)
/// changes L and D. Several terms pass a column together (Davis & Hager, Multiple-rank
/// modifications of a sparse Cholesky factorization, 2001). Terms with alpha > 0 are applied first,
/// so that every intermediate matrix is positive definite.
class UpdatableFactor {
 public:
  /// Symmetric; only its lower triangle is read.
  using Matrix = Eigen::SparseMatrix<double>;

  /// Finds an ordering (approximate minimum degree) and factorises.
  /// \return false if the matrix is not positive definite or not finite; the factor is then
  ///         unchanged.
  [[nodiscard]] bool compute(const Matrix& matrix);

  /// Updates the factor to a matrix with a few other entries. Further rows are appended; the matrix
  /// must not have fewer rows than before.
  /// \return false if the factor has to be computed anew: because that is cheaper, because too many
  ///         updates have added fill-in or rounding errors, or because rounding made the matrix
  ///         indefinite. The factor must not be used until compute() has succeeded.
  [[nodiscard]] bool tryUpdate(const Matrix& matrix);

  /// Solves A x = right; see SupernodalSolver::solve.
  void solve(const VectorArray& right, VectorArray& x);

  std::size_t rows() const { return factor_.size(); }
  const SparseFactor& factor() const { return factor_; }
  /// P: row i of A is row permutation()[i] of L.
  const std::vector<std::int32_t>& permutation() const { return permutation_; }

  /// \tparam Archive StateWriter or StateReader; reading throws std::invalid_argument if the bytes
  ///                 are not those of a factorisation
  template <class Archive>
  void serialize(Archive& archive) {
    std::vector<std::int32_t> row, column;
    std::vector<double> value;
    if constexpr (Archive::is_saving::value) listEntries(row, column, value);
    archive(factor_, permutation_, computedEntries_, updates_, row, column, value);
    if constexpr (Archive::is_loading::value) {
      checkFactor();
      readEntries(row, column, value);
    }
  }

 private:
  /// The term alpha z z^T with z = e_a - e_b, or z = e_a if b is kNone. Rows of L.
  struct RankOneUpdate {
    std::int32_t a = 0;
    std::int32_t b = kNone;
    double alpha = 0.0;

    /// First column that the update changes.
    std::int32_t firstColumn() const { return b == kNone ? a : std::min(a, b); }
  };

  /// Updates that pass a column of L together, at most.
  static constexpr std::size_t kMaxRank = 8;
  using Alphas = std::array<double, kMaxRank>;

  std::vector<RankOneUpdate> offDiagonalUpdates(const Matrix& matrix,
                                                std::vector<double>& diagonalChange) const;
  void appendRows(const Matrix& matrix, std::vector<double>& diagonalChange);
  void addDiagonalUpdates(const Matrix& matrix, const std::vector<double>& diagonalChange,
                          std::vector<RankOneUpdate>& updates) const;
  bool isCheaperThanComputing(const std::vector<RankOneUpdate>& updates) const;
  bool apply(const RankOneUpdate* begin, const RankOneUpdate* end);
  void addFillIn(const RankOneUpdate& update);
  bool mergePattern(std::int32_t j);
  void moveEntries(SparseFactor::Column& column);
  void growColumn(SparseFactor::Column& column);
  void addPath(std::int32_t j);
  bool updateColumn(std::int32_t j, Alphas& alpha);
  void checkFactor() const;
  void listEntries(std::vector<std::int32_t>& row, std::vector<std::int32_t>& column,
                   std::vector<double>& value) const;
  void readEntries(const std::vector<std::int32_t>& row, const std::vector<std::int32_t>& column,
                   const std::vector<double>& value);

  Matrix matrix_;  ///< A
  SparseFactor factor_;
  std::vector<std::int32_t> permutation_;
  std::size_t computedEntries_ = 0;  ///< entries of L after compute()
  std::int64_t updates_ = 0;         ///< rank-one updates since compute()

  // Scratch space of apply().
  std::array<std::vector<double>, kMaxRank> w_;  ///< by update, then row of L; else zero
  std::vector<std::int32_t> path_;               ///< columns that updates change
  std::vector<char> isOnPath_;                   ///< by column of L; else zero
  std::vector<std::int32_t> pattern_;  ///< rows of the update's entries below the current column
  std::vector<std::int32_t> merged_;   ///< pattern of a column after fill-in

  SupernodalSolver solver_;
  bool isSolverCurrent_ = false;  ///< solver_ was built from factor_ as it is now
};

}  // namespace cloth_sim
