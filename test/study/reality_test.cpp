/// \file Comparisons with theory and measured cloth, in fast versions.

#include "study/reality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "study/reality_bending.h"
#include "study/reality_disc.h"
#include "study/reality_drape.h"
#include "study/reality_elastica.h"
#include "study/reality_fling.h"
#include "study/reality_motion.h"
#include "study/reality_pull.h"

namespace cloth_sim {
namespace {

const BendingFabric& bendingFabric(const std::string& name) {
  for (const BendingFabric& fabric : bendingFabrics()) {
    if (fabric.name == name) return fabric;
  }
  throw std::invalid_argument(name);
}

TEST(RealityElastica, KnowsSmallDeflectionsAndPeircesAngle) {
  // A short overhang s drops by s^4 / 8 (lengths over l), the chord by s^3 / 8.
  EXPECT_NEAR(cantileverChord(0.1) / (1e-3 / 8.0), 1.0, 1e-4);
  // ASTM D1388: 41.5 degrees at twice the bending length, to the 0.02 % that shooting finds.
  EXPECT_NEAR(cantileverOverhang(41.5 * M_PI / 180.0), 2.0, 1e-3);
}

TEST(RealityElastica, TheSoftFoldBalancesItsFirstIntegral) {
  // Over its top, theta = pi, and half of the curvature squared is the height: the integration from
  // the table finds the same height whatever its step is. The constant agrees with a Runge-Kutta
  // integration in Python to the digits given.
  const SoftFold fold = findSoftFold();
  EXPECT_NEAR(fold.height, 0.9066, 5e-4);
  EXPECT_NEAR(fold.reaction, 3.745, 5e-3);
}

TEST(Reality, ACantileverHangsLikeTheElastica) {
  const BendingFabric& cotton = bendingFabric("preset cotton");
  const double length = elastoGravityLength(cotton.bending, cotton.density);
  EXPECT_NEAR(simulatedOverhang(cotton, 3e-3) / (2.0 * length), 1.0, 0.02);
  // A fabric eight times as stiff hangs over twice as far.
  BendingFabric stiffer = cotton;
  stiffer.bending *= 8.0;
  EXPECT_NEAR(simulatedOverhang(stiffer, 3e-3) / simulatedOverhang(cotton, 3e-3), 2.0, 0.02);
}

TEST(Reality, ASoftFoldIsAsHighAsTheElastica) {
  const BendingFabric& cotton = bendingFabric("preset cotton");
  const double length = elastoGravityLength(cotton.bending, cotton.density);
  EXPECT_NEAR(simulatedFoldHeight(cotton, 3e-3) / length, findSoftFold().height, 0.03);
}

TEST(RealityDisc, IsADiscOfEvenTriangles) {
  const double h = 0.01, radius = 0.15;
  for (const double turn : {0.0, 0.5}) {
    const ClothMesh disc = makeDisc(radius, 0.09, h, turn);
    const TriangleMesh mesh(disc.material, disc.faces);
    EXPECT_EQ(validationError(mesh), "");
    double area = 0.0, least = 1.0;
    std::set<double> radii;
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      area += mesh.restArea(f);
      least = std::min(least, mesh.restArea(f));
    }
    // The border is a polygon: it lacks (2 pi / n)^2 / 6 of the area, n = 94 sides.
    EXPECT_NEAR(area / (M_PI * radius * radius), 1.0, 1e-3);
    EXPECT_GT(least, 0.5 * std::sqrt(3.0) / 4.0 * h * h);
    // Euler: one piece without holes.
    std::size_t border = 0;
    for (VertexId v = 0; v < mesh.vertexCount(); ++v) border += mesh.isBoundary(v) ? 1 : 0;
    EXPECT_EQ(mesh.faceCount(), 2 * mesh.vertexCount() - 2 - static_cast<std::int32_t>(border));
  }
}

TEST(RealityDisc, CastsItsAreaAsShadow) {
  const ClothMesh disc = makeDisc(0.15, 0.09, 0.02, 0.0);
  EXPECT_NEAR(shadowArea(disc.faces, disc.positions, 0.16, 400) / (M_PI * 0.0225), 1.0, 5e-3);
  std::vector<Vec3> upright = disc.positions;
  for (Vec3& x : upright) std::swap(x.y(), x.z());
  EXPECT_LT(shadowArea(disc.faces, upright, 0.16, 400), 1e-3);
}

TEST(RealityDrape, FoldsAreCounted) {
  std::vector<Vec2> rim;
  for (int k = 0; k < 200; ++k) {
    const double angle = 2.0 * M_PI * k / 200;
    const double r = 0.13 + 0.01 * std::cos(6 * angle) + 1e-4 * std::cos(60 * angle);
    rim.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  EXPECT_EQ(countFolds(rim), 6);
}

TEST(RealityDrape, StifferClothDrapesLess) {
  const DrapeMesh coarse{0.015, 0.0};
  const Drape limp = simulateDrape({"limp", 5e-6, 0.12, 25.0}, coarse, 6);
  const Drape stiff = simulateDrape({"stiff", 50e-6, 0.12, 25.0}, coarse, 6);
  EXPECT_TRUE(limp.isAtRest);
  EXPECT_TRUE(stiff.isAtRest);
  EXPECT_GT(limp.coefficient, 20.0);
  EXPECT_GT(stiff.coefficient, limp.coefficient + 10.0);
  EXPECT_LT(stiff.coefficient, 100.0);
}

TEST(RealityPull, FitsAndModelAgreeWhereTheFabricIsLinear) {
  // The denim's fit is almost linear, and the preset was made from it: small strains agree to the
  // squares of the strain that the fit and springs count differently, and to C12.
  for (const StretchFit& fit : stretchFits()) {
    if (fit.preset != "denim") continue;
    EXPECT_NEAR(
        simulatedPull("denim", PullKind::kWarp, 0.02) / fittedPull(fit, PullKind::kWarp, 0.02), 1.0,
        0.05);
  }
}

TEST(RealityFling, GrippersFollowTheProtocol) {
  EXPECT_NEAR(flingDuration(), 4.4, 1e-12);
  EXPECT_TRUE(flingDisplacement(1.1).isApprox(Vec3(0.0, -0.25, 0.06), 1e-12));
  EXPECT_TRUE(flingDisplacement(2.6).isApprox(Vec3(0.0, 0.05, 0.12), 1e-12));
  EXPECT_TRUE(flingDisplacement(9.0).isApprox(Vec3(0.0, 0.10, -0.90), 1e-12));
  const double h = 1e-5;
  const Vec3 speed = (flingDisplacement(1.1 + h) - flingDisplacement(1.1 - h)) / (2.0 * h);
  EXPECT_NEAR(speed.y(), -0.7, 1e-3);
  EXPECT_NEAR(speed.z(), 0.0, 1e-3);
}

TEST(RealityFling, MethodsAgreeOnACoarseCloth) {
  const Fling a = simulateFling({"verlet", 0, 0.0, 11});
  const Fling b = simulateFling({"line_xpbd", 40, 0.0, 11});
  EXPECT_EQ(flingDistance(a, a), 0.0);
  // One per cent of the longer side.
  EXPECT_LT(flingDistance(a, b), 7e-3);
  EXPECT_LE(flingChamfer(a, b), flingDistance(a, b));
  EXPECT_GT(flingChamfer(a, b), 0.0);
}

TEST(RealityMotion, LayersHoldBelowTheAngleOfFrictionOnly) {
  EXPECT_LT(slideOnSlope(0.5, 25.0), 1e-3);
  EXPECT_GT(slideOnSlope(0.5, 28.0), 5e-3);
}

TEST(RealityMotion, ASwingDecaysInAirAsTheoryHasIt) {
  const SwingDecay air = simulateSwing("cotton", true);
  const SwingDecay theory = swingByTheory("cotton");
  // The theory is for small amplitudes; the swing begins at a tenth of the length.
  EXPECT_NEAR(air.period / theory.period, 1.0, 0.02);
  EXPECT_NEAR(air.rate / theory.rate, 1.0, 0.15);
  EXPECT_LT(std::abs(simulateSwing("cotton", false).rate), 0.05 * theory.rate);
}

TEST(Reality, EveryTableHasRunsThatFillItsColumns) {
  const std::vector<RealityTable>& tables = realityTables();
  std::set<std::size_t> filled;
  for (const bool quick : {true, false}) {
    for (const RealityRun& run : realityRuns(quick)) {
      ASSERT_LT(run.table, tables.size());
      filled.insert(run.table);
    }
  }
  EXPECT_EQ(filled.size(), tables.size());
  for (const RealityRun& run : realityRuns(true)) {
    const RealityTable& table = tables[run.table];
    if (table.file != "reality_slope.csv" && table.file != "reality_pull.csv") continue;
    const std::string lines = run.make();
    EXPECT_EQ(lines.back(), '\n');
    const std::string first = lines.substr(0, lines.find('\n'));
    EXPECT_EQ(std::count(first.begin(), first.end(), ','),
              std::count(table.header.begin(), table.header.end(), ','));
  }
}

}  // namespace
}  // namespace cloth_sim
