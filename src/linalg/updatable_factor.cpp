#include "updatable_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// A change of an entry, relative to it, that is taken for rounding.
constexpr double kSameEntry = 1e-12;
/// A factorisation costs the sum over columns of the square of their entries; a change costs this
/// much per entry that it passes, in the same unit (measured: docs/decisions/030).
constexpr double kCostOfEntry = 3.0;

/// Changes after which rounding may have added up to something.
constexpr std::int64_t kMostChanges = 100000;
/// How many times as many entries as at first L may have.
constexpr std::size_t kMostGrowth = 2;

/// A change that passes a column.
struct Pass {
  double first = 0.0;   ///< its entry in the row of the column
  double step = 0.0;    ///< of the column's entries, by its own
  double* u = nullptr;  ///< its entries, by row
};

/// In most columns rows follow each other in long runs.
CLOTH_SIM_VECTOR_CLONES
void passColumn(const Pass* begin, const Pass* end, const std::int32_t* row, double* value,
                std::int32_t count) {
  for (std::int32_t k = 0; k < count;) {
    std::int32_t last = k + 1;
    while (last < count && row[last] == row[last - 1] + 1) ++last;
    for (const Pass* pass = begin; pass != end; ++pass) {
      double* const u = pass->u + row[k];
      double* const v = value + k;
      for (std::int32_t i = 0; i < last - k; ++i) {
        u[i] -= pass->first * v[i];
        v[i] += pass->step * u[i];
      }
    }
    k = last;
  }
}

}  // namespace

bool UpdatableFactor::compute(const Matrix& matrix) {
  Eigen::SimplicialLDLT<Matrix> factor(matrix);
  const Eigen::VectorXd d = factor.vectorD();
  if (factor.info() != Eigen::Success || !(d.minCoeff() > 0.0)) return false;
  const auto& l = factor.matrixL().nestedExpression();
  const auto n = static_cast<std::size_t>(l.cols());
  matrix_ = matrix;
  panelsFollow_ = false;
  factor_.row.clear();
  factor_.value.clear();
  factor_.columns.assign(n, {});
  for (std::size_t j = 0; j < n; ++j) {
    factor_.columns[j].begin = factor_.row.size();
    for (Matrix::InnerIterator entry(l, static_cast<Eigen::Index>(j)); entry; ++entry) {
      if (entry.row() <= entry.col()) continue;
      factor_.row.push_back(static_cast<std::int32_t>(entry.row()));
      factor_.value.push_back(entry.value());
    }
    factor_.columns[j].count =
        static_cast<std::int32_t>(factor_.row.size() - factor_.columns[j].begin);
    factor_.columns[j].capacity = factor_.columns[j].count;
  }
  factor_.diagonal.assign(d.data(), d.data() + n);
  const auto& order = factor.permutationP().indices();
  position_.assign(order.data(), order.data() + n);
  u_.fill(std::vector<double>(n, 0.0));
  isOnPath_.assign(n, 0);
  entriesAtFirst_ = factor_.row.size();
  changes_ = 0;
  return true;
}

bool UpdatableFactor::follow(const Matrix& matrix) {
  const auto before = static_cast<std::size_t>(matrix_.rows());
  const auto n = static_cast<std::size_t>(matrix.rows());
  for (std::size_t k = before; k < n; ++k) position_.push_back(static_cast<std::int32_t>(k));
  std::vector<double> rest(n, 0.0);
  std::vector<Change> changes = changesTo(matrix, rest);
  for (std::size_t k = before; k < n; ++k) {
    const double whole = matrix.coeff(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k));
    const double start = rest[k] > 0.0 ? rest[k] : whole;
    append(start);
    rest[k] -= start;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    if (std::abs(rest[k]) > kSameEntry * matrix.coeff(j, j)) {
      changes.push_back({position_[k], kNone, rest[k]});
    }
  }
  if (changes.empty() && n == before) return true;
  matrix_ = matrix;
  panelsFollow_ = false;
  if (!isCheap(changes)) return false;
  std::stable_partition(changes.begin(), changes.end(),
                        [](const Change& change) { return change.weight > 0.0; });
  const Change* const end = changes.data() + changes.size();
  for (const Change* change = changes.data(); change != end;) {
    const Change* const last = change + std::min<std::ptrdiff_t>(kTogether, end - change);
    if (!apply(change, last)) return false;
    change = last;
  }
  return true;
}

