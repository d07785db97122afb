#include "supernodal_solver.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <type_traits>

#include "support/vector_clones.h"
#include "vector_operations.h"

namespace cloth_sim {
namespace {

/// As many columns as vectors fit in the registers of the smallest instruction set.
constexpr std::int32_t kWidest = 8;
/// Entries of a panel that may be zeros that are not in L: this part of those that are, and some.
constexpr double kPadding = 0.3;
constexpr double kPaddingOfSmall = 16.0;

/// How many columns from `first` on make a panel.
std::int32_t widthOfPanel(const SparseFactor& factor, std::int32_t first) {
  const auto n = static_cast<std::int32_t>(factor.size());
  const auto countOf = [&](std::int32_t j) {
    return factor.columns[static_cast<std::size_t>(j)].count;
  };
  double entries = countOf(first);
  std::int32_t width = 1;
  while (width < kWidest && first + width < n &&
         factor.parent(first + width - 1) == first + width) {
    const std::int32_t last = first + width;
    entries += countOf(last);
    const double stored = 0.5 * width * (width + 1) + (width + 1.0) * countOf(last);
    if (stored > (1.0 + kPadding) * entries + kPaddingOfSmall) break;
    ++width;
  }
  return width;
}

/// L with fewer entries is solved by one thread.
constexpr double kLeastToShare = 1e5;
/// Groups of subtrees; more of them need a larger top.
constexpr std::size_t kGroups = 4;
/// A subtree with more than this part of the work of a group is divided, as long as the top does
/// not get more than its part of the whole.
constexpr double kLargestPiece = 0.8;
constexpr double kLargestTop = 0.25;

/// The parent of each panel in the elimination tree, or kNone, and its entries with all that is
/// below it.
struct PanelTree {
  std::vector<std::int32_t> parent;
  std::vector<double> own;
  std::vector<double> whole;
};

/// \return the group by panel; kNone for the top.
std::vector<std::int32_t> divide(const PanelTree& tree) {
  const std::size_t n = tree.parent.size();
  std::vector<std::int32_t> group(n, kNone);
  std::vector<std::vector<std::int32_t>> children(n);
  std::vector<std::int32_t> pieces;  // roots of subtrees that are not in the top; a heap
  double total = 0.0;
  for (std::size_t p = 0; p < n; ++p) {
    const auto panel = static_cast<std::int32_t>(p);
    total += tree.own[p];
    if (tree.parent[p] == kNone) {
      pieces.push_back(panel);
    } else {
      children[static_cast<std::size_t>(tree.parent[p])].push_back(panel);
    }
  }
  if (total < kLeastToShare) return group;
  const auto workOf = [&](std::int32_t p) { return tree.whole[static_cast<std::size_t>(p)]; };
  const auto isLess = [&](std::int32_t a, std::int32_t b) {
    return workOf(a) != workOf(b) ? workOf(a) < workOf(b) : a < b;
  };
  std::make_heap(pieces.begin(), pieces.end(), isLess);
  double top = 0.0;
  while (!pieces.empty() && workOf(pieces.front()) > kLargestPiece * total / kGroups &&
         top < kLargestTop * total) {
    std::pop_heap(pieces.begin(), pieces.end(), isLess);
    const auto root = static_cast<std::size_t>(pieces.back());
    pieces.pop_back();
    top += tree.own[root];
    for (const std::int32_t child : children[root]) {
      pieces.push_back(child);
      std::push_heap(pieces.begin(), pieces.end(), isLess);
    }
  }
  // The heaviest first, each to the group that has the least.
  std::sort(pieces.begin(), pieces.end(),
            [&](std::int32_t a, std::int32_t b) { return isLess(b, a); });
  std::array<double, kGroups> load{};
  for (const std::int32_t root : pieces) {
    const auto least = std::min_element(load.begin(), load.end());
    *least += workOf(root);
    group[static_cast<std::size_t>(root)] = static_cast<std::int32_t>(least - load.begin());
  }
  for (std::size_t p = n; p-- > 0;) {  // parents come after their children
    if (tree.parent[p] == kNone || group[p] != kNone) continue;
    group[p] = group[static_cast<std::size_t>(tree.parent[p])];
  }
  return group;
}

}  // namespace

/// How the columns of L are put into panels, and these in order.
struct SupernodalSolver::Layout {
  explicit Layout(const SparseFactor& factor);

  std::vector<std::int32_t> first;    ///< column of L, by panel; and the end
  std::vector<std::int32_t> group;    ///< by panel
  std::vector<std::int32_t> order;    ///< panels
  std::vector<std::int32_t> placeOf;  ///< by column of L

