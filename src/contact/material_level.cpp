#include "material_level.h"

#include <limits>

namespace cloth_sim {
namespace {

/// Tells whether both singular values of a gradient are above `least`, >= 0: if the Gram matrix of
/// its columns is positive definite after that much is taken from its eigenvalues.
bool isStretchAbove(const Gradient& g, double least) {
  const double uu = g.u.squaredNorm() - least * least;
  const double vv = g.v.squaredNorm() - least * least;
  const double uv = g.u.dot(g.v);
  return uu > 0.0 && vv > 0.0 && uu * vv > uv * uv;
}

}  // namespace

GradientBall GradientBall::unknown() {
  GradientBall ball;
  ball.radius = std::numeric_limits<double>::infinity();
  return ball;
}

void GradientBall::add(const GradientBall& other) {
  if (other.isEmpty()) return;
  if (isEmpty()) {
    *this = other;
    return;
  }
  if (!std::isfinite(radius)) return;
  if (!std::isfinite(other.radius)) {
    *this = other;
    return;
  }
  const Gradient to = other.centre - centre;
  const double apart = to.norm();
  if (apart + other.radius <= radius) return;
  if (apart + radius <= other.radius) {
    *this = other;
    return;
  }
  const double grown = 0.5 * (apart + radius + other.radius);
  const double fraction = (grown - radius) / apart;
  centre.u += fraction * to.u;
  centre.v += fraction * to.v;
  radius = grown;
}

bool GradientBall::provesInjective() const {
  constexpr double kMargin = 1e-3;  // far above round-off
  return !isEmpty() && std::isfinite(radius) && isStretchAbove(centre, radius + kMargin);
}

void MaterialLevel::resize(int newColumns, int newRows) {
  columns = newColumns;
  rows = newRows;
  const std::size_t nodes = static_cast<std::size_t>(columns) * rows;
  boxes.resize(nodes);
  balls.resize(nodes);
  squares_.resize(nodes);
}

int MaterialLevel::partsOf(const Place& larger, std::array<Place, 4>& out) const {
  int parts = 0;
  for (int j = 2 * larger.j; j < std::min(2 * larger.j + 2, rows); ++j) {
    for (int i = 2 * larger.i; i < std::min(2 * larger.i + 2, columns); ++i) {
      out[parts++] = {larger.level - 1, i, j};
    }
  }
  return parts;
}

void MaterialLevel::join(const MaterialLevel& below, std::int32_t node) {
  std::array<Place, 4> parts;
  const int number = below.partsOf(placeOf(0, node), parts);
  QuickBox box;
  GradientBall ball;
  for (int k = 0; k < number; ++k) {
    const int part = below.node(parts[k].i, parts[k].j);
    box.add(below.boxes[part]);
    // A part of the plane without cloth is not known to be crossed by gradients.
    ball.add(below.balls[part].isEmpty() ? GradientBall::unknown() : below.balls[part]);
  }
  boxes[node] = box;
  balls[node] = ball;
}

void MaterialLevel::forgetProofs() { std::fill(squares_.begin(), squares_.end(), Proof::kUnknown); }

void MaterialLevel::doubtProofs(std::int32_t node) {
  forSquaresWith(node, [this](int i, int j) {
    Proof& proof = squares_[this->node(i, j)];
    if (proof == Proof::kYes) proof = Proof::kDoubted;
    if (proof == Proof::kNo) proof = Proof::kUnknown;
  });
}

/// Pairs of neighbours lie in one or two squares of 2 x 2 nodes, a node in four. Squares are asked
/// first, because each answers for many pairs.
bool MaterialLevel::isSmooth(const Place& a, const Place& b) const {
  if (!areNeighbours(a, b)) return false;
  if (anySquareAround(a, b, [this](int i, int j) { return isSquareProven(i, j); })) return true;
  if (a.i != b.i && a.j != b.j) return false;  // their rectangle is a square
  return isProven(a, b, [this](int i, int j) -> const GradientBall& { return balls[node(i, j)]; });
}

/// Tells whether the square of 2 x 2 nodes from (i, j) on, as far as there are nodes, is proven.
bool MaterialLevel::isSquareProven(int i, int j) const {
  // Threads may find the same answer at once.
  Proof& known = squares_[node(i, j)];
  Proof proof = Proof::kUnknown;
  __atomic_load(&known, &proof, __ATOMIC_RELAXED);
  if (proof == Proof::kUnknown || proof == Proof::kDoubted) {
    const Place from{0, i, j};
    const Place to{0, std::min(i + 1, columns - 1), std::min(j + 1, rows - 1)};
    const auto ballAt = [this](int column, int row) -> const GradientBall& {
      return balls[node(column, row)];
    };
    proof = isProven(from, to, ballAt) ? Proof::kYes : Proof::kNo;
    __atomic_store(&known, &proof, __ATOMIC_RELAXED);
  }
  return proof == Proof::kYes;
}

}  // namespace cloth_sim