/// The terms of two entries; in `rest`, what is then left of the change on the diagonal.
std::vector<UpdatableFactor::Change> UpdatableFactor::changesTo(const Matrix& matrix,
                                                                std::vector<double>& rest) const {
  std::vector<Change> changes;
  const auto note = [&](Eigen::Index row, Eigen::Index column, double from, double to) {
    const double difference = to - from;
    const bool isRounding =
        std::abs(difference) <= kSameEntry * std::max(std::abs(from), std::abs(to));
    if (row < column || isRounding) return;
    const auto a = static_cast<std::size_t>(row);
    const auto b = static_cast<std::size_t>(column);
    rest[a] += difference;
    if (a == b) return;
    rest[b] += difference;
    changes.push_back({position_[a], position_[b], -difference});
  };
  for (Eigen::Index k = 0; k < matrix.outerSize(); ++k) {
    Matrix::InnerIterator now(matrix, k);
    Matrix::InnerIterator old(matrix_, std::min(k, matrix_.outerSize() - 1));
    const bool isNew = k >= matrix_.outerSize();
    while (now || (old && !isNew)) {
      const bool hasOld = old && !isNew;
      const Eigen::Index row = !hasOld ? now.row()
                               : !now  ? old.row()
                                       : std::min(now.row(), old.row());
      double from = 0.0, to = 0.0;
      if (hasOld && old.row() == row) {
        from = old.value();
        ++old;
      }
      if (now && now.row() == row) {
        to = now.value();
        ++now;
      }
      note(row, k, from, to);
    }
  }
  return changes;
}

void UpdatableFactor::append(double diagonal) {
  factor_.columns.push_back({factor_.row.size(), 0, 0});
  factor_.diagonal.push_back(diagonal);
  for (std::vector<double>& u : u_) u.push_back(0.0);
  isOnPath_.push_back(0);
}

bool UpdatableFactor::isCheap(const std::vector<Change>& changes) const {
  if (changes_ > kMostChanges || factor_.row.size() > kMostGrowth * entriesAtFirst_) return false;
  double anew = 0.0;
  for (const SparseFactor::Column& column : factor_.columns)
    anew += static_cast<double>(column.count) * column.count;
  double cost = 0.0;
  for (const Change& change : changes) {
    for (std::int32_t j = firstOf(change); j != kNone; j = factor_.parent(j))
      cost += factor_.columns[static_cast<std::size_t>(j)].count;
    if (kCostOfEntry * cost > anew) return false;
  }
  return true;
}

/// Some changes, one after the other in every column: so that L is read once for all of them.
bool UpdatableFactor::apply(const Change* begin, const Change* end) {
  std::array<double, kTogether> weight{};
  path_.clear();
  for (const Change* change = begin; change != end; ++change) {
    const auto c = static_cast<std::size_t>(change - begin);
    weight[c] = change->weight;
    u_[c][static_cast<std::size_t>(change->a)] = 1.0;
    if (change->b != kNone) u_[c][static_cast<std::size_t>(change->b)] = -1.0;
    fillIn(*change);
  }
  for (const Change* change = begin; change != end; ++change) listPath(firstOf(*change));
  std::sort(path_.begin(), path_.end());
  for (const std::int32_t j : path_) isOnPath_[static_cast<std::size_t>(j)] = 0;
  changes_ += end - begin;
  return std::all_of(path_.begin(), path_.end(),
                     [&](std::int32_t j) { return applyTo(j, weight); });
}

