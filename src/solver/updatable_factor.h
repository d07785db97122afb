#pragma once
/// \file A sparse factorisation that follows small changes of its matrix.

#include <Eigen/SparseCore>
#include <array>

#include "cloth_sim/solver/packed_particles.h"

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

  /// Orders (approximate minimum degree) and factorises.
  /// \throws std::runtime_error if the matrix is not positive definite.
  void compute(const Matrix& matrix);

  /// Goes from the matrix before to this one, which may have more rows but not fewer.
  /// False: to compute it anew costs less, or rounding made it indefinite; then compute it.
  bool follow(const Matrix& matrix);

  /// x = A^-1 right, of three right-hand sides.
  void solve(const PackedVectors& right, PackedVectors& x);

  std::size_t rows() const { return diagonal_.size(); }

  /// \tparam Archive StateWriter or StateReader
  template <class Archive>
  void serialize(Archive& archive) {
    std::vector<std::int32_t> row, column;
    std::vector<double> value;
    if constexpr (Archive::is_saving::value) listEntries(row, column, value);
    archive(column_, row_, value_, diagonal_, position_, row, column, value);
    if constexpr (Archive::is_loading::value) readEntries(row, column, value);
  }

 private:
  /// The entries of a column of L below the diagonal: a stretch of row_ and value_, rows ascending.
  struct Column {
    std::size_t begin = 0;
    std::int32_t count = 0;
    std::int32_t capacity = 0;

    template <class Archive>
    void serialize(Archive& archive) {
      archive(begin, count, capacity);
    }
  };

  /// weight u u^T, u being 1 at a and, if there is a b, -1 at b. These are columns of L.
  struct Change {
    std::int32_t a = 0;
    std::int32_t b = kNone;
    double weight = 0.0;
  };

  std::vector<Change> changesTo(const Matrix& matrix, std::vector<double>& rest) const;
  void append(double diagonal);
  bool isCheap(const std::vector<Change>& changes) const;
  bool apply(const Change& change);
  void takeIn(std::int32_t j);
  void widen(std::int32_t j);
  std::int32_t parent(std::int32_t j) const;
  void listEntries(std::vector<std::int32_t>& row, std::vector<std::int32_t>& column,
                   std::vector<double>& value) const;
  void readEntries(const std::vector<std::int32_t>& row, const std::vector<std::int32_t>& column,
                   const std::vector<double>& value);

  Matrix matrix_;               ///< that L and D are of
  std::vector<Column> column_;  ///< of L
  std::vector<std::int32_t> row_;
  std::vector<double> value_;
  std::vector<double> diagonal_;             ///< D
  std::vector<std::int32_t> position_;       ///< column of L by row of the matrix
  std::vector<double> u_;                    ///< by column of L; zeros between changes
  std::vector<std::int32_t> support_;        ///< rows below the current one that u_ reaches
  std::vector<std::int32_t> merged_;         ///< for takeIn
  std::vector<std::array<double, 4>> work_;  ///< three coordinates by column of L
};

}  // namespace cloth_sim
