#pragma once
/// \file Triangular solves with a sparse factor, in single precision.

#include <cstdint>
#include <string>
#include <vector>

#include "vector_array.h"

namespace cloth_sim {

/// L and D of a factorisation L D L^T: a sparse unit lower triangular matrix, stored by columns,
/// and a diagonal matrix.
struct SparseFactor {
  /// The entries of one column of L below the diagonal, rows ascending.
  struct Column {
    std::size_t begin = 0;      ///< first entry, an index into `row` and `value`
    std::int32_t count = 0;     ///< entries
    std::int32_t capacity = 0;  ///< entries that fit before storage of other columns begins

    template <class Archive>
    void serialize(Archive& archive) {
      archive(begin, count, capacity);
    }
  };

  std::vector<Column> columns;    ///< shape (n,)
  std::vector<std::int32_t> row;  ///< by entry
  std::vector<double> value;      ///< by entry
  std::vector<double> diagonal;   ///< D, shape (n,)

  std::size_t size() const { return diagonal.size(); }
  /// Parent of column j in the elimination tree: the row of its first entry below the diagonal;
  /// kNone if it has none.
  std::int32_t parent(std::int32_t j) const {
    const Column& column = columns[static_cast<std::size_t>(j)];
    return column.count > 0 ? row[column.begin] : kNone;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(columns, row, value, diagonal);
  }
};

/// Checks that a factor which was read from a file is one: columns have their entries to
/// themselves, rows ascend below the diagonal, and the rows of a column are among those of its
/// parent, as elimination leaves them. Solvers and updates follow these indices. \return one
/// sentence about the first error; empty if there is none.
std::string validationError(const SparseFactor& factor);

/// Solver for A x = b, given A = P^T L D L^T P, with a supernodal copy of L.
///
/// A supernode is a sequence of columns of L whose entries lie in nearly the same rows, stored as
/// one dense block (Ng & Peyton, Block sparse Cholesky algorithms on advanced uniprocessor
/// computers, 1993). A row index is then read once for each row of the block instead of once for
/// each entry. The time of a solve is the time to read L twice. Single precision halves that;
/// callers refine the solution by iterating on a residual in double precision.
///
/// Columns of disjoint subtrees of the elimination tree do not depend on each other. The
/// subtrees are distributed over groups of about the same work, which are solved in parallel; the
/// columns above all of them are the separator (George & Liu, Computer Solution of Large Sparse
/// Positive Definite Systems, 1981). The forward substitution solves the separator last, the
/// backward substitution solves it first. Contributions of the groups to the separator are summed
/// in a fixed order and the partition depends on L alone, so the solution does not depend on the
/// number of threads.
class SupernodalSolver {
 public:
  /// Copies L and D.
  /// \param permutation  P: row i of A is row permutation[i] of L; shape (n,).
  void build(const SparseFactor& factor, const std::vector<std::int32_t>& permutation);

  /// Solves A x = right for three right-hand sides, the coordinates. The relative error is about
  /// 1e-7 times the condition number of A.
  /// \param right  shape (n,), in the order of A's rows
  /// \param x      is resized to shape (n,)
  void solve(const VectorArray& right, VectorArray& x);

 private:
  using Float4 = float __attribute__((vector_size(16)));

  /// Consecutive columns, stored as a dense block of width + rows rows and `width` columns.
  struct Supernode {
    std::int32_t first = 0;      ///< column
    std::int32_t width = 0;      ///< columns
    std::int32_t rows = 0;       ///< below the diagonal of the last column
    std::int32_t groupRows = 0;  ///< of these, rows of the supernode's own group; they come first
    std::size_t row = 0;         ///< index of the first of `rows` row indices in row_
    std::size_t value = 0;       ///< index of the block in value_, which holds it row by row
  };

  /// The supernodes [begin, end): one or several subtrees of the elimination tree.
  struct SubtreeGroup {
    std::size_t begin = 0;
    std::size_t end = 0;
    /// Sum of L x over the group's columns, by row of the separator.
    std::vector<Float4> contributionToSeparator;
  };

  struct Layout;
  /// Kernels for supernodes of one width.
  struct Kernels;

  void listGroups(const Layout& layout);
  void addSupernode(const SparseFactor& factor, const Layout& layout, std::int32_t supernode);
  void copyBlock(const SparseFactor& factor, std::int32_t first, const Supernode& supernode);
  void substituteForward();
  void substituteBackward();

  std::vector<Supernode> supernodes_;  ///< group by group, then the separator
  std::vector<SubtreeGroup> groups_;
  std::size_t firstOfSeparator_ = 0;  ///< supernode
  std::int32_t separatorRow_ = 0;     ///< first row of the separator
  std::vector<std::int32_t> row_;
  std::vector<float> value_;
  std::vector<float> inverseDiagonal_;     ///< 1 / D, shape (n,)
  std::vector<std::int32_t> permutation_;  ///< row of A -> row in the order of supernodes_
  std::vector<Float4> work_;               ///< x, y, z and padding by row, shape (n,)
};

}  // namespace cloth_sim
