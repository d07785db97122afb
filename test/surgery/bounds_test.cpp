/// \file Bounds on how far a cut may run from its stroke: docs/surgery.md states them.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "surgery/geometry.h"
#include "surgery/invariants.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace surgery_support;

constexpr int kSide = 33;                    ///< particles along a side of 1 m
constexpr double kCell = 1.0 / (kSide - 1);  ///< [m]

/// A flat cloth of 1 m (x = u, y = v) after one stroke along z.
class CutCloth {
 public:
  explicit CutCloth(const MaterialPath& line, Diagonals diagonals = Diagonals::kOneWay)
      : line_(line) {
    ClothSpec spec = clothOf(kSide, kSide, kCell, fabricPreset("interlock"));
    spec.diagonals = diagonals;
    Model model = buildModel(spec);
    State state = flatState(model);
    std::vector<Vec3> path;
    for (const Vec2& p : line) path.emplace_back(p.x(), p.y(), 0.0);
    CutPlan plan;
    plan.paths = findPaths(strokeAlong(path, Vec3(0.0, 0.0, -1.0), 1.0), model.mesh, state.x);
    const Totals before(model, state);
    result_ = cut(plan, usualLimits(model.mesh), {}, model, state);
    EXPECT_EQ(validateTotals(before, Totals(model, state)), "");
    EXPECT_EQ(validateMesh(model.mesh), "");
    edges_ = tornEdges(model.mesh);
    pieces_ = connectedComponents(model.mesh).count;
  }

  int pieces() const { return pieces_; }
  double reported() const { return result_.deviation / kCell; }  ///< [cells]

  /// Largest distance of a torn edge from the stroke [cells].
  double deviation() const {
    double farthest = 0.0;
    for (const TornEdge& edge : edges_) {
      for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const Vec2 at = edge.from + t * (edge.to - edge.from);
        farthest = std::max(farthest, distanceTo(line_, at));
      }
    }
    return farthest / kCell;
  }

  /// Largest distance of a point of the stroke that is on the cloth from a torn edge [cells].
  double gap() const {
    double largest = 0.0;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
      for (double t = 0.0; t <= 1.0; t += 0.01) {
        const Vec2 at = line_[k] + t * (line_[k + 1] - line_[k]);
        if (at.minCoeff() < 0.0 || at.maxCoeff() > 1.0) continue;
        double nearest = std::numeric_limits<double>::infinity();
        for (const TornEdge& edge : edges_) {
          nearest = std::min(nearest, distanceTo({edge.from, edge.to}, at));
        }
        largest = std::max(largest, nearest);
      }
    }
    return largest / kCell;
  }

 private:
  MaterialPath line_;
  SurgeryResult result_;
  std::vector<TornEdge> edges_;
  int pieces_ = 0;
};

/// 150 steps in random directions.
/// \param step  length [cells].
MaterialPath scribble(double step, Generator& random) {
  std::uniform_real_distribution<double> angle(0.0, 2.0 * M_PI);
  MaterialPath line{Vec2(0.5, 0.5)};
  for (int k = 0; k < 150; ++k) {
    const double a = angle(random);
    const Vec2 next = line.back() + step * kCell * Vec2(std::cos(a), std::sin(a));
    if (next.minCoeff() > 0.05 && next.maxCoeff() < 0.95) line.push_back(next);
  }
  return line;
}

class Scribble : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(StepInTenthsOfACell, Scribble, testing::Values(3.0, 7.0, 15.0, 30.0));

/// Half of the longest edge, a diagonal, is 0.71 of a cell. Where a stroke winds within faces that
/// it has cut already, the cut takes the way along edges that stays nearest: with the fewest edges
/// it was up to 1.44 cells off.
TEST_P(Scribble, StaysWithinThreeQuartersOfACell) {
  Generator random(11);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(k);
    const CutCloth cloth(scribble(0.1 * GetParam(), random),
                         k % 2 == 0 ? Diagonals::kOneWay : Diagonals::kAlternating);
    EXPECT_LE(cloth.deviation(), 0.75);
  }
}

/// A stroke along a border, by its distance in hundredths of a cell.
class AlongABorder : public testing::TestWithParam<int> {
 protected:
  /// \param side  0 to 3: of the cloth.
  static MaterialPath line(int side, double distance) {
    MaterialPath along{{-0.1, distance}, {1.1, distance}};
    for (Vec2& p : along) {
      if (side % 2 == 1) p.y() = 1.0 - p.y();
      if (side >= 2) std::swap(p.x(), p.y());
    }
    return along;
  }
};

INSTANTIATE_TEST_SUITE_P(HundredthsOfACell, AlongABorder, testing::Values(18, 25, 40, 60, 80, 95));

TEST_P(AlongABorder, AStrokeIsExact) {
  for (int side = 0; side < 4; ++side) {
    SCOPED_TRACE(side);
    const CutCloth cloth(line(side, 0.01 * GetParam() * kCell));
    EXPECT_EQ(cloth.pieces(), 2);
    EXPECT_LT(cloth.deviation(), 1e-9);
    EXPECT_LT(cloth.gap(), 1e-9);
  }
}

/// Nearer to a border, slivers of less than 5 degrees may come off: the cut bends to it then.
TEST_F(AlongABorder, AStrokeTooNearBendsToIt) {
  for (int side = 0; side < 4; ++side) {
    SCOPED_TRACE(side);
    const CutCloth cloth(line(side, 0.1 * kCell));
    EXPECT_LE(cloth.reported(), 0.18);
  }
}

/// A cut has corners only where it crosses edges and where its stroke turns by 15 degrees. Of a
/// curve of radius r it misses arcs over chords of at most a diagonal: c^2 / (8 r) each. Here
/// r = 1.62 cells or more, c^2 = 2 and the arcs are up to 0.155 of a cell high; where a vertex is
/// moved or bent to, a fifth of a diagonal comes on top.
TEST(Curve, IsFollowedWithoutAJog) {
  for (int k = 0; k < 10; ++k) {
    SCOPED_TRACE(k);
    MaterialPath line;
    for (double x = -0.1; x <= 1.1; x += 0.001) {
      line.emplace_back(x, 0.4 + 0.019 * k + kCell * std::sin(2.0 * M_PI * x / (8.0 * kCell)));
    }
    const CutCloth cloth(line);
    EXPECT_EQ(cloth.pieces(), 2);
    EXPECT_LE(cloth.deviation(), 0.155 + 0.2 * std::sqrt(2.0));
  }
}

}  // namespace
}  // namespace cloth_sim
