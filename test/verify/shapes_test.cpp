/// \file Shapes at rest: the catenary, the heavy elastica, the drape of a cloth over a table.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/sim/simulation.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

class Shapes : public OverMethods {};

INSTANTIATE_TEST_SUITE_P(Registry, Shapes, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

/// omega_max h of every substep here. With the retardation time tau = 1 / omega_max, dashpots make
/// even forward Euler stable at h < tau, and leave symplectic Euler a limit of 1.24.
constexpr double kStep = 0.5;

/// Bisects for the root of an increasing function.
template <typename Function>
double root(const Function& f, double low, double high) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// ---- catenary -----------------------------------------------------------------------------------

/// Half of an elastic chain between two pins at one height (Irvine, Cable Structures, 1981, ch. 1),
/// by the rest length s from its lowest point.
struct Catenary {
  double weight = 0.0;   ///< per rest length [N/m]
  double tensile = 0.0;  ///< EA [N]
  double pull = 0.0;     ///< horizontal tension [N]

  double x(double s) const {
    return pull * s / tensile + pull / weight * std::asinh(weight * s / pull);
  }
  double z(double s) const {
    const double q = weight * s / pull;
    return 0.5 * weight * s * s / tensile + pull / weight * (std::sqrt(1.0 + q * q) - 1.0);
  }
  /// Returns the catenary of a chain of rest length `length` [m] over `span` [m].
  static Catenary between(double weight, double tensile, double length, double span) {
    Catenary result{weight, tensile, 0.0};
    result.pull = root(
        [&](double tension) {
          return Catenary{weight, tensile, tension}.x(0.5 * length) - 0.5 * span;
        },
        1e-3 * weight * length, 10.0 * weight * length);
    return result;
  }
};

/// A chain of one metre over 0.8 m that a tension of its weight would stretch by 0.2 %.
struct HangingChain {
  static constexpr int kLinks = 20;
  static constexpr double kLength = 1.0;                          ///< [m]
  static constexpr double kSpan = 0.8;                            ///< [m]
  static constexpr double kSpacing = kLength / kLinks;            ///< [m]
  static constexpr double kMass = 0.01;                           ///< of a bead [kg]
  static constexpr double kWeight = kMass * kGravity / kSpacing;  ///< per length [N/m]
  static constexpr double kTensile = kWeight * kLength / 2e-3;    ///< [N]

  explicit HangingChain(const SolverInfo& info)
      : omega(2.0 * std::sqrt(kTensile / kSpacing / kMass)),
        rig(info, chainOf(kLinks + 1, kSpacing, kTensile / kSpacing, kMass, 1.0 / omega)) {
    rig.controls.drag = 6.0;
    // Along two straight lines, so that it has to find its shape.
    const double slope = std::sqrt(kLength * kLength - kSpan * kSpan) / kLength;
    forGrid(rig.model, [&](int, int column, VertexId v) {
      const double s = column * kSpacing - 0.5 * kLength;
      rig.state.x[v].x() = s * kSpan / kLength;
      rig.state.x[v].z() = (std::abs(s) - 0.5 * kLength) * slope;
      if (column == 0 || column == kLinks) rig.hold(v);
    });
  }

  /// Largest distance of a bead from where it should be [m].
  double miss(const Catenary& exact) const {
    double largest = 0.0;
    forGrid(rig.model, [&](int, int column, VertexId v) {
      const double s = column * kSpacing - 0.5 * kLength;
      const double x = s < 0.0 ? -exact.x(-s) : exact.x(s);
      const double z = exact.z(std::abs(s)) - exact.z(0.5 * kLength);
      const Vec3& p = rig.state.x[v];
      largest = std::max(largest, std::hypot(p.x() - x, p.z() - z));
    });
    return largest;
  }

  double omega;
  Rig rig;
};

TEST_P(Shapes, CatenaryBetweenTwoPins) {
  // The links are straight: they miss the curve by s^2 kappa / 8 at most, with kappa = w / H at the
  // bottom. After 3 s what moves (at 5 rad/s or more, against a drag of 6/s) has died away as
  // exp(-9).
  HangingChain chain(info());
  const double h = kStep / chain.omega;
  ASSERT_TRUE(chain.rig.run(h, static_cast<int>(3.0 / h)));
  const Catenary exact = Catenary::between(HangingChain::kWeight, HangingChain::kTensile,
                                           HangingChain::kLength, HangingChain::kSpan);
  const double miss = chain.miss(exact);
  record("largest_miss_over_length", miss / HangingChain::kLength);
  const double spacing = HangingChain::kSpacing;
  EXPECT_LT(miss, 0.125 * spacing * spacing * HangingChain::kWeight / exact.pull);
}

// ---- heavy elastica -----------------------------------------------------------------------------

/// A strip clamped level that bends under its own weight: B theta'' = -w (L - s) cos(theta) with
/// theta(0) = 0, theta'(L) = 0, theta the slope downwards. By shooting at theta'(0).
class Elastica {
 public:
  /// \param cubed  w L^3 / B
  explicit Elastica(double cubed) : cubed_(cubed) {
    curvature_ = root([&](double guess) { return shoot(guess).curvature; }, 0.0, cubed);
    end_ = shoot(curvature_);
  }
  double drop() const { return end_.drop; }    ///< of the tip, over L
  double reach() const { return end_.reach; }  ///< of the tip, over L

 private:
  struct Point {
    double slope = 0.0, curvature = 0.0, drop = 0.0, reach = 0.0;
    Point plus(double t, const Point& p) const {
      return {slope + t * p.slope, curvature + t * p.curvature, drop + t * p.drop,
              reach + t * p.reach};
    }
  };
  Point rate(double s, const Point& p) const {
    return {p.curvature, -cubed_ * (1.0 - s) * std::cos(p.slope), std::sin(p.slope),
            std::cos(p.slope)};
  }
  Point shoot(double curvature) const {
    Point p{0.0, curvature, 0.0, 0.0};
    const int steps = 400;
    const double h = 1.0 / steps;
    for (int k = 0; k < steps; ++k) {
      const double s = k * h;
      const Point a = rate(s, p);
      const Point b = rate(s + 0.5 * h, p.plus(0.5 * h, a));
      const Point c = rate(s + 0.5 * h, p.plus(0.5 * h, b));
      const Point d = rate(s + h, p.plus(h, c));
      p = p.plus(h / 6.0, a).plus(h / 3.0, b).plus(h / 3.0, c).plus(h / 6.0, d);
    }
    return p;
  }

  double cubed_;
  double curvature_ = 0.0;
  Point end_;
};

TEST(Elastica, KnowsSmallDeflectionsAndPeircesAngle) {
  // w L^4 / (8 B) for small loads; and the chord drops by 41.5 degrees where L is twice the bending
  // length (Peirce 1930: L = c / f(theta), f = (cos(theta/2) / (8 tan theta))^(1/3), which is
  // itself good to about a degree).
  EXPECT_NEAR(Elastica(1e-3).drop() / 1e-3, 0.125, 1e-6);
  const Elastica peirce(8.0);
  EXPECT_NEAR(std::atan2(peirce.drop(), peirce.reach()) * 180.0 / M_PI, 41.5, 1.5);
}

/// Strip that is clamped level at one end. Its bending rigidity B makes the bending length half of
/// the overhang [m].
struct Cantilever {
  double overhang = 0.0;
  bool plate = false;  ///< the bending energy of a plate instead of bend springs
  int cells = 6;       ///< of the overhang
  double step = 0.0;   ///< length of a substep [s]; 0: follows from the fastest mode

  /// Between the edge of the clamp and the last column that it holds [cells]: the energy of
  /// curvature at that column is that of half a cell to both sides.
  double clampedPart() const { return plate ? 0.5 : 0.0; }

  /// Chord of the overhang against the horizontal [rad].
  double angle(const SolverInfo& info, double seconds) const {
    Fabric fabric;
    fabric.arealDensity = 0.2;
    fabric.bending = fabric.arealDensity * kGravity * std::pow(0.5 * overhang, 3);
    // Just so stiff that bend springs are not capped (docs/model.md).
    const double l = overhang / (cells + clampedPart()), theta = std::min(1.5, 50.0 * l);
    const double bends = 64.0 * fabric.bending / (l * l * (plate ? 1.0 : theta * theta));
    fabric.tensileWarp = fabric.tensileWeft = 2.1 * bends;
    fabric.shear = 0.0;
    fabric.damping = 0.0;
    ClothSpec spec = clothOf(cells + 2, 2, l, fabric);
    spec.springs = {false, !plate};
    spec.plate = plate;
    fabric.damping = 1.0 / frequencyBound(buildModel(spec));
    spec.fabric = fabric;
    Rig rig(info, buildModel(spec));
    for (const int row : {0, 1}) {
      for (const int column : {0, 1}) rig.hold(rig.model.cloths[0].grid->vertex(column, row));
    }
    rig.controls.drag = 2.0 * std::sqrt(kGravity / overhang);
    const double h = step > 0.0 ? step : kStep / frequencyBound(rig.model);
    EXPECT_TRUE(rig.run(h, static_cast<int>(seconds / h)));
    const Vec3 edge =
        rig.state.x[rig.model.cloths[0].grid->vertex(1, 0)] - Vec3(clampedPart() * l, 0, 0);
    const Vec3 chord = rig.state.x[rig.model.cloths[0].grid->vertex(cells + 1, 0)] - edge;
    return std::atan2(-chord.z(), chord.x());
  }
};

TEST_P(Shapes, BendSpringsMissTheHeavyElastica) {
  // The chord of this strip should drop by 41 degrees whatever its length. Bend springs store too
  // little where it curves by less than 50/m (docs/model.md), so the shortest strip, which curves
  // by 30/m, comes nearest, and the longest all but hangs down. The angles are those at which the
  // springs balance: methods agree about them but for (omega_max h)^2 / 4 = 6 % in the stiffest
  // springs, which moves the strip by half a degree.
  struct Case {
    double overhang, angle;
  };
  const Elastica exact(8.0);
  const double right = std::atan2(exact.drop(), exact.reach()) * 180.0 / M_PI;
  record("elastica", right);
  for (const Case& c : {Case{0.05, 57.3}, Case{0.1, 71.2}, Case{0.2, 78.2}}) {
    // Of the pendulum that the strip would be, against critical drag: died away as exp(-15).
    const double settled = 15.0 * std::sqrt(c.overhang / kGravity);
    const double angle = Cantilever{c.overhang}.angle(info(), settled) * 180.0 / M_PI;
    record("angle_at_" + std::to_string(c.overhang), angle);
    if (isConsistent(info())) {
      EXPECT_NEAR(angle, c.angle, 0.5);
    }
    EXPECT_GT(std::abs(angle - right), 5.0);
  }
}

TEST_P(Shapes, TheBendingEnergyBendsLikeTheHeavyElastica) {
  // Six cells: second differences know the moment in the middle of a cell, so the chord is off by
  // (1/6)^2 / 12 or so of itself, 0.1 degrees of 41; stiff threads (0.4 % of strain) and what a
  // large step leaves of balance are less. The shape does not depend on the length: nor does the
  // angle.
  if (!isConsistent(info())) GTEST_SKIP() << "refuses a bending energy";
  const Elastica exact(8.0);
  const double right = std::atan2(exact.drop(), exact.reach()) * 180.0 / M_PI;
  for (const double overhang : {0.05, 0.2}) {
    const double settled = 15.0 * std::sqrt(overhang / kGravity);
    const double angle = Cantilever{overhang, true}.angle(info(), settled) * 180.0 / M_PI;
    record("angle_at_" + std::to_string(overhang), angle);
    EXPECT_NEAR(angle, right, 0.3);
  }
}

TEST_P(Shapes, FineCellsBendAsMuchAsCoarseOnes) {
  // With 24 cells the fastest modes of bending are ten times faster than such a substep can follow.
  // The strip bends over all of its length, far more slowly, and must not be softer for it. A sweep
  // of xpbd also leaves its threads a little too long.
  if (info().name != "line_xpbd" && info().name != "xpbd") {
    GTEST_SKIP() << "bends by a matrix, or not at all";
  }
  const Elastica exact(8.0);
  const double right = std::atan2(exact.drop(), exact.reach()) * 180.0 / M_PI;
  for (const double overhang : {0.05, 0.2}) {
    const double settled = 15.0 * std::sqrt(overhang / kGravity);
    const double angle = Cantilever{overhang, true, 24, 1.0 / 1200.0}.angle(info(), settled);
    record("angle_at_" + std::to_string(overhang), angle * 180.0 / M_PI);
    EXPECT_NEAR(angle * 180.0 / M_PI, right, info().name == "xpbd" ? 1.0 : 0.3);
  }
}

// ---- drape --------------------------------------------------------------------------------------

using Triangle = std::array<Vec2, 3>;

/// Whichever way round its corners are.
bool isInside(const Triangle& p, const Vec2& at) {
  int left = 0, right = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec2 e = p[(k + 1) % 3] - p[k], r = at - p[k];
    const double turn = e.x() * r.y() - e.y() * r.x();
    left += turn >= 0.0 ? 1 : 0;
    right += turn <= 0.0 ? 1 : 0;
  }
  return left == 3 || right == 3;
}

