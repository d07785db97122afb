/// \file Cuts by strokes: pieces, position of the cut, and what stays unchanged.

#include <gtest/gtest.h>

#include <cmath>

#include "surgery/geometry.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace surgery_support;

/// A cloth of 1 m with 32 x 32 particles, flat (x = u, y = v) at first.
struct Cloth {
  explicit Cloth(int n = 32, Diagonals diagonals = Diagonals::kOneWay)
      : model(buildModel(specOf(n, diagonals))), state(flatState(model)) {}

  static ClothSpec specOf(int n, Diagonals diagonals) {
    ClothSpec spec = clothOf(n, n, 1.0 / (n - 1), fabricPreset("interlock"));
    spec.diagonals = diagonals;
    return spec;
  }

  /// Cuts through the cloth along z, along a line in x and y.
  SurgeryResult cutAlong(const std::vector<Vec2>& line, bool firstOnly = false,
                         const std::vector<VertexId>& held = {}) {
    std::vector<Vec3> path;
    for (const Vec2& p : line) path.emplace_back(p.x(), p.y(), 0.0);
    Stroke stroke = strokeAlong(path, Vec3(0.0, 0.0, -1.0), 1.0);
    stroke.firstLayerOnly = firstOnly;
    CutPlan plan;
    plan.paths = findPaths(stroke, model.mesh, state.x);
    const double area = preciseArea(model.mesh);
    const double mass = totalMass(model);
    const SurgeryResult result = cut(plan, usualLimits(model.mesh), held, model, state);
    EXPECT_EQ(validateMesh(model.mesh), "");
    EXPECT_NEAR(preciseArea(model.mesh), area, 1e-12 * area);
    EXPECT_NEAR(totalMass(model), mass, 1e-12 * mass);
    EXPECT_GE(smallestAngle(model.mesh), ShapeLimits{}.minAngle - 1e-9);
    return result;
  }

  int pieces() const { return connectedComponents(model.mesh).count; }

  Model model;
  State state;
};

