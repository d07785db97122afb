#include "panel_solver.h"

#include <algorithm>
#include <type_traits>

#include "cloth_sim/solver/vector_clones.h"

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

}  // namespace

void PanelSolver::build(const SparseFactor& factor, const std::vector<std::int32_t>& position) {
  panels_.clear();
  row_.clear();
  value_.clear();
  position_ = position;
  inverseDiagonal_.resize(factor.size());
  std::transform(factor.diagonal.begin(), factor.diagonal.end(), inverseDiagonal_.begin(),
                 [](double d) { return static_cast<float>(1.0 / d); });
  const auto n = static_cast<std::int32_t>(factor.size());
  for (std::int32_t first = 0; first < n; first += panels_.back().width) {
    add(factor, first, widthOfPanel(factor, first));
  }
  work_.resize(factor.size());
}

/// The rows below a panel are those of its last column: those of the others are among them.
void PanelSolver::add(const SparseFactor& factor, std::int32_t first, std::int32_t width) {
  const SparseFactor::Column& last = factor.columns[static_cast<std::size_t>(first + width - 1)];
  const auto rowsOf = factor.row.begin() + static_cast<std::ptrdiff_t>(last.begin);
  panels_.push_back({first, width, last.count, row_.size(), value_.size()});
  row_.insert(row_.end(), rowsOf, rowsOf + last.count);
  value_.resize(value_.size() + static_cast<std::size_t>(width * (width + last.count)), 0.0F);
  float* const values = value_.data() + panels_.back().value;
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

struct PanelSolver::Kernels {
  /// What a panel is made of: the square on its diagonal, the rows below.
  struct View {
    const float* square;
    const float* below;
    const std::int32_t* row;
    std::int32_t rows;
  };

  template <int W>
  [[gnu::always_inline]] static inline void forward(const View& panel, Float4* x, Float4* work) {
    Float4 known[W];
    for (int t = 0; t < W; ++t) {
      known[t] = x[t];
      for (int s = 0; s < t; ++s) known[t] -= panel.square[t * W + s] * known[s];
      x[t] = known[t];
    }
    const float* p = panel.below;
    for (std::int32_t k = 0; k < panel.rows; ++k, p += W) {
      Float4 sum = p[0] * known[0];
      for (int t = 1; t < W; ++t) sum += p[t] * known[t];
      work[panel.row[k]] -= sum;
    }
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

  static View view(const PanelSolver& solver, const Panel& panel) {
    const float* const square = solver.value_.data() + panel.value;
    return {square, square + panel.width * panel.width, solver.row_.data() + panel.row, panel.rows};
  }

  CLOTH_SIM_VECTOR_CLONES
  static void forwardAll(const PanelSolver& solver, Float4* work) {
    for (const Panel& panel : solver.panels_) {
      withWidth(
          panel.width, [&](auto width) __attribute__((always_inline)) {
            forward<decltype(width)::value>(view(solver, panel), work + panel.first, work);
          });
    }
  }

  CLOTH_SIM_VECTOR_CLONES
  static void backwardAll(const PanelSolver& solver, Float4* work) {
    for (auto panel = solver.panels_.rbegin(); panel != solver.panels_.rend(); ++panel) {
      const float* const inverse = solver.inverseDiagonal_.data() + panel->first;
      withWidth(
          panel->width, [&](auto width) __attribute__((always_inline)) {
            backward<decltype(width)::value>(view(solver, *panel), inverse, work + panel->first,
                                             work);
          });
    }
  }
};

void PanelSolver::solve(const PackedVectors& right, PackedVectors& x) {
  const std::size_t n = work_.size();
  for (std::size_t k = 0; k < n; ++k) {
    work_[static_cast<std::size_t>(position_[k])] =
        Float4{static_cast<float>(right.x[k]), static_cast<float>(right.y[k]),
               static_cast<float>(right.z[k]), 0.0F};
  }
  Kernels::forwardAll(*this, work_.data());
  Kernels::backwardAll(*this, work_.data());
  x.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Float4 p = work_[static_cast<std::size_t>(position_[k])];
    x.x[k] = p[0];
    x.y[k] = p[1];
    x.z[k] = p[2];
  }
}

}  // namespace cloth_sim