/// Raster of the shadow on the square [-side/2, side/2]^2 [m].
class Shadow {
 public:
  explicit Shadow(double side) : cell_(side / kRaster), dark_(kRaster * kRaster, 0) {}

  void cast(const Triangle& p) {
    const Vec2 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
    const Vec2 high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
    for (int row = index(low.y()); row <= index(high.y()); ++row) {
      for (int column = index(low.x()); column <= index(high.x()); ++column) {
        const Vec2 at = cell_ * Vec2(column + 0.5 - kMiddle, row + 0.5 - kMiddle);
        if (isInside(p, at)) dark_[row * kRaster + column] = 1;
      }
    }
  }

  double area() const {
    return static_cast<double>(std::count(dark_.begin(), dark_.end(), 1)) * cell_ * cell_;
  }

 private:
  static constexpr int kRaster = 256;
  static constexpr int kMiddle = kRaster / 2;

  int index(double x) const {
    return std::clamp(static_cast<int>(x / cell_) + kMiddle, 0, kRaster - 1);
  }

  double cell_;
  std::vector<char> dark_;
};

constexpr double kSide = 0.3;      // of the cloth [m]
constexpr double kSupport = 0.15;  // side of the table [m]

/// A square of cloth that lies on a smaller table.
Scene drapeScene(const std::string& method, double bending) {
  Fabric fabric;
  fabric.arealDensity = 0.2;
  fabric.tensileWarp = fabric.tensileWeft = 20.0;
  fabric.shear = 5.0;
  fabric.bending = bending;
  fabric.damping = 0.0;
  fabric.thickness = 1e-3;
  Scene scene;
  scene.cloths[0] = clothOf(9, 9, kSide / 8, fabric);
  const double omega = frequencyBound(buildModel(scene.cloths[0]));
  scene.cloths[0].fabric.damping = 1.0 / omega;
  scene.cloths[0].pose.position.z() = 0.5 * fabric.thickness;
  Obstacle table;
  table.name = "table";
  table.shape = BoxShape{Vec3(kSupport, kSupport, 0.1)};
  table.pose.position.z() = -0.05;
  table.friction = 0.5;
  scene.obstacles = {table};
  scene.drag = 10.0;
  scene.solver.method = method;
  scene.solver.dt = 0.02;
  const double substeps = std::ceil(scene.solver.dt * omega / kStep);
  scene.solver.parameters = completeParameters(findSolver(method), {{"substeps", substeps}});
  return scene;
}

