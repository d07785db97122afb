#include "updatable_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Changes of an entry below this fraction of it are rounding errors.
constexpr double kRounding = 1e-12;
/// Cost of an update for each entry of L that it changes. The unit is that of the cost of a
/// factorisation, the sum of squared column counts. Measured:
/// docs/decisions/030-updatable-factor.md.
constexpr double kUpdateCost = 3.0;
/// Rank-one updates after which the factor is computed anew, because rounding errors add up.
constexpr std::int64_t kMaxUpdates = 100000;
/// Entries of L at which it is computed anew, as a multiple of those that it was computed with.
constexpr std::size_t kMaxGrowth = 2;

/// Symbols of method C1 (Gill et al. 1974) for one update in one column j.
struct ColumnUpdate {
  double p = 0.0;       ///< p_j = w_j
  double beta = 0.0;    ///< beta_j = alpha_j p_j / d_j'
  double* w = nullptr;  ///< w, by row of L
};

/// Applies updates to one column: w_r -= p l_rj, then l_rj += beta w_r, for each row r. Rows are
/// visited in runs of consecutive ones, for which the compiler vectorises the loop.
/// \param row    rows of the column's entries, shape (count,)
/// \param value  the entries, shape (count,)
CLOTH_SIM_VECTOR_CLONES
void updateEntries(const ColumnUpdate* begin, const ColumnUpdate* end, const std::int32_t* row,
                   double* value, std::int32_t count) {
  for (std::int32_t k = 0; k < count;) {
    std::int32_t last = k + 1;
    while (last < count && row[last] == row[last - 1] + 1) ++last;
    for (const ColumnUpdate* update = begin; update != end; ++update) {
      double* const w = update->w + row[k];
      double* const l = value + k;
      for (std::int32_t i = 0; i < last - k; ++i) {
        w[i] -= update->p * l[i];
        l[i] += update->beta * w[i];
      }
    }
    k = last;
  }
}

/// Calls `body(row, column, before, after)` for each stored entry of either matrix, with 0 where
/// one of them has none. `after` has at least as many columns as `before`.
template <typename Body>
void forEachEntry(const UpdatableFactor::Matrix& before, const UpdatableFactor::Matrix& after,
                  const Body& body) {
  using Iterator = UpdatableFactor::Matrix::InnerIterator;
  for (Eigen::Index column = 0; column < after.outerSize(); ++column) {
    Iterator a(after, column);
    Iterator b = column < before.outerSize() ? Iterator(before, column) : Iterator();
    while (a || b) {
      const bool isInAfter = a && (!b || a.row() <= b.row());
      const bool isInBefore = b && (!a || b.row() <= a.row());
      const Eigen::Index row = isInAfter ? a.row() : b.row();
      body(row, column, isInBefore ? b.value() : 0.0, isInAfter ? a.value() : 0.0);
      if (isInAfter) ++a;
      if (isInBefore) ++b;
    }
  }
}

/// Copies the strictly lower triangle of L, and D. Storage of `factor` is used again.
void copyFactor(const Eigen::SimplicialLDLT<UpdatableFactor::Matrix>& eigen,
                const Eigen::VectorXd& d, SparseFactor& factor) {
  const auto& l = eigen.matrixL().nestedExpression();
  factor.columns.resize(static_cast<std::size_t>(l.cols()));
  factor.row.clear();
  factor.value.clear();
  for (std::size_t j = 0; j < factor.columns.size(); ++j) {
    SparseFactor::Column& column = factor.columns[j];
    column.begin = factor.row.size();
    for (UpdatableFactor::Matrix::InnerIterator entry(l, static_cast<Eigen::Index>(j)); entry;
         ++entry) {
      if (entry.row() <= entry.col()) continue;
      factor.row.push_back(static_cast<std::int32_t>(entry.row()));
      factor.value.push_back(entry.value());
    }
    column.count = static_cast<std::int32_t>(factor.row.size() - column.begin);
    column.capacity = column.count;
  }
  factor.diagonal.assign(d.data(), d.data() + d.size());
}

}  // namespace

