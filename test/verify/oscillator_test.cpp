/// \file Phase, energy and limit of stability of oscillators with every method. The expected values
/// follow from the order and the limit that the registry states.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

class Oscillators : public OverMethods {};

INSTANTIATE_TEST_SUITE_P(Registry, Oscillators, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

// ---- one mass on a spring -----------------------------------------------------------------------

constexpr double kStiffness = 50.0;  // [N/m]
constexpr double kMass = 0.02;       // [kg]
constexpr double kSpacing = 0.5;     // [m]
constexpr double kPull = 0.1;        // [m]

/// A point of the phase plane of a mass on a spring, relative to its first extension.
struct Phase {
  double position = 0.0;
  double velocity = 0.0;  ///< over -omega

  double amplitude() const { return std::hypot(position, velocity); }
  double angle() const { return std::atan2(velocity, position); }
};

/// Returns the point after `steps` steps, `perPeriod` of which make a period.
Phase swing(const SolverInfo& info, int perPeriod, int steps) {
  Rig rig(info, chainOf(2, kSpacing, kStiffness, kMass));
  rig.controls.gravity.setZero();
  rig.hold(rig.model.cloths[0].grid->vertex(0, 0));
  rig.hold(rig.model.cloths[0].grid->vertex(0, 1));
  const VertexId free = rig.model.cloths[0].grid->vertex(1, 0);
  rig.state.x[free].x() += kPull;
  rig.state.x[rig.model.cloths[0].grid->vertex(1, 1)].x() += kPull;
  const double omega = std::sqrt(kStiffness / kMass);
  EXPECT_TRUE(rig.run(2.0 * M_PI / omega / perPeriod, steps));
  return {(rig.state.x[free].x() - kSpacing) / kPull, -rig.state.v[free].x() / (omega * kPull)};
}

TEST_P(Oscillators, PhaseAndAmplitudeAfterAPeriod) {
  // With a = omega h the local error is of order a^(p+1), its factor at most 1 for all of these
  // methods; 2 pi / a steps make a period. Of a first-order method's error a^2/2 all is amplitude,
  // so its phase is of second order.
  if (!isConsistent(info())) GTEST_SKIP() << "its stiffness is not the spring's";
  const int steps = 100;
  const double a = 2.0 * M_PI / steps;
  const Phase end = swing(info(), steps, steps);
  record("phase_per_period", end.angle());
  record("amplitude_per_period", end.amplitude() - 1.0);
  EXPECT_LT(std::abs(end.angle()), M_PI * std::pow(a, std::max(2, info().order)));
  EXPECT_LT(std::abs(end.amplitude() - 1.0), 2.0 * M_PI * std::pow(a, info().order));
}

TEST_P(Oscillators, ErrorScalesWithTheOrder) {
  // The time is no whole period, where symplectic Euler happens to be of second order. The next
  // term of the error is a part a = 0.03 of this one, with a factor of up to 2: 0.1 in the order.
  if (!isConsistent(info())) GTEST_SKIP() << "its stiffness is not the spring's";
  const auto error = [&](int perPeriod) {
    const Phase end = swing(info(), perPeriod, perPeriod * 9 / 8);
    return std::hypot(end.position - std::sqrt(0.5), end.velocity - std::sqrt(0.5));
  };
  const double order = std::log2(error(200) / error(400));
  record("observed_order", order);
  EXPECT_NEAR(order, info().order, 0.1);
}

// ---- energy -------------------------------------------------------------------------------------

constexpr double kLongStep = 0.2;  ///< omega_max h

/// A chain with free ends that vibrates longitudinally at speeds of up to 0.1 m/s, without damping.
Rig vibratingChain(const SolverInfo& info) {
  Rig rig(info, chainOf(12, kSpacing, kStiffness, kMass));
  rig.controls.gravity.setZero();
  Generator random(5);
  for (Vec3& v : rig.state.v) v.x() = uniform(random, -0.1, 0.1);
  return rig;
}

/// Returns the energy after each step relative to that at the start, until it exceeds `enough` or
/// the method fails.
std::vector<double> energyHistory(const SolverInfo& info, int steps, double enough) {
  Rig rig = vibratingChain(info);
  const double h = kLongStep / frequencyBound(rig.model);
  const double first = totalEnergy(rig);
  std::vector<double> history;
  for (int k = 0; k < steps && rig.run(h, 1); ++k) {
    history.push_back(totalEnergy(rig) / first);
    if (history.back() > enough) break;
  }
  return history;
}

double meanOf(const std::vector<double>& values, std::size_t from, std::size_t to) {
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(from),
                         values.begin() + static_cast<std::ptrdiff_t>(to), 0.0) /
         static_cast<double>(to - from);
}

