#include "supernodal_solver.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <type_traits>

#include "support/vector_clones.h"
#include "vector_operations.h"

namespace cloth_sim {
namespace {

/// Columns of a supernode, at most: as many vectors fit in the registers of SSE2.
constexpr std::int32_t kMaxWidth = 8;
/// Zeros that a supernode may store, as a fraction of its entries of L, plus a constant.
constexpr double kPaddingFraction = 0.3;
constexpr double kPaddingConstant = 16.0;

/// Number of columns of the supernode that begins at column `first`. A column joins if it is the
/// parent of the one before it and the padding stays within its limit.
std::int32_t supernodeWidth(const SparseFactor& factor, std::int32_t first) {
  const auto n = static_cast<std::int32_t>(factor.size());
  const auto countOf = [&](std::int32_t j) {
    return factor.columns[static_cast<std::size_t>(j)].count;
  };
  double entries = countOf(first);
  std::int32_t width = 1;
  while (width < kMaxWidth && first + width < n &&
         factor.parent(first + width - 1) == first + width) {
    const std::int32_t last = first + width;
    entries += countOf(last);
    const double stored = 0.5 * width * (width + 1) + (width + 1.0) * countOf(last);
    if (stored > (1.0 + kPaddingFraction) * entries + kPaddingConstant) break;
    ++width;
  }
  return width;
}

/// Subtree groups of a partition.
constexpr std::size_t kGroups = 4;
/// A factor with fewer entries is solved by one thread: it is all separator.
constexpr double kMinParallelEntries = 1e5;
/// Largest subtree that is not divided, as a fraction of a group's equal part of the work.
constexpr double kMaxSubtreeFraction = 0.8;
/// The separator grows no further once it has this fraction of the work.
constexpr double kMaxSeparatorFraction = 0.25;

/// The elimination tree of supernodes. Work is counted in stored entries. Children have lower
/// indices than their parents.
struct SupernodeTree {
  std::vector<std::int32_t> parent;  ///< kNone: a root
  std::vector<double> work;
  std::vector<double> subtreeWork;  ///< of the supernode and all its descendants
};

/// Orders supernodes by the work of their subtrees, heaviest first.
struct IsHeavier {
  const SupernodeTree* tree;

  bool operator()(std::int32_t a, std::int32_t b) const {
    const double workA = tree->subtreeWork[static_cast<std::size_t>(a)];
    const double workB = tree->subtreeWork[static_cast<std::size_t>(b)];
    return workA != workB ? workA > workB : a > b;
  }
};
using Subtrees = std::set<std::int32_t, IsHeavier>;

/// Roots of disjoint subtrees that are light enough for a balanced partition. The supernodes above
/// them are the separator. Starting with the whole tree, the heaviest subtree is replaced by its
/// children and its root joins the separator.
Subtrees divideIntoSubtrees(const SupernodeTree& tree) {
  Subtrees roots(IsHeavier{&tree});
  std::vector<std::vector<std::int32_t>> children(tree.parent.size());
  for (std::size_t k = 0; k < tree.parent.size(); ++k) {
    const auto supernode = static_cast<std::int32_t>(k);
    if (tree.parent[k] == kNone) {
      roots.insert(supernode);
    } else {
      children[static_cast<std::size_t>(tree.parent[k])].push_back(supernode);
    }
  }
  const double total = std::accumulate(tree.work.begin(), tree.work.end(), 0.0);
  const double maxSubtree = kMaxSubtreeFraction * total / kGroups;
  double separator = 0.0;
  while (!roots.empty() && separator < kMaxSeparatorFraction * total) {
    const auto heaviest = static_cast<std::size_t>(*roots.begin());
    if (tree.subtreeWork[heaviest] <= maxSubtree) break;
    roots.erase(roots.begin());
    separator += tree.work[heaviest];
    roots.insert(children[heaviest].begin(), children[heaviest].end());
  }
  return roots;
}

/// Distributes the subtrees of an elimination tree over groups of about the same work.
/// \return group by supernode; kNone: the separator
std::vector<std::int32_t> partition(const SupernodeTree& tree) {
  std::vector<std::int32_t> group(tree.parent.size(), kNone);
  const double total = std::accumulate(tree.work.begin(), tree.work.end(), 0.0);
  if (total < kMinParallelEntries) return group;
  // Heaviest first, each to the group with the least work so far.
  std::array<double, kGroups> load{};
  for (const std::int32_t root : divideIntoSubtrees(tree)) {
    const auto least = std::min_element(load.begin(), load.end());
    *least += tree.subtreeWork[static_cast<std::size_t>(root)];
    group[static_cast<std::size_t>(root)] = static_cast<std::int32_t>(least - load.begin());
  }
  for (std::size_t k = group.size(); k-- > 0;) {  // descendants join the group of their root
    if (tree.parent[k] == kNone || group[k] != kNone) continue;
    group[k] = group[static_cast<std::size_t>(tree.parent[k])];
  }
  return group;
}

}  // namespace

/// The supernodes of a factor, their groups and their order in storage.
struct SupernodalSolver::Layout {
  explicit Layout(const SparseFactor& factor);

