/// \file Cuts in several strokes, each of which begins where the one before ended.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "surgery/geometry.h"
#include "surgery/tear_line.h"

namespace cloth_sim {
namespace {

using namespace surgery_support;

constexpr int kStrokes = 12;
constexpr int kSegments = 8;             // of a stroke
constexpr int kStepsBetweenStrokes = 6;  // 0.1 s
constexpr double kEdge = 1.0 / 63.0;     // of a cell [m]

/// A cloth of 1 m as in config/scenes/cut.yaml: it hangs in y = 0 from its upper row.
Simulation hangingCloth(bool refines = false) {
  const std::string refinement = refines ? "refine_cuts: {radius: 0.016, generations: 2}" : "";
  return Simulation(parseScene(R"(
cloth:
  size: [1.0, 1.0]
  particles: [64, 64]
  pose: {position: [0.0, 0.0, 0.8], rpy: [1.5707963267948966, 0.0, 0.0]}
  fabric: {preset: cotton}
  pins: [last_row]
  surgery: {)" + refinement + R"(}
solver: {method: xpbd, dt: 0.0166666666666666667, substeps: 20}
drag: 0.5
)",
                               "joined_strokes.yaml"));
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

/// A line across the cloth, straight or a wave.
struct Line {
  double amplitude = 0.0;  ///< [m]
  /// The point that a part of the line, 0 ... 1, ends at [m].
  Vec3 operator()(double part) const {
    const double x = -0.55 + 1.1 * part;
    return {x, 0.0, 0.713 + amplitude * std::sin(2.0 * M_PI * x / 0.4)};
  }
};

/// A circle that lacks 0.3 edges of being closed.
Vec3 circle(double part) {
  const double angle = part * (2.0 * M_PI - 0.3 * kEdge / 0.2);
  return {0.2 * std::cos(angle), 0.0, 0.813 + 0.2 * std::sin(angle)};
}

template <typename Curve>
std::vector<Vec3> pointsOf(const Curve& curve, int firstStroke, int lastStroke) {
  std::vector<Vec3> points;
  for (int k = firstStroke * kSegments; k <= lastStroke * kSegments; ++k) {
    points.push_back(curve(k / static_cast<double>(kStrokes * kSegments)));
  }
  return points;
}

void cutAlong(const std::vector<Vec3>& points, Simulation& simulation) {
  const CommandResult result = simulation.apply(CutAlong{strokeAlong(points, Vec3::UnitY(), 0.5)});
  ASSERT_TRUE(result.success) << result.message;
}

template <typename Curve>
void cutInStrokes(const Curve& curve, int first, int last, int stepsBetween,
                  Simulation& simulation) {
  for (int k = first; k < last; ++k) {
    cutAlong(pointsOf(curve, k, k + 1), simulation);
    run(simulation, stepsBetween);
  }
}

int countTips(const TriangleMesh& mesh) {
  int count = 0;
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) count += isTip(mesh, v) ? 1 : 0;
  return count;
}

/// Amplitude of the line [m], and whether cuts are refined.
class JoinedStrokes : public testing::TestWithParam<std::tuple<double, bool>> {
 protected:
  /// Cuts at once and in strokes, and compares the areas of the pieces.
  static void compare(int stepsBetween, double tolerance) {
    const auto& [amplitude, refines] = GetParam();
    const Line line{amplitude};
    Simulation whole = hangingCloth(refines);
    run(whole, 60);
    cutAlong(pointsOf(line, 0, kStrokes), whole);
    Simulation joined = hangingCloth(refines);
    run(joined, 60);
    cutInStrokes(line, 0, kStrokes, stepsBetween, joined);
    const std::vector<double> expected = sortedAreas(whole.model().mesh);
    const std::vector<double> areas = sortedAreas(joined.model().mesh);
    ASSERT_EQ(expected.size(), 2U);
    ASSERT_EQ(areas.size(), 2U);
    EXPECT_NEAR(areas[0], expected[0], tolerance);
  }
};

INSTANTIATE_TEST_SUITE_P(Lines, JoinedStrokes,
                         testing::Combine(testing::Values(0.0, 0.05), testing::Bool()));

TEST_P(JoinedStrokes, OfClothAtRestCutWhatOneStrokeCuts) {
  // Where strokes join, the wave has corners that are no vertices of the whole cut: 11 of them, by
  // a tenth of a cell at most.
  compare(0, std::get<0>(GetParam()) == 0.0 ? 1e-9 : 0.1 * 11 * kEdge * kEdge);
}

TEST_P(JoinedStrokes, OfMovingClothSeparateIt) {
  // The part below the cut sags meanwhile, in the end by several cells: the cut lies higher, by
  // less than a cell on average.
  compare(kStepsBetweenStrokes, kEdge);
}

TEST(JoinedStrokesOfACircle, FreeADisc) {
  Simulation simulation = hangingCloth();
  cutInStrokes(circle, 0, kStrokes, 0, simulation);
  const std::vector<double> areas = sortedAreas(simulation.model().mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0], M_PI * 0.04, 0.005 * M_PI * 0.04);
  EXPECT_EQ(countTips(simulation.model().mesh), 0);
}

