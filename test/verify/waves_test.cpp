/// \file Waves in a membrane and in a strip, against their analytic solutions.

#include <gtest/gtest.h>

#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

class Waves : public OverMethods {};

INSTANTIATE_TEST_SUITE_P(Registry, Waves, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

constexpr double kDensity = 0.2;     // [kg/m^2]
constexpr double kStiffness = 20.0;  // [N/m]
constexpr double kFineStep = 0.1;    ///< omega_max h

Fabric plainFabric() {
  Fabric fabric;
  fabric.arealDensity = kDensity;
  fabric.tensileWarp = kStiffness;
  fabric.tensileWeft = kStiffness;
  fabric.shear = 0.0;
  fabric.bending = 0.0;
  return fabric;
}

// ---- a membrane under tension -------------------------------------------------------------------

constexpr int kCells = 16;
constexpr double kStrain = 0.1;

/// A square of 1 m (at rest), stretched by kStrain in both directions, with its border held,
/// deflected in its fundamental mode by a thousandth of its side.
class Drum {
 public:
  explicit Drum(const SolverInfo& info) : rig(info, membrane()) {
    rig.controls.gravity.setZero();
    for (Vec3& x : rig.state.x) x *= 1.0 + kStrain;
    forGrid(rig.model, [&](int row, int column, VertexId v) {
      if (row == 0 || column == 0 || row == kCells || column == kCells) {
        rig.hold(v);
      } else {
        rig.state.x[v].z() = 1e-3 * shape(row, column);
      }
    });
  }

  /// Returns the amplitude of the fundamental mode [m].
  double bulge() const {
    double sum = 0.0;
    forGrid(rig.model, [&](int row, int column, VertexId v) {
      sum += shape(row, column) * rig.state.x[v].z();
    });
    return sum;
  }

  Rig rig;

 private:
  static Model membrane() {
    ClothSpec spec = clothOf(kCells + 1, kCells + 1, 1.0 / kCells, plainFabric());
    spec.springs = {false, false};
    return buildModel(spec);
  }
  static double shape(int row, int column) {
    return std::sin(M_PI * row / kCells) * std::sin(M_PI * column / kCells);
  }
};

/// Returns the angular frequency, from a quarter and three quarters of the first period.
double drumFrequency(const SolverInfo& info) {
  Drum drum(info);
  const double h = kFineStep / frequencyBound(drum.rig.model);
  std::vector<double> crossings;
  double before = drum.bulge();
  for (int k = 0; k < 10000 && crossings.size() < 2; ++k) {
    if (!drum.rig.run(h, 1)) return 0.0;
    const double now = drum.bulge();
    if ((before > 0.0) != (now > 0.0)) {
      crossings.push_back(h * (k + before / (before - now)));
    }
    before = now;
  }
  return crossings.size() == 2 ? M_PI / (crossings[1] - crossings[0]) : 0.0;
}

TEST_P(Waves, FundamentalFrequencyOfATensionedSquareMembrane) {
  // omega = sqrt(2) pi / L sqrt(T / rho), with L and rho at rest and T = K e / (1 + e) the force on
  // a thread over its stretch. Threads on a grid of n cells have sin(pi / 2n) / (pi / 2n) of that:
  // 0.16 % less here. The bulge adds (pi 1e-3)^2 / 4 to a strain of 0.1: nothing. A spring's
  // tension may be off by (omega_max h)^2 / 4, in the methods that project springs; half of it
  // shows.
  const double continuum =
      std::sqrt(2.0) * M_PI * std::sqrt(kStiffness * kStrain / (1.0 + kStrain) / kDensity);
  const double x = 0.5 * M_PI / kCells;
  const double lattice = continuum * std::sin(x) / x;
  const double measured = drumFrequency(info());
  record("frequency_over_closed_form", measured / continuum);
  if (!isConsistent(info())) {
    EXPECT_GT(std::abs(measured / continuum - 1.0), 0.1);
    return;
  }
  EXPECT_NEAR(measured / lattice, 1.0, 0.125 * kFineStep * kFineStep);
  EXPECT_NEAR(measured / continuum, 1.0, 4e-3);
}

// ---- a wave along a strip -----------------------------------------------------------------------

constexpr int kMasses = 161;
constexpr double kSpacing = 0.01;  // [m]
constexpr double kWidth = 8.0;     ///< of the pulse: standard deviation in spacings

/// Returns the centroid of the kinetic energy [m].
double centreOfMotion(const Rig& rig) {
  double moment = 0.0, sum = 0.0;
  for (VertexId v = 0; v < rig.model.particleCount(); ++v) {
    const double e = rig.model.mass[v] * rig.state.v[v].squaredNorm();
    moment += e * rig.model.mesh.material(v).x();
    sum += e;
  }
  return moment / sum;
}

TEST_P(Waves, SpeedOfAnInPlaneWaveInAStrip) {
  // A bell-shaped displacement that runs along the strip at c = sqrt(K / rho). On a lattice the
  // group velocity at wave number k is c (1 - (k s)^2 / 8); weighted with the energy of the bell,
  // <k^2> = 3 / (2 w^2): 0.29 % less. The next term is a tenth of that, and the phase error of a
  // method is at most (omega h)^2 / 2 at the frequencies in the bell, omega = omega_max / 16. The
  // stiffness may be off by (omega_max h)^2 / 4, in the methods that project springs; half of it
  // shows.
  const Model chain =
      chainOf(kMasses, kSpacing, 0.5 * kStiffness, 0.5 * kDensity * kSpacing * kSpacing);
  const double c = std::sqrt(kStiffness / kDensity);
  const double w = kWidth * kSpacing, from = 5.0 * w, amplitude = 1e-4;
  Rig rig(info(), chain);
  rig.controls.gravity.setZero();
  for (VertexId v = 0; v < chain.particleCount(); ++v) {
    const double x = chain.mesh.material(v).x() - from;
    const double bell = amplitude * std::exp(-0.5 * x * x / (w * w));
    rig.state.x[v].x() += bell;
    rig.state.v[v].x() = c * x / (w * w) * bell;
  }
  const double before = centreOfMotion(rig);
  const double h = kFineStep / frequencyBound(chain), way = 0.8;
  const int steps = static_cast<int>(std::lround(way / c / h));
  ASSERT_TRUE(rig.run(h, steps));
  const double speed = (centreOfMotion(rig) - before) / (steps * h);
  record("speed_over_closed_form", speed / c);
  if (!isConsistent(info())) {
    EXPECT_GT(std::abs(speed / c - 1.0), 0.05);
    return;
  }
  const double slower = 3.0 / (16.0 * kWidth * kWidth);
  EXPECT_NEAR(speed / c, 1.0 - slower, 0.2 * slower + 0.125 * kFineStep * kFineStep);
}

}  // namespace
}  // namespace cloth_sim