  std::vector<std::int32_t> firstColumn;  ///< of L, by supernode; n at the end
  std::vector<std::int32_t> group;        ///< by supernode; kNone: the separator
  std::vector<std::int32_t> order;        ///< supernodes, group by group, then the separator
  std::vector<std::int32_t> newColumn;    ///< by column of L: its index in the order of storage

 private:
  SupernodeTree tree(const SparseFactor& factor) const;
  void orderByGroup();
  void numberColumns(std::size_t columns);
};

SupernodalSolver::Layout::Layout(const SparseFactor& factor) {
  const auto n = static_cast<std::int32_t>(factor.size());
  for (std::int32_t column = 0; column < n; column += supernodeWidth(factor, column)) {
    firstColumn.push_back(column);
  }
  firstColumn.push_back(n);
  group = partition(tree(factor));
  orderByGroup();
  numberColumns(factor.size());
}

SupernodeTree SupernodalSolver::Layout::tree(const SparseFactor& factor) const {
  SupernodeTree tree;
  std::vector<std::int32_t> supernodeOf(factor.size());
  const std::size_t supernodes = firstColumn.size() - 1;
  for (std::size_t k = 0; k < supernodes; ++k) {
    const std::int32_t begin = firstColumn[k];
    const std::int32_t end = firstColumn[k + 1];
    std::fill(supernodeOf.begin() + begin, supernodeOf.begin() + end, static_cast<std::int32_t>(k));
    const double width = end - begin;
    tree.work.push_back(width * (width + factor.columns[static_cast<std::size_t>(end - 1)].count));
  }
  tree.subtreeWork = tree.work;
  for (std::size_t k = 0; k < supernodes; ++k) {
    const std::int32_t above = factor.parent(firstColumn[k + 1] - 1);
    const std::int32_t parent =
        above == kNone ? kNone : supernodeOf[static_cast<std::size_t>(above)];
    tree.parent.push_back(parent);
    if (parent != kNone) tree.subtreeWork[static_cast<std::size_t>(parent)] += tree.subtreeWork[k];
  }
  return tree;
}

/// Within a group, supernodes keep the order that they have in L.
void SupernodalSolver::Layout::orderByGroup() {
  order.resize(group.size());
  std::iota(order.begin(), order.end(), 0);
  const auto rank = [this](std::int32_t supernode) {
    const std::int32_t own = group[static_cast<std::size_t>(supernode)];
    return own == kNone ? static_cast<std::int32_t>(kGroups) : own;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return rank(a) < rank(b); });
}

void SupernodalSolver::Layout::numberColumns(std::size_t columns) {
  newColumn.resize(columns);
  std::int32_t next = 0;
  for (const std::int32_t k : order) {
    const auto supernode = static_cast<std::size_t>(k);
    for (std::int32_t column = firstColumn[supernode]; column < firstColumn[supernode + 1];
         ++column) {
      newColumn[static_cast<std::size_t>(column)] = next++;
    }
  }
}

void SupernodalSolver::build(const SparseFactor& factor,
                             const std::vector<std::int32_t>& permutation) {
  const Layout layout(factor);
  listGroups(layout);
  supernodes_.clear();
  row_.clear();
  value_.clear();
  for (const std::int32_t supernode : layout.order) addSupernode(factor, layout, supernode);
  inverseDiagonal_.resize(factor.size());
  for (std::size_t j = 0; j < factor.size(); ++j) {
    inverseDiagonal_[static_cast<std::size_t>(layout.newColumn[j])] =
        static_cast<float>(1.0 / factor.diagonal[j]);
  }
  permutation_.resize(permutation.size());
  std::transform(permutation.begin(), permutation.end(), permutation_.begin(),
                 [&](std::int32_t row) { return layout.newColumn[static_cast<std::size_t>(row)]; });
  work_.resize(factor.size());
}

/// Finds where each group and the separator begin and end in the order of storage.
void SupernodalSolver::listGroups(const Layout& layout) {
  groups_.clear();
  firstOfSeparator_ = 0;
  separatorRow_ = 0;
  for (const std::int32_t k : layout.order) {
    const auto supernode = static_cast<std::size_t>(k);
    const std::int32_t group = layout.group[supernode];
    if (group == kNone) break;
    groups_.resize(static_cast<std::size_t>(group) + 1,
                   SubtreeGroup{firstOfSeparator_, firstOfSeparator_, {}});
    groups_.back().end = ++firstOfSeparator_;
    separatorRow_ += layout.firstColumn[supernode + 1] - layout.firstColumn[supernode];
  }
  const std::size_t separatorSize =
      layout.newColumn.size() - static_cast<std::size_t>(separatorRow_);
  for (SubtreeGroup& group : groups_) group.contributionToSeparator.resize(separatorSize);
}

