#pragma once
/// \file Boxes around parts of the cloth, balls around their gradients, and the proof that a part
/// does not touch itself.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// An axis-aligned box in the world [m]; empty by default.
struct Box {
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);

  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  bool contains(const Vec3& p) const {
    return (low.array() <= p.array()).all() && (p.array() <= high.array()).all();
  }
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// A box for quick tests: of single precision, never smaller than what it stands for.
struct QuickBox {
  /// x, y, z and 0.
  using Corner = float __attribute__((vector_size(16)));

  Corner low = Corner{} + 1e30F;
  Corner high = Corner{} - 1e30F;

  QuickBox() = default;
  explicit QuickBox(const Box& box) {
    constexpr double kRounding = 1e-7;  // above half of a unit in the last place of a float
    low[3] = high[3] = 0.0F;
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<float>(box.low[k] - kRounding * std::abs(box.low[k]));
      high[k] = static_cast<float>(box.high[k] + kRounding * std::abs(box.high[k]));
    }
  }
  void add(const QuickBox& other) {
    low = low < other.low ? low : other.low;
    high = high > other.high ? high : other.high;
  }
  bool meets(const QuickBox& other) const {
    const auto meet = (low <= other.high) & (other.low <= high);
    return (meet[0] & meet[1] & meet[2]) != 0;
  }
};

/// A deformation gradient, (3, 2): derivatives of the position by the two material coordinates.
struct Gradient {
  Vec3 u = Vec3::Zero();
  Vec3 v = Vec3::Zero();

  /// Edges of a triangle in the world, multiplied by the inverse of its edges at rest (2, 2).
  static Gradient of(const Vec3& first, const Vec3& second, const Eigen::Matrix2d& inverseRest) {
    return {inverseRest(0, 0) * first + inverseRest(1, 0) * second,
            inverseRest(0, 1) * first + inverseRest(1, 1) * second};
  }
  /// Frobenius norm.
  double norm() const { return std::sqrt(u.squaredNorm() + v.squaredNorm()); }
  Gradient operator-(const Gradient& other) const { return {u - other.u, v - other.v}; }
};

/// A ball in the space of deformation gradients, by the Frobenius norm.
///
/// If the gradients of all faces of a convex part of the material plane lie in a ball around G with
/// a radius below the smaller singular value of G, that part does not intersect itself: for two of
/// its points u and w, x(u) - x(w) is the integral of the gradient along the segment between them,
/// and so at least (sigma - radius) |u - w| long.
struct GradientBall {
  Gradient centre;
  double radius = -1.0;  ///< below 0: no gradients; infinite: nothing is known

  static GradientBall unknown();
  bool isEmpty() const { return radius < 0.0; }
  /// Grows to the least ball that contains both.
  void add(const GradientBall& other);
  /// Tells whether a convex part of the material plane with these gradients cannot intersect
  /// itself.
  bool provesInjective() const;
};

/// The place of a node in a tree over the material plane.
struct Place {
  int level = 0;  ///< 0: buckets
  int i = 0;      ///< column
  int j = 0;      ///< row
};

/// Calls `visit(columns, rows)` for the levels of a tree over the material plane, that of the
/// smallest nodes first. The last one has a single node.
template <typename Visit>
void forLevels(int columns, int rows, const Visit& visit) {
  visit(columns, rows);
  while (columns > 1 || rows > 1) {
    columns = (columns + 1) / 2;
    rows = (rows + 1) / 2;
    visit(columns, rows);
  }
}

/// Nodes of one size: rectangles of the material plane of a cloth, (columns * rows,), row by row.
/// Each knows a box around its faces in the world, and a ball around the gradients in it.
class MaterialLevel {
 public:
  int columns = 0;
  int rows = 0;
  std::vector<QuickBox> boxes;      ///< by node
  std::vector<GradientBall> balls;  ///< by node

  void resize(int newColumns, int newRows);
  std::int32_t count() const { return static_cast<std::int32_t>(boxes.size()); }
  int node(int i, int j) const { return j * columns + i; }
  Place placeOf(int level, std::int32_t node) const {
    return {level, node % columns, node / columns};
  }
  /// Lists the nodes of this level, one to four, that a node of the next larger ones consists of.
  /// \return their number.
  int partsOf(const Place& larger, std::array<Place, 4>& out) const;
  /// Joins the boxes and the balls of the parts of a node. \param below  level of the parts.
  void join(const MaterialLevel& below, std::int32_t node);

  /// Forgets what `isSmooth` has found.
  void forgetProofs();
  /// Doubts what it has found of squares with a node that has changed.
  void doubtProofs(std::int32_t node);
  /// Looks again at the doubted squares with a node that has changed. Calls `lose(node)` with the
  /// first node of each that is not proven any more.
  template <typename Lose>
  void settleDoubts(std::int32_t node, const Lose& lose) {
    forSquaresWith(node, [&](int i, int j) {
      const int square = this->node(i, j);
      if (squares_[square] == Proof::kDoubted && !isSquareProven(i, j)) lose(square);
    });
  }
  /// Tells whether two nodes are neighbours, or the same, in a rectangle that is proven not to
  /// touch itself. Threads may ask at the same time.
  bool isSmooth(const Place& a, const Place& b) const;
  /// The same with other balls. \param ballAt  ball of gradients of the node (i, j).
  template <typename Ball>
  static bool isProven(const Place& a, const Place& b, const Ball& ballAt) {
    if (!areNeighbours(a, b)) return false;
    GradientBall ball;
    for (int j = std::min(a.j, b.j); j <= std::max(a.j, b.j); ++j) {
      for (int i = std::min(a.i, b.i); i <= std::max(a.i, b.i); ++i) {
        const GradientBall& part = ballAt(i, j);
        if (part.isEmpty()) return false;
        ball.add(part);
      }
    }
    return ball.provesInjective();
  }
  /// Tells whether two nodes are neighbours or the same.
  static bool areNeighbours(const Place& a, const Place& b) {
    return std::abs(a.i - b.i) <= 1 && std::abs(a.j - b.j) <= 1;
  }
  /// Tells whether `is(i, j)` for the first node of a square of 2 x 2 nodes that contains two
  /// neighbours.
  template <typename Is>
  bool anySquareAround(const Place& a, const Place& b, const Is& is) const {
    for (int j = std::max(0, std::max(a.j, b.j) - 1); j <= std::min(a.j, b.j); ++j) {
      for (int i = std::max(0, std::max(a.i, b.i) - 1); i <= std::min(a.i, b.i); ++i) {
        if (is(i, j)) return true;
      }
    }
    return false;
  }

 private:
  /// Tells whether a part of the material plane is proven not to touch itself.
  enum class Proof : std::uint8_t {
    kUnknown,
    kDoubted,  ///< it was proven before a part of it changed
    kYes,
    kNo,
  };

  /// Calls `visit(i, j)` for the first nodes of the squares of 2 x 2 nodes with a node.
  template <typename Visit>
  void forSquaresWith(std::int32_t node, const Visit& visit) const {
    const int i = node % columns;
    const int j = node / columns;
    for (int row = std::max(0, j - 1); row <= j; ++row) {
      for (int column = std::max(0, i - 1); column <= i; ++column) visit(column, row);
    }
  }
  bool isSquareProven(int i, int j) const;

  /// By node: whether the square of 2 x 2 nodes from it on is proven; found when asked for.
  mutable std::vector<Proof> squares_;
};

}  // namespace cloth_sim