TEST(JoinedStrokesThatEndBesideTheBorder, CutWhatOneStrokeCuts) {
  // A cut that ends within half an edge of the border may bend to it, and the next stroke then
  // begins where there is no tip.
  for (const double height : {0.705, 0.713, 0.716}) {
    for (double inset = 0.02; inset < 1.2; inset += 0.09) {
      Simulation simulation = hangingCloth();
      const double end = 0.5 - inset * kEdge;
      const std::array<double, 4> places{-0.55, -end, end, 0.55};
      for (std::size_t k = 1; k < places.size(); ++k) {
        cutAlong({{places[k - 1], 0.0, height}, {places[k], 0.0, height}}, simulation);
      }
      const std::vector<double> areas = sortedAreas(simulation.model().mesh);
      ASSERT_EQ(areas.size(), 2U) << "inset " << inset << " at " << height;
      // The ends may bend by half an edge.
      EXPECT_NEAR(areas[0], height - 0.3, 2.0 * 0.5 * kEdge * kEdge) << inset << " at " << height;
    }
  }
}

TEST(JoinedStrokesOfASavedState, GoOn) {
  const Line line{0.05};
  Simulation straight = hangingCloth();
  cutInStrokes(line, 0, 9, kStepsBetweenStrokes, straight);
  Simulation restored = hangingCloth();
  restored.load(straight.save());
  for (Simulation* simulation : {&straight, &restored}) {
    cutInStrokes(line, 9, kStrokes, kStepsBetweenStrokes, *simulation);
  }
  EXPECT_EQ(straight.pieces(), 2);
  EXPECT_EQ(stateHash(restored.model(), restored.state()),
            stateHash(straight.model(), straight.state()));
}

TEST(OtherStrokes, JoinOnlyTipsWithinHalfAnEdge) {
  for (const auto& [gap, tips] : {std::pair(0.4, 2), std::pair(0.9, 4), std::pair(2.5, 4)}) {
    SCOPED_TRACE(gap);
    Simulation simulation = hangingCloth();
    cutAlong({{-0.3, 0.0, 0.813}, {-0.1, 0.0, 0.813}}, simulation);
    cutAlong({{-0.1 + gap * kEdge, 0.0, 0.813}, {0.1, 0.0, 0.813}}, simulation);
    EXPECT_EQ(countTips(simulation.model().mesh), tips);
    EXPECT_LT(nearestTo({0.6, 0.513}, simulation.model().mesh), 1e-9);
  }
}

TEST(OtherStrokes, ThatStayBehindATipCutNothing) {
  Simulation simulation = hangingCloth();
  cutAlong({{-0.3, 0.0, 0.813}, {-0.1, 0.0, 0.813}}, simulation);
  const std::uint64_t hash = stateHash(simulation.model(), simulation.state());
  const double beside = 0.813 + 0.3 * kEdge;
  cutAlong({{-0.1 - 0.2 * kEdge, 0.0, beside}, {-0.1 - 0.1 * kEdge, 0.0, beside}}, simulation);
  EXPECT_EQ(stateHash(simulation.model(), simulation.state()), hash);
}

}  // namespace
}  // namespace cloth_sim