/// The rows below a supernode are those of its last column, which include the rows of all its other
/// columns. They are ancestors in the elimination tree, so they ascend in the new order too, and
/// those of the separator come last.
void SupernodalSolver::addSupernode(const SparseFactor& factor, const Layout& layout,
                                    std::int32_t supernode) {
  const auto k = static_cast<std::size_t>(supernode);
  const std::int32_t first = layout.firstColumn[k];
  const std::int32_t width = layout.firstColumn[k + 1] - first;
  const std::int32_t lastColumn = first + width - 1;
  const SparseFactor::Column& last = factor.columns[static_cast<std::size_t>(lastColumn)];
  Supernode added;
  added.first = layout.newColumn[static_cast<std::size_t>(first)];
  added.width = width;
  added.rows = last.count;
  added.row = row_.size();
  added.value = value_.size();
  const bool isSeparator = layout.group[k] == kNone;
  for (std::size_t entry = last.begin; entry < last.begin + last.count; ++entry) {
    row_.push_back(layout.newColumn[static_cast<std::size_t>(factor.row[entry])]);
    if (isSeparator || row_.back() < separatorRow_) ++added.groupRows;
  }
  value_.resize(value_.size() + static_cast<std::size_t>(width * (width + last.count)), 0.0F);
  copyBlock(factor, first, added);
  supernodes_.push_back(added);
}

/// Copies the entries of columns [first, first + width) of L to the block of a supernode.
void SupernodalSolver::copyBlock(const SparseFactor& factor, std::int32_t first,
                                 const Supernode& supernode) {
  const std::int32_t width = supernode.width;
  const std::int32_t lastColumn = first + width - 1;
  const SparseFactor::Column& last = factor.columns[static_cast<std::size_t>(lastColumn)];
  const std::int32_t* const rowsBelow = factor.row.data() + last.begin;
  float* const block = value_.data() + supernode.value;
  for (std::int32_t t = 0; t < width; ++t) {
    const std::int32_t j = first + t;
    const SparseFactor::Column& column = factor.columns[static_cast<std::size_t>(j)];
    std::int32_t below = 0;
    for (std::size_t k = column.begin; k < column.begin + column.count; ++k) {
      std::int32_t row = factor.row[k] - first;
      if (row >= width) {
        while (rowsBelow[below] != factor.row[k]) ++below;
        row = width + below;
      }
      block[row * width + t] = static_cast<float>(factor.value[k]);
    }
  }
}

struct SupernodalSolver::Kernels {
  /// The stored block of a supernode of width W.
  struct Block {
    const float* diagonal;    ///< unit lower triangle of L, W x W by rows
    const float* below;       ///< rows x W by rows
    const std::int32_t* row;  ///< row of L, by row below
    std::int32_t rows;
    std::int32_t groupRows;
  };

  /// Rows of the separator, of which a group sums up contributions.
  struct Separator {
    std::int32_t firstRow;
    Float4* contribution;  ///< by row from firstRow on
  };

  /// Solves L x = b for the columns of one supernode and subtracts L x from the rows below; rows of
  /// the separator get it as a contribution.
  /// \param x     b, then x, of the supernode's columns
  /// \param work  right-hand sides by row
  template <int kWidth>
  [[gnu::always_inline]] static inline void forward(const Block& block, Float4* x, Float4* work,
                                                    const Separator& separator) {
    Float4 known[kWidth];
    for (int t = 0; t < kWidth; ++t) {
      known[t] = x[t];
      for (int s = 0; s < t; ++s) known[t] -= block.diagonal[t * kWidth + s] * known[s];
      x[t] = known[t];
    }
    const float* p = block.below;
    const auto nextProduct = [&]() __attribute__((always_inline)) {
      Float4 sum = p[0] * known[0];
      for (int t = 1; t < kWidth; ++t) sum += p[t] * known[t];
      p += kWidth;
      return sum;
    };
    std::int32_t k = 0;
    for (; k < block.groupRows; ++k) work[block.row[k]] -= nextProduct();
    for (; k < block.rows; ++k) {
      separator.contribution[block.row[k] - separator.firstRow] += nextProduct();
    }
  }