bool UpdatableFactor::compute(const Matrix& matrix) {
  const Eigen::SimplicialLDLT<Matrix> eigen(matrix);
  const Eigen::VectorXd d = eigen.vectorD();
  if (eigen.info() != Eigen::Success || !(d.minCoeff() > 0.0)) return false;
  matrix_ = matrix;
  copyFactor(eigen, d, factor_);
  const auto& order = eigen.permutationP().indices();
  permutation_.assign(order.data(), order.data() + order.size());
  computedEntries_ = factor_.row.size();
  updates_ = 0;
  w_.fill(std::vector<double>(rows(), 0.0));
  isOnPath_.assign(rows(), 0);
  isSolverCurrent_ = false;
  return true;
}

bool UpdatableFactor::tryUpdate(const Matrix& matrix) {
  const std::size_t before = permutation_.size();
  permutation_.resize(static_cast<std::size_t>(matrix.rows()));
  std::iota(permutation_.begin() + static_cast<std::ptrdiff_t>(before), permutation_.end(),
            static_cast<std::int32_t>(before));
  std::vector<double> diagonalChange(permutation_.size(), 0.0);
  std::vector<RankOneUpdate> updates = offDiagonalUpdates(matrix, diagonalChange);
  appendRows(matrix, diagonalChange);
  addDiagonalUpdates(matrix, diagonalChange, updates);
  if (updates.empty() && permutation_.size() == before) return true;
  matrix_ = matrix;
  isSolverCurrent_ = false;
  if (!isCheaperThanComputing(updates)) return false;
  std::stable_partition(updates.begin(), updates.end(),
                        [](const RankOneUpdate& update) { return update.alpha > 0.0; });
  const RankOneUpdate* const end = updates.data() + updates.size();
  for (const RankOneUpdate* first = updates.data(); first != end;) {
    const RankOneUpdate* const last = first + std::min<std::ptrdiff_t>(kMaxRank, end - first);
    if (!apply(first, last)) return false;
    first = last;
  }
  return true;
}

/// Finds an update with alpha = -c for each off-diagonal entry that changes by c. Such an update
/// also subtracts c from two diagonal entries.
/// \param diagonalChange  receives what the diagonal has to change by in addition; shape (n,), zero
///                        before
std::vector<UpdatableFactor::RankOneUpdate> UpdatableFactor::offDiagonalUpdates(
    const Matrix& matrix, std::vector<double>& diagonalChange) const {
  std::vector<RankOneUpdate> updates;
  const auto compare = [&](Eigen::Index row, Eigen::Index column, double before, double after) {
    const double change = after - before;
    const bool isRounding =
        std::abs(change) <= kRounding * std::max(std::abs(before), std::abs(after));
    if (row < column || isRounding) return;
    const auto a = static_cast<std::size_t>(row);
    const auto b = static_cast<std::size_t>(column);
    diagonalChange[a] += change;
    if (a == b) return;
    diagonalChange[b] += change;
    updates.push_back({permutation_[a], permutation_[b], -change});
  };
  forEachEntry(matrix_, matrix, compare);
  return updates;
}

/// Appends a row without off-diagonal entries for each further row of the matrix. Its diagonal
/// entry takes up the change of the diagonal, or all of the new entry if that is not positive.
void UpdatableFactor::appendRows(const Matrix& matrix, std::vector<double>& diagonalChange) {
  for (std::size_t k = rows(); k < diagonalChange.size(); ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    const double d = diagonalChange[k] > 0.0 ? diagonalChange[k] : matrix.coeff(j, j);
    diagonalChange[k] -= d;
    factor_.columns.push_back({factor_.row.size(), 0, 0});
    factor_.diagonal.push_back(d);
    for (std::vector<double>& w : w_) w.push_back(0.0);
    isOnPath_.push_back(0);
  }
}

void UpdatableFactor::addDiagonalUpdates(const Matrix& matrix,
                                         const std::vector<double>& diagonalChange,
                                         std::vector<RankOneUpdate>& updates) const {
  for (std::size_t k = 0; k < diagonalChange.size(); ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    if (std::abs(diagonalChange[k]) > kRounding * matrix.coeff(j, j)) {
      updates.push_back({permutation_[k], kNone, diagonalChange[k]});
    }
  }
}