/// The columns of the path from j to the root that are not in the list.
void UpdatableFactor::listPath(std::int32_t j) {
  for (; j != kNone && isOnPath_[static_cast<std::size_t>(j)] == 0; j = factor_.parent(j)) {
    isOnPath_[static_cast<std::size_t>(j)] = 1;
    path_.push_back(j);
  }
}

bool UpdatableFactor::applyTo(std::int32_t j, Weights& weight) {
  const auto at = static_cast<std::size_t>(j);
  std::array<Pass, kTogether> passes;
  int count = 0;
  double& d = factor_.diagonal[at];
  for (std::size_t c = 0; c < kTogether; ++c) {
    const double first = std::exchange(u_[c][at], 0.0);
    if (first == 0.0) continue;  // has not come to it, or does not
    const double before = d;
    d += weight[c] * first * first;
    if (!(d > 0.0)) return false;
    passes[static_cast<std::size_t>(count++)] = {first, weight[c] * first / d, u_[c].data()};
    weight[c] *= before / d;
  }
  const SparseFactor::Column& column = factor_.columns[at];
  passColumn(passes.data(), passes.data() + count, factor_.row.data() + column.begin,
             factor_.value.data() + column.begin, column.count);
  return true;
}

/// Makes room for all that a change reaches.
void UpdatableFactor::fillIn(const Change& change) {
  support_.clear();
  if (change.b != kNone) support_.push_back(std::max(change.a, change.b));
  // Whatever has a place in a column has one in all columns further up the tree.
  for (std::int32_t j = firstOf(change); j != kNone && takeIn(j); j = factor_.parent(j)) {
  }
}

/// Column j gets the entries of the support; then they are the support further up the tree.
/// \return whether some are new.
bool UpdatableFactor::takeIn(std::int32_t j) {
  SparseFactor::Column& column = factor_.columns[static_cast<std::size_t>(j)];
  const auto begin = factor_.row.begin() + static_cast<std::ptrdiff_t>(column.begin);
  const auto end = begin + column.count;
  const auto first = std::upper_bound(support_.begin(), support_.end(), j);
  if (std::includes(begin, end, first, support_.end())) return false;
  merged_.clear();
  std::set_union(begin, end, first, support_.end(), std::back_inserter(merged_));
  while (column.capacity < static_cast<std::int32_t>(merged_.size())) widen(j);
  // From the back, so that no entry is written over before it has moved.
  std::size_t from = column.begin + static_cast<std::size_t>(column.count);
  std::size_t to = column.begin + merged_.size();
  for (std::size_t k = merged_.size(); k-- > 0;) {
    const bool had = from > column.begin && factor_.row[from - 1] == merged_[k];
    --to;
    factor_.value[to] = had ? factor_.value[--from] : 0.0;
    factor_.row[to] = merged_[k];
  }
  column.count = static_cast<std::int32_t>(merged_.size());
  support_ = merged_;
  return true;
}

/// Moves a column to where it has room for more.
void UpdatableFactor::widen(std::int32_t j) {
  SparseFactor::Column& column = factor_.columns[static_cast<std::size_t>(j)];
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

void UpdatableFactor::solve(const VectorArray& right, VectorArray& x) {
  if (!panelsFollow_) panels_.build(factor_, position_);
  panelsFollow_ = true;
  panels_.solve(right, x);
}

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

void UpdatableFactor::readEntries(const std::vector<std::int32_t>& row,
                                  const std::vector<std::int32_t>& column,
                                  const std::vector<double>& value) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < value.size(); ++k) {
    entries.emplace_back(row[k], column[k], value[k]);
  }
  const auto n = static_cast<Eigen::Index>(rows());
  matrix_.resize(n, n);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  u_.fill(std::vector<double>(rows(), 0.0));
  isOnPath_.assign(rows(), 0);
  panelsFollow_ = false;
}

}  // namespace cloth_sim