  /// Solves D L^T x = b for the columns of one supernode, where x of the rows below is known.
  /// \param inverse  1 / D of the columns
  /// \param x        b, then x, of the supernode's columns
  template <int kWidth>
  [[gnu::always_inline]] static inline void backward(const Block& block, const float* inverse,
                                                     Float4* x, const Float4* work) {
    Float4 sum[kWidth];
    for (int t = 0; t < kWidth; ++t) sum[t] = inverse[t] * x[t];
    const float* p = block.below;
    for (std::int32_t k = 0; k < block.rows; ++k, p += kWidth) {
      const Float4 known = work[block.row[k]];
      for (int t = 0; t < kWidth; ++t) sum[t] -= p[t] * known;
    }
    for (int t = kWidth - 1; t >= 0; --t) {
      for (int s = t + 1; s < kWidth; ++s) sum[t] -= block.diagonal[s * kWidth + t] * sum[s];
      x[t] = sum[t];
    }
  }

  /// Calls `body` with the width as a compile-time constant.
  template <typename Body>
  [[gnu::always_inline]] static inline void withWidth(std::int32_t width, const Body& body) {
    switch (width) {
      case 1:
        return body(std::integral_constant<int, 1>());
      case 2:
        return body(std::integral_constant<int, 2>());
      case 3:
        return body(std::integral_constant<int, 3>());
      case 4:
        return body(std::integral_constant<int, 4>());
      case 5:
        return body(std::integral_constant<int, 5>());
      case 6:
        return body(std::integral_constant<int, 6>());
      case 7:
        return body(std::integral_constant<int, 7>());
      default:
        return body(std::integral_constant<int, kMaxWidth>());
    }
  }

  static Block block(const SupernodalSolver& solver, const Supernode& supernode) {
    const float* const diagonal = solver.value_.data() + supernode.value;
    return {diagonal, diagonal + supernode.width * supernode.width,
            solver.row_.data() + supernode.row, supernode.rows, supernode.groupRows};
  }

  /// Forward substitution for the supernodes [begin, end), in ascending order.
  CLOTH_SIM_VECTOR_CLONES
  static void forwardAll(const SupernodalSolver& solver, std::size_t begin, std::size_t end,
                         Float4* work, const Separator& separator) {
    for (std::size_t k = begin; k < end; ++k) {
      const Supernode& supernode = solver.supernodes_[k];
      withWidth(
          supernode.width, [&](auto width) __attribute__((always_inline)) {
            forward<decltype(width)::value>(block(solver, supernode), work + supernode.first, work,
                                            separator);
          });
    }
  }

  /// Backward substitution for the supernodes [begin, end), in descending order.
  CLOTH_SIM_VECTOR_CLONES
  static void backwardAll(const SupernodalSolver& solver, std::size_t begin, std::size_t end,
                          Float4* work) {
    for (std::size_t k = end; k-- > begin;) {
      const Supernode& supernode = solver.supernodes_[k];
      const float* const inverse = solver.inverseDiagonal_.data() + supernode.first;
      withWidth(
          supernode.width, [&](auto width) __attribute__((always_inline)) {
            backward<decltype(width)::value>(block(solver, supernode), inverse,
                                             work + supernode.first, work);
          });
    }
  }
};

void SupernodalSolver::substituteForward() {
  Float4* const work = work_.data();
  parallelForEach(groups_.size(), [&](std::size_t k) {
    SubtreeGroup& group = groups_[k];
    std::vector<Float4>& contribution = group.contributionToSeparator;
    std::fill(contribution.begin(), contribution.end(), Float4{});
    Kernels::forwardAll(*this, group.begin, group.end, work, {separatorRow_, contribution.data()});
  });
  for (const SubtreeGroup& group : groups_) {
    for (std::size_t k = 0; k < group.contributionToSeparator.size(); ++k) {
      work[separatorRow_ + k] -= group.contributionToSeparator[k];
    }
  }
  Kernels::forwardAll(*this, firstOfSeparator_, supernodes_.size(), work, {separatorRow_, nullptr});
}

void SupernodalSolver::substituteBackward() {
  Kernels::backwardAll(*this, firstOfSeparator_, supernodes_.size(), work_.data());
  parallelForEach(groups_.size(), [&](std::size_t k) {
    Kernels::backwardAll(*this, groups_[k].begin, groups_[k].end, work_.data());
  });
}

void SupernodalSolver::solve(const VectorArray& right, VectorArray& x) {
  forParts(work_.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      work_[static_cast<std::size_t>(permutation_[k])] =
          Float4{static_cast<float>(right.x[k]), static_cast<float>(right.y[k]),
                 static_cast<float>(right.z[k]), 0.0F};
    }
  });
  substituteForward();
  substituteBackward();
  x.resize(work_.size());
  forParts(work_.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const Float4 p = work_[static_cast<std::size_t>(permutation_[k])];
      x.x[k] = p[0];
      x.y[k] = p[1];
      x.z[k] = p[2];
    }
  });
}

}  // namespace cloth_sim