/// Compares estimated costs; false also if a new factorisation is due. Fill-in of the updates is
/// not counted.
bool UpdatableFactor::isCheaperThanComputing(const std::vector<RankOneUpdate>& updates) const {
  if (updates_ > kMaxUpdates || factor_.row.size() > kMaxGrowth * computedEntries_) return false;
  double costOfComputing = 0.0;
  for (const SparseFactor::Column& column : factor_.columns) {
    costOfComputing += static_cast<double>(column.count) * column.count;
  }
  double entries = 0.0;
  for (const RankOneUpdate& update : updates) {
    for (std::int32_t j = update.firstColumn(); j != kNone; j = factor_.parent(j)) {
      entries += factor_.columns[static_cast<std::size_t>(j)].count;
    }
    if (kUpdateCost * entries > costOfComputing) return false;
  }
  return true;
}

/// Applies at most kMaxRank updates in one pass over the columns that they change.
/// \return false if the matrix is not positive definite, in spite of rounding; the factor is then
///         undefined
bool UpdatableFactor::apply(const RankOneUpdate* begin, const RankOneUpdate* end) {
  Alphas alpha{};
  path_.clear();
  for (const RankOneUpdate* update = begin; update != end; ++update) {
    const auto k = static_cast<std::size_t>(update - begin);
    alpha[k] = update->alpha;
    w_[k][static_cast<std::size_t>(update->a)] = 1.0;
    if (update->b != kNone) w_[k][static_cast<std::size_t>(update->b)] = -1.0;
    addFillIn(*update);
  }
  for (const RankOneUpdate* update = begin; update != end; ++update) addPath(update->firstColumn());
  std::sort(path_.begin(), path_.end());
  for (const std::int32_t j : path_) isOnPath_[static_cast<std::size_t>(j)] = 0;
  updates_ += end - begin;
  return std::all_of(path_.begin(), path_.end(),
                     [&](std::int32_t j) { return updateColumn(j, alpha); });
}

/// Adds zero entries to L where an update makes them nonzero. A column that has all rows of the
/// pattern passes them on to all columns further up the path, so the search ends there.
void UpdatableFactor::addFillIn(const RankOneUpdate& update) {
  pattern_.clear();
  if (update.b != kNone) pattern_.push_back(std::max(update.a, update.b));
  std::int32_t j = update.firstColumn();
  while (j != kNone && mergePattern(j)) j = factor_.parent(j);
}

/// Adds the rows of `pattern_` below j to column j. The pattern of the column becomes `pattern_`.
/// \return false if the column had all of them
bool UpdatableFactor::mergePattern(std::int32_t j) {
  SparseFactor::Column& column = factor_.columns[static_cast<std::size_t>(j)];
  const auto begin = factor_.row.begin() + static_cast<std::ptrdiff_t>(column.begin);
  const auto end = begin + column.count;
  const auto first = std::upper_bound(pattern_.begin(), pattern_.end(), j);
  if (std::includes(begin, end, first, pattern_.end())) return false;
  merged_.clear();
  std::set_union(begin, end, first, pattern_.end(), std::back_inserter(merged_));
  while (column.capacity < static_cast<std::int32_t>(merged_.size())) growColumn(column);
  moveEntries(column);
  pattern_ = merged_;
  return true;
}

/// Moves the entries of a column to their places among the rows `merged_`, with zeros between them.
void UpdatableFactor::moveEntries(SparseFactor::Column& column) {
  // From the back, so that no entry is overwritten before it has moved.
  std::size_t from = column.begin + static_cast<std::size_t>(column.count);
  std::size_t to = column.begin + merged_.size();
  for (std::size_t k = merged_.size(); k-- > 0;) {
    const bool isOld = from > column.begin && factor_.row[from - 1] == merged_[k];
    --to;
    factor_.value[to] = isOld ? factor_.value[--from] : 0.0;
    factor_.row[to] = merged_[k];
  }
  column.count = static_cast<std::int32_t>(merged_.size());
}

/// Moves a column to the end of the storage, with at least twice its capacity.
void UpdatableFactor::growColumn(SparseFactor::Column& column) {
  const std::size_t begin = factor_.row.size();
  column.capacity = 2 * column.capacity + 8;
  factor_.row.resize(begin + static_cast<std::size_t>(column.capacity));
  factor_.value.resize(factor_.row.size());
  const auto count = static_cast<std::size_t>(column.count);
  std::copy_n(factor_.row.begin() + static_cast<std::ptrdiff_t>(column.begin), count,
              factor_.row.begin() + static_cast<std::ptrdiff_t>(begin));
  std::copy_n(factor_.value.begin() + static_cast<std::ptrdiff_t>(column.begin), count,
              factor_.value.begin() + static_cast<std::ptrdiff_t>(begin));
  column.begin = begin;
}

