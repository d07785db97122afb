#pragma once
/// \file Fast triangular solves with a sparse factor, in single precision.

#include <cstdint>
#include <vector>

#include "vector_array.h"

namespace cloth_sim {

/// L and D of a factorisation L D L^T: a unit lower triangular matrix by columns, and a diagonal.
struct SparseFactor {
  /// The entries of a column of L below the diagonal: a stretch of `row` and `value`, rows
  /// ascending.
  struct Column {
    std::size_t begin = 0;
    std::int32_t count = 0;
    std::int32_t capacity = 0;  ///< of the stretch

    template <class Archive>
    void serialize(Archive& archive) {
      archive(begin, count, capacity);
    }
  };

  std::vector<Column> columns;
  std::vector<std::int32_t> row;
  std::vector<double> value;
  std::vector<double> diagonal;  ///< D

  std::size_t size() const { return diagonal.size(); }
  /// The first row below the diagonal of a column, which is its parent in the elimination tree.
  std::int32_t parent(std::int32_t j) const {
    const Column& column = columns[static_cast<std::size_t>(j)];
    return column.count > 0 ? row[column.begin] : kNone;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(columns, row, value, diagonal);
  }
};

/// Columns of L whose entries are in nearly the same rows lie together as a dense panel
/// (supernodes: Ng & Peyton, Block sparse Cholesky algorithms on advanced uniprocessor computers,
/// 1993), so that an index is read once per row of a panel and not once per entry. A solve reads L
/// twice and does little else: in single precision that is half the bytes. What it is used for is a
/// step of an iteration whose residual is in double precision, so the result of that is not
/// rounded.
///
/// Subtrees of the elimination tree share no row but those above them, so they go in parallel: they
/// are gathered into groups of about the same work, and what is above all of them, the top, comes
/// after (forward) or before (backward). What groups add to the top is summed up group by group.
/// The division depends on L alone, so the result does not depend on the number of threads.
class SupernodalSolver {
 public:
  /// \param position  row of L by row of the matrix.
  void build(const SparseFactor& factor, const std::vector<std::int32_t>& position);

  /// x = A^-1 right, of three right-hand sides, to about 1e-7 times the condition of A.
  void solve(const VectorArray& right, VectorArray& x);

 private:
  using Float4 = float __attribute__((vector_size(16)));

  /// Consecutive columns.
  struct Panel {
    std::int32_t first = 0;    ///< column
    std::int32_t width = 0;    ///< columns
    std::int32_t rows = 0;     ///< below the last column's diagonal
    std::int32_t ownRows = 0;  ///< of these, in the panel's own group; the rest are in the top
    std::size_t row = 0;       ///< in row_
    std::size_t value = 0;  ///< in value_: the square on the diagonal by rows, then the rows below
  };

  /// Consecutive panels.
  struct Group {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::vector<Float4> toTop;  ///< what its panels take from the rows of the top
  };

  struct Layout;
  /// Kernels for panels of one width.
  struct Kernels;

  void add(const SparseFactor& factor, const Layout& layout, std::int32_t panel);
  void forward();
  void backward();

  std::vector<Panel> panels_;  ///< by group; then the top
  std::vector<Group> groups_;
  std::size_t firstOfTop_ = 0;  ///< panel
  std::int32_t topRow_ = 0;     ///< the first row of the top
  std::vector<std::int32_t> row_;
  std::vector<float> value_;
  std::vector<float> inverseDiagonal_;
  std::vector<std::int32_t> position_;
  std::vector<Float4> work_;  ///< three coordinates by row of L
};

}  // namespace cloth_sim