std::vector<Vec2> polygon(const Vec2& middle, double radius, int corners) {
  std::vector<Vec2> points;
  for (int k = 0; k <= corners; ++k) {
    const double angle = 2.0 * M_PI * (k % corners) / corners + 0.1;
    points.push_back(middle + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return points;
}

// ---- on another division of the cells ---------------------------------------------------------

TEST(Cut, GoesThroughAlternatingDiagonals) {
  for (const double angle : {0.0, 0.3, M_PI / 4, 1.2, M_PI / 2, 2.0, 3 * M_PI / 4}) {
    SCOPED_TRACE(angle);
    Cloth cloth(16, Diagonals::kAlternating);
    const Vec2 middle(0.503, 0.497);
    const Vec2 reach = 2.0 * Vec2(std::cos(angle), std::sin(angle));
    cloth.cutAlong({middle - reach, middle + reach});
    EXPECT_EQ(cloth.pieces(), 2);
    cloth.cutAlong(polygon(middle, 0.2, 12));
    EXPECT_EQ(cloth.pieces(), 4);
  }
}

// ---- straight through --------------------------------------------------------------------------

class StraightCut : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Degrees, StraightCut,
                         testing::Values(0, 7, 20, 33, 45, 58, 72, 90, 101, 127, 135, 162));

TEST_P(StraightCut, LeavesTheTwoSidesOfItsLine) {
  const double angle = GetParam() * M_PI / 180.0;
  const Vec2 middle(0.517, 0.463), along(std::cos(angle), std::sin(angle));
  for (const bool hanging : {false, true}) {
    Cloth cloth;
    if (hanging) {
      // Turned out of the plane; the stroke goes along.
      const Quat turn(Eigen::AngleAxisd(0.4, Vec3(1.0, 0.0, 0.0)));
      for (Vec3& x : cloth.state.x) x = turn * x;
    }
    const double lean = hanging ? std::cos(0.4) : 1.0;  // how the cloth looks from above
    const auto seen = [&](const Vec2& p) { return Vec2(p.x(), lean * p.y()); };
    const SurgeryResult result =
        cloth.cutAlong({seen(middle - 1.5 * along), seen(middle + 1.5 * along)});
    EXPECT_LT(result.deviation, 1e-9);
    EXPECT_LT(farthestFrom({middle - 1.5 * along, middle + 1.5 * along}, cloth.model.mesh), 1e-9);
    const double left = areaLeftOf(rectangle(1.0, 1.0), middle, along);
    const std::vector<double> areas = sortedAreas(cloth.model.mesh);
    ASSERT_EQ(areas.size(), 2U);
    EXPECT_NEAR(areas[0], std::min(left, 1.0 - left), 1e-9);
    EXPECT_NEAR(areas[1], std::max(left, 1.0 - left), 1e-9);
    EXPECT_GT(result.events.size(), 31U);
  }
}

TEST(Cut, AlongARowOfEdgesOpensThem) {
  Cloth cloth(33);  // rows at multiples of 1/32: exact
  const SurgeryResult result = cloth.cutAlong({{-0.1, 0.25}, {1.1, 0.25}});
  EXPECT_EQ(cloth.model.particleCount(), 33 * 34) << "every vertex of the row twice, and no other";
  EXPECT_EQ(sortedAreas(cloth.model.mesh).size(), 2U);
  EXPECT_NEAR(sortedAreas(cloth.model.mesh)[0], 0.25, 1e-12);
  EXPECT_NEAR(result.length, 1.0, 1e-12);
}

TEST(Cut, ExactlyThroughVerticesOpensThere) {
  // Along the diagonals of the cells, and at a slope of a half: through every second vertex.
  for (const auto& [from, to, area] : {std::tuple(Vec2(0.0, 0.0), Vec2(1.0, 1.0), 0.5),
                                       std::tuple(Vec2(0.0, 0.25), Vec2(1.0, 0.75), 0.5),
                                       std::tuple(Vec2(0.0, 1.0), Vec2(1.0, 0.0), 0.5)}) {
    Cloth cloth(33);
    const Vec2 d = to - from;
    const SurgeryResult result = cloth.cutAlong({from - 0.1 * d, to + 0.1 * d});
    EXPECT_LT(farthestFrom({from, to}, cloth.model.mesh), 1e-9);
    ASSERT_EQ(cloth.pieces(), 2) << from.transpose() << " to " << to.transpose();
    EXPECT_NEAR(sortedAreas(cloth.model.mesh)[0], area, 1e-9);
    EXPECT_NEAR(result.length, d.norm(), 1e-9);
  }
}

// ---- shapes ------------------------------------------------------------------------------------

TEST(Cut, ACircleFreesADisc) {
  // Corners of 5.6 degrees are no corners of the cut: it is straight within a face. Chords of
  // length l take (l / r)^2 / 6 from a disc, and on average they are some two thirds of a cell
  // long.
  const double disc = 0.5 * 64 * std::sin(2.0 * M_PI / 64);
  for (const double radius : {0.1, 0.15, 0.21, 0.35}) {
    Cloth cloth;
    cloth.cutAlong(polygon({0.503, 0.492}, radius, 64));
    const std::vector<double> areas = sortedAreas(cloth.model.mesh);
    ASSERT_EQ(areas.size(), 2U) << radius;
    const double chord = 1.0 / 31.0 / radius;
    const double tolerance = radius > 0.2 ? 0.005 : chord * chord / 6.0;
    EXPECT_NEAR(areas[0], disc * radius * radius, tolerance * disc * radius * radius) << radius;
  }
}

TEST(Cut, AStrokeAroundACornerFreesWhatItGoesAround) {
  Cloth cloth;
  cloth.cutAlong({{-0.1, 0.283}, {0.337, 0.291}, {0.318, -0.1}});
  const std::vector<double> areas = sortedAreas(cloth.model.mesh);
  ASSERT_EQ(areas.size(), 2U);
  // Where the lines meet the borders, and the corner between.
  const double left = 0.283 + 0.1 * (0.291 - 0.283) / 0.437;
  const double foot = 0.337 - (0.291 / 0.391) * (0.337 - 0.318);
  const double expected = 0.5 * (foot * 0.291 + 0.337 * left);  // 0-foot-corner-left, shoelace
  EXPECT_NEAR(areas[0], expected, 1e-9);
}

TEST(Cut, AUOverABorderFreesATongue) {
  Cloth cloth;
  cloth.cutAlong({{0.303, -0.1}, {0.303, 0.417}, {0.688, 0.417}, {0.688, -0.1}});
  const std::vector<double> areas = sortedAreas(cloth.model.mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0], (0.688 - 0.303) * 0.417, 1e-9);
}

TEST(Cut, AFigureEightFreesTwoPieces) {
  // Two triangles that meet where the stroke crosses itself, at (0.5, 0.5).
  Cloth cloth;
  cloth.cutAlong({{0.213, 0.287}, {0.787, 0.713}, {0.787, 0.287}, {0.213, 0.713}, {0.213, 0.287}});
  const std::vector<double> areas = sortedAreas(cloth.model.mesh);
  ASSERT_EQ(areas.size(), 3U);
  const double triangle = 0.5 * (0.713 - 0.287) * 0.287;
  EXPECT_NEAR(areas[0], triangle, 0.005 * triangle);
  EXPECT_NEAR(areas[1], triangle, 0.005 * triangle);
}

// ---- ends inside -------------------------------------------------------------------------------