 private:
  PanelTree treeOf(const SparseFactor& factor) const;
};

SupernodalSolver::Layout::Layout(const SparseFactor& factor) {
  const auto n = static_cast<std::int32_t>(factor.size());
  for (std::int32_t column = 0; column < n; column += widthOfPanel(factor, column)) {
    first.push_back(column);
  }
  first.push_back(n);
  group = divide(treeOf(factor));
  order.resize(group.size());
  std::iota(order.begin(), order.end(), 0);
  const auto rank = [this](std::int32_t p) {
    const std::int32_t own = group[static_cast<std::size_t>(p)];
    return own == kNone ? static_cast<std::int32_t>(kGroups) : own;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return rank(a) < rank(b); });
  placeOf.resize(factor.size());
  std::int32_t place = 0;
  for (const std::int32_t p : order) {
    const auto panel = static_cast<std::size_t>(p);
    for (std::int32_t column = first[panel]; column < first[panel + 1]; ++column) {
      placeOf[static_cast<std::size_t>(column)] = place++;
    }
  }
}

PanelTree SupernodalSolver::Layout::treeOf(const SparseFactor& factor) const {
  PanelTree tree;
  std::vector<std::int32_t> panelOf(factor.size());
  for (std::size_t p = 0; p + 1 < first.size(); ++p) {
    const std::int32_t end = first[p + 1];
    std::fill(panelOf.begin() + first[p], panelOf.begin() + end, static_cast<std::int32_t>(p));
    const double width = end - first[p];
    tree.own.push_back(width * (width + factor.columns[static_cast<std::size_t>(end - 1)].count));
  }
  tree.whole = tree.own;
  for (std::size_t p = 0; p + 1 < first.size(); ++p) {
    const std::int32_t above = factor.parent(first[p + 1] - 1);
    tree.parent.push_back(above == kNone ? kNone : panelOf[static_cast<std::size_t>(above)]);
    if (above != kNone) tree.whole[static_cast<std::size_t>(tree.parent[p])] += tree.whole[p];
  }
  return tree;
}

void SupernodalSolver::build(const SparseFactor& factor,
                             const std::vector<std::int32_t>& position) {
  panels_.clear();
  row_.clear();
  value_.clear();
  groups_.clear();
  const Layout layout(factor);
  topRow_ = static_cast<std::int32_t>(factor.size());
  firstOfTop_ = layout.order.size();
  for (std::size_t k = 0; k < layout.order.size(); ++k) {
    const auto panel = static_cast<std::size_t>(layout.order[k]);
    const std::int32_t group = layout.group[panel];
    if (group == kNone && firstOfTop_ > k) {
      firstOfTop_ = k;
      topRow_ = layout.placeOf[static_cast<std::size_t>(layout.first[panel])];
    }
    if (group == kNone) break;
    groups_.resize(static_cast<std::size_t>(group) + 1, Group{k, k, {}});
    groups_.back().end = k + 1;
  }
  for (const std::int32_t panel : layout.order) add(factor, layout, panel);
  for (Group& group : groups_)
    group.toTop.resize(factor.size() - static_cast<std::size_t>(topRow_));
  inverseDiagonal_.resize(factor.size());
  for (std::size_t j = 0; j < factor.size(); ++j) {
    inverseDiagonal_[static_cast<std::size_t>(layout.placeOf[j])] =
        static_cast<float>(1.0 / factor.diagonal[j]);
  }
  position_.resize(position.size());
  std::transform(position.begin(), position.end(), position_.begin(), [&](std::int32_t column) {
    return layout.placeOf[static_cast<std::size_t>(column)];
  });
  work_.resize(factor.size());
}

/// The rows below a panel are those of its last column: those of the others are among them. They
/// are its ancestors in the tree, so they are ascending in the new order as in the old one.
void SupernodalSolver::add(const SparseFactor& factor, const Layout& layout, std::int32_t panel) {
  const std::int32_t first = layout.first[static_cast<std::size_t>(panel)];
  const std::int32_t width = layout.first[static_cast<std::size_t>(panel) + 1] - first;
  const SparseFactor::Column& last = factor.columns[static_cast<std::size_t>(first + width - 1)];
  const auto rowsOf = factor.row.begin() + static_cast<std::ptrdiff_t>(last.begin);
  Panel added{layout.placeOf[static_cast<std::size_t>(first)],
              width,
              last.count,
              0,
              row_.size(),
              value_.size()};
  const bool isTop = layout.group[static_cast<std::size_t>(panel)] == kNone;
  for (std::int32_t k = 0; k < last.count; ++k) {
    row_.push_back(layout.placeOf[static_cast<std::size_t>(rowsOf[k])]);
    if (isTop || row_.back() < topRow_) ++added.ownRows;
  }
  panels_.push_back(added);
  value_.resize(value_.size() + static_cast<std::size_t>(width * (width + last.count)), 0.0F);
  float* const values = value_.data() + added.value;
  for (std::int32_t t = 0; t < width; ++t) {
    const SparseFactor::Column& column = factor.columns[static_cast<std::size_t>(first + t)];
    std::int32_t below = 0;
    for (std::size_t k = column.begin; k < column.begin + column.count; ++k) {
      std::int32_t row = factor.row[k] - first;
      if (row >= width) {
        while (rowsOf[below] != factor.row[k]) ++below;
        row = width + below;
      }
      values[row * width + t] = static_cast<float>(factor.value[k]);
    }
  }
}