/// Adds the columns from j to the root of the elimination tree to `path_`, except those in it.
void UpdatableFactor::addPath(std::int32_t j) {
  for (; j != kNone && isOnPath_[static_cast<std::size_t>(j)] == 0; j = factor_.parent(j)) {
    isOnPath_[static_cast<std::size_t>(j)] = 1;
    path_.push_back(j);
  }
}

/// One step of method C1 in column j, for all updates in turn: d' = d + alpha p^2,
/// beta = alpha p / d', alpha' = alpha d / d'.
/// \return false if d' is not positive
bool UpdatableFactor::updateColumn(std::int32_t j, Alphas& alpha) {
  const auto at = static_cast<std::size_t>(j);
  std::array<ColumnUpdate, kMaxRank> updates;
  int count = 0;
  double& d = factor_.diagonal[at];
  for (std::size_t k = 0; k < kMaxRank; ++k) {
    const double p = std::exchange(w_[k][at], 0.0);
    if (p == 0.0) continue;  // this update does not change the column
    const double before = d;
    d += alpha[k] * p * p;
    if (!(d > 0.0)) return false;
    updates[static_cast<std::size_t>(count++)] = {p, alpha[k] * p / d, w_[k].data()};
    alpha[k] *= before / d;
  }
  const SparseFactor::Column& column = factor_.columns[at];
  updateEntries(updates.data(), updates.data() + count, factor_.row.data() + column.begin,
                factor_.value.data() + column.begin, column.count);
  return true;
}

void UpdatableFactor::solve(const VectorArray& right, VectorArray& x) {
  if (!isSolverCurrent_) solver_.build(factor_, permutation_);
  isSolverCurrent_ = true;
  solver_.solve(right, x);
}

/// Lists the entries of A, to save them.
void UpdatableFactor::listEntries(std::vector<std::int32_t>& row, std::vector<std::int32_t>& column,
                                  std::vector<double>& value) const {
  for (Eigen::Index k = 0; k < matrix_.outerSize(); ++k) {
    for (Matrix::InnerIterator entry(matrix_, k); entry; ++entry) {
      row.push_back(static_cast<std::int32_t>(entry.row()));
      column.push_back(static_cast<std::int32_t>(entry.col()));
      value.push_back(entry.value());
    }
  }
}

/// Checks P, L and D that were read from a file. \throws std::invalid_argument
void UpdatableFactor::checkFactor() const {
  const std::string error = validationError(factor_);
  if (!error.empty()) throw std::invalid_argument("the factorisation: " + error);
  std::vector<bool> isTaken(rows(), false);
  bool isPermutation = permutation_.size() == rows();
  for (const std::int32_t k : permutation_) {
    const auto at = static_cast<std::size_t>(k);
    isPermutation = isPermutation && k >= 0 && at < rows() && !isTaken[at];
    if (!isPermutation) throw std::invalid_argument("the factorisation permutes no rows");
    isTaken[at] = true;
  }
  if (!isPermutation || updates_ < 0) throw std::invalid_argument("the factorisation has no rows");
}

/// Makes A from its entries and resets all that is not saved.
void UpdatableFactor::readEntries(const std::vector<std::int32_t>& row,
                                  const std::vector<std::int32_t>& column,
                                  const std::vector<double>& value) {
  if (row.size() != value.size() || column.size() != value.size()) {
    throw std::invalid_argument("the matrix of a factorisation has no such entries");
  }
  const auto isRow = [this](std::int32_t k) {
    return k >= 0 && static_cast<std::size_t>(k) < rows();
  };
  if (!std::all_of(row.begin(), row.end(), isRow) ||
      !std::all_of(column.begin(), column.end(), isRow)) {
    throw std::invalid_argument("the matrix of a factorisation has no such rows");
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < value.size(); ++k) {
    entries.emplace_back(row[k], column[k], value[k]);
  }
  const auto n = static_cast<Eigen::Index>(rows());
  matrix_.resize(n, n);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  w_.fill(std::vector<double>(rows(), 0.0));
  isOnPath_.assign(rows(), 0);
  isSolverCurrent_ = false;
}

}  // namespace cloth_sim
