#include "updatable_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// A change of an entry, relative to it, that is taken for rounding.
constexpr double kSameEntry = 1e-12;
/// A factorisation costs the sum over columns of the square of their entries; a change costs this
/// much per entry that it passes, in the same unit (measured: docs/design_notes.md).
constexpr double kCostOfEntry = 3.0;

/// Changes after which rounding may have added up to something.
constexpr std::int64_t kMostChanges = 100000;
/// How many times as many entries as at first L may have.
constexpr std::size_t kMostGrowth = 2;

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
  u_.assign(n, 0.0);
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
  return std::all_of(changes.begin(), changes.end(),
                     [this](const Change& change) { return apply(change); });
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
  u_.push_back(0.0);
}

bool UpdatableFactor::isCheap(const std::vector<Change>& changes) const {
  if (changes_ > kMostChanges || factor_.row.size() > kMostGrowth * entriesAtFirst_) return false;
  double anew = 0.0;
  for (const SparseFactor::Column& column : factor_.columns)
    anew += static_cast<double>(column.count) * column.count;
  double cost = 0.0;
  for (const Change& change : changes) {
    std::int32_t j = change.b == kNone ? change.a : std::min(change.a, change.b);
    for (; j != kNone; j = factor_.parent(j))
      cost += factor_.columns[static_cast<std::size_t>(j)].count;
    if (kCostOfEntry * cost > anew) return false;
  }
  return true;
}

bool UpdatableFactor::apply(const Change& change) {
  ++changes_;
  u_[static_cast<std::size_t>(change.a)] = 1.0;
  support_.clear();
  std::int32_t j = change.a;
  if (change.b != kNone) {
    u_[static_cast<std::size_t>(change.b)] = -1.0;
    j = std::min(change.a, change.b);
    support_.push_back(std::max(change.a, change.b));
  }
  double weight = change.weight;
  bool mayFill = true;
  while (j != kNone) {
    const auto at = static_cast<std::size_t>(j);
    // Whatever has a place in a column has one in all columns further up the tree.
    mayFill = mayFill && takeIn(j);
    const double first = u_[at];
    u_[at] = 0.0;
    const double d = factor_.diagonal[at] + weight * first * first;
    if (!(d > 0.0)) return false;
    const double step = weight * first / d;
    weight *= factor_.diagonal[at] / d;
    factor_.diagonal[at] = d;
    const SparseFactor::Column& column = factor_.columns[at];
    for (std::int32_t k = 0; k < column.count; ++k) {
      const std::size_t entry = column.begin + static_cast<std::size_t>(k);
      double& u = u_[static_cast<std::size_t>(factor_.row[entry])];
      u -= first * factor_.value[entry];
      factor_.value[entry] += step * u;
    }
    j = factor_.parent(j);
  }
  return true;
}

/// Column j gets the entries that u_ will fill; then they are what u_ reaches further down.
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

void UpdatableFactor::solve(const PackedVectors& right, PackedVectors& x) {
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
  u_.assign(rows(), 0.0);
  panelsFollow_ = false;
}

}  // namespace cloth_sim