struct SupernodalSolver::Kernels {
  /// What a panel is made of: the square on its diagonal, the rows below.
  struct View {
    const float* square;
    const float* below;
    const std::int32_t* row;
    std::int32_t rows;
    std::int32_t ownRows;
  };

  /// \param toTop  what is taken from a row of the top is added there, at the row.
  template <int W>
  [[gnu::always_inline]] static inline void forward(const View& panel, Float4* x, Float4* work,
                                                    Float4* toTop) {
    Float4 known[W];
    for (int t = 0; t < W; ++t) {
      known[t] = x[t];
      for (int s = 0; s < t; ++s) known[t] -= panel.square[t * W + s] * known[s];
      x[t] = known[t];
    }
    const float* p = panel.below;
    const auto next = [&]() __attribute__((always_inline)) {
      Float4 sum = p[0] * known[0];
      for (int t = 1; t < W; ++t) sum += p[t] * known[t];
      p += W;
      return sum;
    };
    std::int32_t k = 0;
    for (; k < panel.ownRows; ++k) work[panel.row[k]] -= next();
    for (; k < panel.rows; ++k) toTop[panel.row[k]] += next();
  }

  template <int W>
  [[gnu::always_inline]] static inline void backward(const View& panel, const float* inverse,
                                                     Float4* x, const Float4* work) {
    Float4 sum[W];
    for (int t = 0; t < W; ++t) sum[t] = inverse[t] * x[t];
    const float* p = panel.below;
    for (std::int32_t k = 0; k < panel.rows; ++k, p += W) {
      const Float4 known = work[panel.row[k]];
      for (int t = 0; t < W; ++t) sum[t] -= p[t] * known;
    }
    for (int t = W - 1; t >= 0; --t) {
      for (int s = t + 1; s < W; ++s) sum[t] -= panel.square[s * W + t] * sum[s];
      x[t] = sum[t];
    }
  }

  /// Calls `body` with the width as a constant.
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
        return body(std::integral_constant<int, kWidest>());
    }
  }

  static View view(const SupernodalSolver& solver, const Panel& panel) {
    const float* const square = solver.value_.data() + panel.value;
    return {square, square + panel.width * panel.width, solver.row_.data() + panel.row, panel.rows,
            panel.ownRows};
  }

  /// Panels [begin, end).
  CLOTH_SIM_VECTOR_CLONES
  static void forwardAll(const SupernodalSolver& solver, std::size_t begin, std::size_t end,
                         Float4* work, Float4* toTop) {
    for (std::size_t k = begin; k < end; ++k) {
      const Panel& panel = solver.panels_[k];
      withWidth(
          panel.width, [&](auto width) __attribute__((always_inline)) {
            forward<decltype(width)::value>(view(solver, panel), work + panel.first, work, toTop);
          });
    }
  }

  CLOTH_SIM_VECTOR_CLONES
  static void backwardAll(const SupernodalSolver& solver, std::size_t begin, std::size_t end,
                          Float4* work) {
    for (std::size_t k = end; k-- > begin;) {
      const Panel& panel = solver.panels_[k];
      const float* const inverse = solver.inverseDiagonal_.data() + panel.first;
      withWidth(
          panel.width, [&](auto width) __attribute__((always_inline)) {
            backward<decltype(width)::value>(view(solver, panel), inverse, work + panel.first,
                                             work);
          });
    }
  }
};

void SupernodalSolver::forward() {
  Float4* const work = work_.data();
  parallelForEach(groups_.size(), [&](std::size_t k) {
    Group& group = groups_[k];
    std::fill(group.toTop.begin(), group.toTop.end(), Float4{});
    Kernels::forwardAll(*this, group.begin, group.end, work, group.toTop.data() - topRow_);
  });
  for (const Group& group : groups_) {
    for (std::size_t k = 0; k < group.toTop.size(); ++k) work[topRow_ + k] -= group.toTop[k];
  }
  Kernels::forwardAll(*this, firstOfTop_, panels_.size(), work, nullptr);
}

void SupernodalSolver::backward() {
  Kernels::backwardAll(*this, firstOfTop_, panels_.size(), work_.data());
  parallelForEach(groups_.size(), [&](std::size_t k) {
    Kernels::backwardAll(*this, groups_[k].begin, groups_[k].end, work_.data());
  });
}

void SupernodalSolver::solve(const VectorArray& right, VectorArray& x) {
  forParts(work_.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      work_[static_cast<std::size_t>(position_[k])] =
          Float4{static_cast<float>(right.x[k]), static_cast<float>(right.y[k]),
                 static_cast<float>(right.z[k]), 0.0F};
    }
  });
  forward();
  backward();
  x.resize(work_.size());
  forParts(work_.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const Float4 p = work_[static_cast<std::size_t>(position_[k])];
      x.x[k] = p[0];
      x.y[k] = p[1];
      x.z[k] = p[2];
    }
  });
}

}  // namespace cloth_sim