TEST_P(Oscillators, EnergyInTheLongRun) {
  // 300 periods of the fastest mode. A mode of a = omega h has its energy multiplied in each step
  // by 1 + a^2 in forward Euler; a symplectic method swings by a (first order) or a^2 around the
  // energy that it keeps.
  const int steps = static_cast<int>(300 * 2.0 * M_PI / kLongStep);
  const std::vector<double> history = energyHistory(info(), steps, 1e6);
  const std::size_t n = history.size(), tenth = n / 10;
  const double highest = *std::max_element(history.begin(), history.end());
  record("energy_at_the_end", history.back());
  record("energy_at_most", highest);
  if (info().stabilityLimit == 0.0) {
    // (1 + a^2)^k = 1e6 for the fastest mode after 350 steps; its fraction of the first energy is a
    // twelfth, so some 60 steps later.
    EXPECT_GT(highest, 1e6);
    EXPECT_LT(n, 500U);
    return;
  }
  ASSERT_EQ(n, static_cast<std::size_t>(steps));
  EXPECT_LT(highest, 1.0 + kLongStep);
  if (std::isinf(info().stabilityLimit)) {
    EXPECT_LE(history.back(), 1.0);
    return;
  }
  const double trend = meanOf(history, n - tenth, n) - meanOf(history, 0, tenth);
  record("energy_trend", trend);
  // Bounded, and no gain: of what a mean over a tenth, 30 periods, may still swing by.
  EXPECT_LT(trend, std::pow(kLongStep, std::min(2, info().order)) / 30.0);
}

TEST_P(Oscillators, SymplecticMethodsKeepTheirEnergyWithoutATrend) {
  // Known by the name: a method with a limit need not be symplectic (classical Runge-Kutta loses
  // a^6 / 72 of a mode's energy per step).
  if (GetParam() != "verlet" && GetParam() != "symplectic_euler") GTEST_SKIP();
  const int steps = static_cast<int>(300 * 2.0 * M_PI / kLongStep);
  const std::vector<double> history = energyHistory(info(), steps, 1e6);
  const auto [low, high] = std::minmax_element(history.begin(), history.end());
  const std::size_t n = history.size(), tenth = n / 10;
  const double trend = meanOf(history, n - tenth, n) - meanOf(history, 0, tenth);
  record("energy_swing", *high - *low);
  record("energy_trend", trend);
  EXPECT_LT(*high - *low, 2.0 * std::pow(kLongStep, info().order));
  EXPECT_LT(std::abs(trend), 0.05 * (*high - *low));
}

// ---- stability ----------------------------------------------------------------------------------

/// A chain between two held ends in its fastest mode, with an amplitude of a thousandth of its
/// spacing.
struct HeldChain {
  static constexpr int kMasses = 10;
  static constexpr double kSize = 1e-3 * kSpacing;

  static double omega() {
    return 2.0 * std::sqrt(kStiffness / kMass) * std::sin(0.5 * M_PI * kMasses / (kMasses + 1.0));
  }

  /// Returns the growth factor of the largest amplitude after `steps` steps at `a` = omega h;
  /// infinity if the method fails.
  static double growth(const SolverInfo& info, double a, int steps) {
    Rig rig(info, chainOf(kMasses + 2, kSpacing, kStiffness, kMass));
    rig.controls.gravity.setZero();
    const State rest = rig.state;
    const auto mode = [](int column) {
      return std::sin(M_PI * kMasses * column / (kMasses + 1.0));
    };
    forGrid(rig.model, [&](int, int column, VertexId v) {
      if (column == 0 || column == kMasses + 1) {
        rig.hold(v);
      } else {
        rig.state.x[v].x() += kSize * mode(column);
      }
    });
    const double before = amplitude(rig, rest);
    if (!rig.run(a / omega(), steps)) return std::numeric_limits<double>::infinity();
    return amplitude(rig, rest) / before;
  }

  /// Returns the largest amplitude of all particles.
  static double amplitude(const Rig& rig, const State& rest) {
    double largest = 0.0;
    for (VertexId v = 0; v < rig.model.particleCount(); ++v) {
      const double x = (rig.state.x[v] - rest.x[v]).norm();
      largest = std::max(largest, std::hypot(x, rig.state.v[v].norm() / omega()));
    }
    return largest;
  }
};

TEST_P(Oscillators, StabilityLimitOfAChain) {
  // At 1 % above the limit the fastest mode grows by 7 % in each step or more (Verlet by 33 %):
  // 400 steps are a factor of 1e11 at least. At 1 % below, a symplectic method still swings, by
  // 1 / sqrt(1 - (a / limit)^2) = 7.
  const double limit = info().stabilityLimit;
  if (limit == 0.0) {
    // |1 + i a| = sqrt(1 + a^2) per step, but for rounding.
    EXPECT_NEAR(HeldChain::growth(info(), 0.1, 800) / std::pow(1.01, 400.0), 1.0, 1e-9);
    return;
  }
  if (std::isinf(limit)) {
    const double growth = HeldChain::growth(info(), 100.0, 1000);
    record("growth_at_100", growth);
    EXPECT_LE(growth, 1.0);
    return;
  }
  double stable = 0.1, unstable = 20.0;
  while (unstable / stable > 1.003) {
    const double a = std::sqrt(stable * unstable);
    (HeldChain::growth(info(), a, 400) < 100.0 ? stable : unstable) = a;
  }
  record("limit", stable);
  EXPECT_NEAR(stable / limit, 1.0, 0.03);
}

}  // namespace
}  // namespace cloth_sim
