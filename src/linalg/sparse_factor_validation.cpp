/// \file Checks of a factorisation that was read from a file.

#include <algorithm>
#include <cmath>

#include "supernodal_solver.h"

namespace cloth_sim {
namespace {

/// Tells whether the entries of every column are within the storage, and of no other column.
bool haveOwnEntries(const SparseFactor& factor) {
  std::vector<SparseFactor::Column> columns = factor.columns;
  for (const SparseFactor::Column& column : columns) {
    if (column.count < 0 || column.count > column.capacity) return false;
    const auto capacity = static_cast<std::size_t>(column.capacity);
    if (column.begin > factor.row.size() || capacity > factor.row.size() - column.begin) {
      return false;
    }
  }
  std::sort(columns.begin(), columns.end(), [](const auto& a, const auto& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.capacity < b.capacity;
  });
  for (std::size_t k = 1; k < columns.size(); ++k) {
    const auto capacity = static_cast<std::size_t>(columns[k - 1].capacity);
    if (columns[k - 1].begin + capacity > columns[k].begin) return false;
  }
  return true;
}

/// Tells whether the rows of column j ascend below the diagonal, and are within the matrix.
bool haveRowsBelow(const SparseFactor& factor, std::size_t j) {
  const SparseFactor::Column& column = factor.columns[j];
  std::int64_t last = static_cast<std::int64_t>(j);
  for (std::size_t k = column.begin; k < column.begin + static_cast<std::size_t>(column.count);
       ++k) {
    if (factor.row[k] <= last || !std::isfinite(factor.value[k])) return false;
    last = factor.row[k];
  }
  return last < static_cast<std::int64_t>(factor.size());
}

/// Tells whether the rows of column j, but for that of its parent, are among the rows of the
/// parent.
bool passOnRows(const SparseFactor& factor, std::size_t j) {
  const SparseFactor::Column& column = factor.columns[j];
  if (column.count < 2) return true;
  const auto rows = factor.row.begin() + static_cast<std::ptrdiff_t>(column.begin);
  const SparseFactor::Column& parent = factor.columns[static_cast<std::size_t>(*rows)];
  const auto above = factor.row.begin() + static_cast<std::ptrdiff_t>(parent.begin);
  return std::includes(above, above + parent.count, rows + 1, rows + column.count);
}

}  // namespace

std::string validationError(const SparseFactor& factor) {
  if (factor.columns.size() != factor.size() || factor.value.size() != factor.row.size()) {
    return "its columns, entries and diagonal do not fit each other";
  }
  if (!haveOwnEntries(factor)) return "a column has entries that are not its own";
  for (std::size_t j = 0; j < factor.size(); ++j) {
    if (!haveRowsBelow(factor, j)) return "the rows of a column are not in order";
    if (!(factor.diagonal[j] > 0.0) || !std::isfinite(factor.diagonal[j])) {
      return "the diagonal is not positive";
    }
  }
  for (std::size_t j = 0; j < factor.size(); ++j) {
    if (!passOnRows(factor, j)) return "a column has entries that elimination does not leave";
  }
  return "";
}

}  // namespace cloth_sim