TEST(Cut, EndsWhereTheStrokeEnds) {
  const Vec2 from(0.3171, 0.4043), to(0.7129, 0.6127);
  Cloth cloth;
  const SurgeryResult result = cloth.cutAlong({from, to});
  EXPECT_EQ(cloth.pieces(), 1);
  EXPECT_NEAR(result.length, (to - from).norm(), 1e-9);
  EXPECT_LT(nearestTo(from, cloth.model.mesh), 1e-9);
  EXPECT_LT(nearestTo(to, cloth.model.mesh), 1e-9);
  EXPECT_LT(farthestFrom({from, to}, cloth.model.mesh), 1e-9);
  ASSERT_EQ(result.tips.size(), 2U);
  EXPECT_LT((cloth.model.mesh.material(result.tips[0]) - from).norm(), 1e-9);
  EXPECT_LT((cloth.model.mesh.material(result.tips[1]) - to).norm(), 1e-9);
}

TEST(Cut, FromTheBorderInEndsWhereTheStrokeEnds) {
  const Vec2 to(0.4127, 0.3871);
  Cloth cloth;
  cloth.cutAlong({{0.3, -0.1}, to});
  EXPECT_EQ(cloth.pieces(), 1);
  EXPECT_LT(nearestTo(to, cloth.model.mesh), 1e-9);
  // A second one from there on goes through.
  cloth.cutAlong({to, {0.5, 1.1}});
  EXPECT_EQ(cloth.pieces(), 2);
}

// ---- held particles, layers, strips -------------------------------------------------------------

TEST(Cut, ThroughHeldParticlesSeparatesAndMovesNoneOfThem) {
  Cloth cloth;
  std::vector<VertexId> held;
  for (int j = 12; j < 20; ++j) {
    for (int i = 12; i < 20; ++i) held.push_back(cloth.model.cloths[0].grid->vertex(i, j));
  }
  const State before = cloth.state;
  const std::vector<Vec2> rest = cloth.model.mesh.material();
  cloth.cutAlong({{-0.1, 0.461}, {1.1, 0.523}}, false, held);
  EXPECT_EQ(cloth.pieces(), 2);
  for (VertexId v : held) {
    EXPECT_EQ(cloth.state.x[v], before.x[v]);
    EXPECT_EQ(cloth.model.mesh.material(v), rest[v]);
  }
}

/// Cloth folded over the line u = 0.5: two layers 0.01 m apart, joined by a steep part.
Cloth folded() {
  Cloth cloth;
  for (Vec3& x : cloth.state.x) {
    if (x.x() > 0.5) x = Vec3(1.0 - x.x(), x.y(), 0.01);
  }
  return cloth;
}

TEST(Cut, OfTwoLayersCutsBothOrTheFirst) {
  // Across both layers, at 0.1 to 0.4 from the fold: two separate cuts, or one.
  const std::vector<Vec2> line{{0.113, 0.487}, {0.391, 0.513}};
  Cloth both = folded();
  EXPECT_EQ(both.cutAlong(line).tips.size(), 4U);
  Cloth first = folded();
  EXPECT_EQ(first.cutAlong(line, true).tips.size(), 2U);
  // The blade reaches upwards from its heel below or downwards from above: strokeAlong puts the
  // heel against the direction, so down means from above, and the upper layer (u > 0.5) is first.
  for (const TornEdge& edge : tornEdges(first.model.mesh)) EXPECT_GT(edge.from.x(), 0.5);
  bool lower = false;
  for (const TornEdge& edge : tornEdges(both.model.mesh)) lower = lower || edge.from.x() < 0.5;
  EXPECT_TRUE(lower);
}

/// Kind and ends at rest of each spring of a cloth, and how many of them are alike.
std::map<std::array<double, 5>, int> springsAtRest(const Model& model) {
  std::map<std::array<double, 5>, int> springs;
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    Vec2 a = model.mesh.material(spring.a);
    Vec2 b = model.mesh.material(spring.b);
    if (b.x() < a.x() || (b.x() == a.x() && b.y() < a.y())) std::swap(a, b);
    ++springs[{static_cast<double>(spring.kind), a.x(), a.y(), b.x(), b.y()}];
  }
  return springs;
}