/// Returns the drape coefficient of Cusick (1968): the fraction of the overhanging ring that the
/// shadow of the draped cloth covers [-].
double drapeCoefficient(const std::string& method, double bending) {
  Simulation simulation(drapeScene(method, bending));
  while (simulation.time() < 1.5 && !simulation.failed()) simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  Shadow shadow(1.2 * kSide);
  for (const Face& face : simulation.model().mesh.faces()) {
    Triangle p;
    for (int k = 0; k < 3; ++k) p[k] = simulation.state().x[face[k]].head<2>();
    shadow.cast(p);
  }
  const double support = kSupport * kSupport;
  return (shadow.area() - support) / (kSide * kSide - support);
}

TEST_P(Shapes, DrapeCoefficientGrowsWithBendingRigidity) {
  // Between 0 (all hangs) and 1 (nothing bends). The raster of 1.4 mm counts the area of a border
  // to 1e-3 or so, so a growth of 0.02 is one.
  std::vector<double> drape;
  for (const double bending : {1e-6, 3e-5, 3e-4}) {
    drape.push_back(drapeCoefficient(GetParam(), bending));
    record("drape_at_" + std::to_string(bending), drape.back());
  }
  EXPECT_GE(drape[0], 0.0);
  EXPECT_LE(drape[2], 1.0);
  if (!isConsistent(info())) {
    EXPECT_NEAR(drape[2], drape[0], 0.02) << "the fabric decides, after all";
    return;
  }
  EXPECT_GT(drape[1], drape[0] + 0.02);
  EXPECT_GT(drape[2], drape[1] + 0.02);
}

}  // namespace
}  // namespace cloth_sim