TEST(CutOut, TakesFacesWithTheirSpringsAndReportsEachOnce) {
  // From the border in, so that some corners have faces of the rest on both sides of the strip.
  const std::vector<Vec2> line{{0.0, 0.513}, {0.8, 0.487}};
  const double halfWidth = 0.05;
  Cloth cloth;
  const SurgeryResult result = cloth.cutAlong(line);
  const std::vector<FaceId> strip = facesOfStrip(result.lines, halfWidth, {}, cloth.model.mesh);
  double area = 0.0;
  for (const FaceId f : strip) area += cloth.model.mesh.restArea(f);
  EXPECT_NEAR(area, 2.0 * halfWidth * 0.8, 0.2 * 2.0 * halfWidth * 0.8) << "as wide as it says";
  const double areaBefore = cloth.model.mesh.totalRestArea();
  auto springs = springsAtRest(cloth.model);
  const int before = cloth.model.springs.count();

  const SurgeryResult out = cutOut(strip, cloth.model, cloth.state);
  EXPECT_EQ(validateMesh(cloth.model.mesh), "");
  const int pieces = cloth.pieces();
  removeComponents(strip, cloth.model, cloth.state);
  EXPECT_EQ(validateMesh(cloth.model.mesh), "");
  EXPECT_LT(cloth.pieces(), pieces);
  EXPECT_EQ(cloth.pieces(), 1);
  EXPECT_NEAR(cloth.model.mesh.totalRestArea(), areaBefore - area, 1e-12);
  EXPECT_TRUE(facesOfStrip(result.lines, halfWidth, {}, cloth.model.mesh).empty());
  // The springs that were reported are those that are there no more.
  EXPECT_EQ(before - cloth.model.springs.count(), static_cast<int>(out.events.size()));
  for (const auto& [key, count] : springsAtRest(cloth.model)) {
    EXPECT_LE(count, springs[key]) << "a spring of the rest is new";
  }
}

TEST(CutOut, LeavesFacesWithHeldCorners) {
  Cloth cloth;
  const VertexId held = cloth.model.cloths[0].grid->vertex(16, 16);
  const SurgeryResult result = cloth.cutAlong({{0.2, 0.513}, {0.8, 0.487}}, false, {held});
  const std::vector<FaceId> all = facesOfStrip(result.lines, 0.1, {}, cloth.model.mesh);
  const std::vector<FaceId> strip = facesOfStrip(result.lines, 0.1, {held}, cloth.model.mesh);
  EXPECT_EQ(all.size() - strip.size(), cloth.model.mesh.facesAround(held).size());
}

TEST(CutOut, ThatWouldLeaveNothingIsRefused) {
  Cloth cloth;
  const std::uint64_t hash = stateHash(cloth.model, cloth.state);
  CutPlan plan;
  plan.paths = findPaths(strokeAlong({{-0.1, 0.4, 0.0}, {1.1, 0.6, 0.0}}, Vec3::UnitZ(), 1.0),
                         cloth.model.mesh, cloth.state.x);
  plan.stripHalfWidth = 1.0;
  const SurgeryLimits limits = usualLimits(cloth.model.mesh);
  EXPECT_THROW(cut(plan, limits, {}, cloth.model, cloth.state), OperationRefused);
  EXPECT_EQ(stateHash(cloth.model, cloth.state), hash);
}

// ---- nothing -----------------------------------------------------------------------------------

TEST(Cut, ThatMissesChangesNothing) {
  Cloth cloth;
  const std::uint64_t hash = stateHash(cloth.model, cloth.state);
  const SurgeryResult result = cloth.cutAlong({{1.2, -0.5}, {1.3, 1.5}});
  EXPECT_TRUE(result.changes.mesh.empty());
  EXPECT_TRUE(result.events.empty());
  EXPECT_EQ(result.length, 0.0);
  EXPECT_EQ(stateHash(cloth.model, cloth.state), hash);
}

TEST(Cut, ThatWouldMakeTooManyParticlesIsRefused) {
  Cloth cloth;
  const std::uint64_t hash = stateHash(cloth.model, cloth.state);
  const std::uint64_t revision = cloth.model.mesh.revision();
  SurgeryLimits limits = usualLimits(cloth.model.mesh);
  limits.maxParticles = cloth.model.particleCount() + 10;
  CutPlan plan;
  plan.paths = findPaths(strokeAlong({{-0.1, 0.4, 0.0}, {1.1, 0.6, 0.0}}, Vec3::UnitZ(), 1.0),
                         cloth.model.mesh, cloth.state.x);
  EXPECT_THROW(cut(plan, limits, {}, cloth.model, cloth.state), TooManyParticles);
  plan.refine = Refinement{0.05, 6, 0.0};
  limits.maxParticles = 2000;
  EXPECT_THROW(cut(plan, limits, {}, cloth.model, cloth.state), TooManyParticles);
  const RefineNear request{{Vec3(0.5, 0.5, 0.0)}, {0.3, 6, 0.0}};
  EXPECT_THROW(refine(request, limits, {}, cloth.model, cloth.state), TooManyParticles);
  EXPECT_EQ(stateHash(cloth.model, cloth.state), hash);
  EXPECT_EQ(cloth.model.mesh.revision(), revision);
}

}  // namespace
}  // namespace cloth_sim
