/// \file `solver.error` chooses substeps; the estimates it rests on are those of the true errors.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/summary.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A cloth of silk that swings from an edge.
std::string swing(const std::string& solver, int particles = 40) {
  const std::string n = std::to_string(particles);
  return R"(
cloth:
  size: [0.8, 0.8]
  particles: [)" +
         n + ", " + n + R"(]
  pose: {position: [0, 0, 1], rpy: [0.6, 0, 0]}
  fabric: {preset: silk}
  pins: [last_row]
drag: 0.3
phases: [{name: swing, timeout: 5}]
solver: )" +
         solver + "\n";
}

Scene sceneOf(const std::string& solver, const std::vector<std::string>& set = {}) {
  return parseScene(swing(solver), "swing.yaml", set);
}

std::string refusal(const std::string& solver) {
  return testing_support::sceneErrorOf([&] { sceneOf(solver); });
}

TEST(SolverError, TakesLinesAndABudgetWithoutAMethod) {
  const SolverSpec solver = sceneOf("{error: 0.02}").solver;
  EXPECT_EQ(solver.method, "line_xpbd");
  EXPECT_EQ(solver.parameters.at("error"), 0.02);
  EXPECT_EQ(solver.parameters.at("budget"), 40.0);
  EXPECT_EQ(sceneOf("{error: 0.02, budget: 90}").solver.parameters.at("budget"), 90.0);
}

TEST(SolverError, GivesWayToSubstepsAndToOtherMethods) {
  const std::vector<std::string> substeps{"solver.substeps=7"};
  const SolverSpec fixed = sceneOf("{error: 0.02}", substeps).solver;
  EXPECT_EQ(fixed.method, "line_xpbd");
  EXPECT_EQ(fixed.parameters.at("error"), 0.0);
  EXPECT_EQ(fixed.parameters.at("substeps"), 7.0);
  const SolverSpec other =
      sceneOf("{error: 0.02, budget: 50}", {"solver.method=verlet", "solver.substeps=1500"}).solver;
  EXPECT_EQ(other.method, "verlet");
  EXPECT_EQ(other.parameters.at("substeps"), 1500.0);
}

TEST(SolverError, RefusesWhatNothingReachesWithOneLine) {
  for (const char* error : {"0", "-0.1", ".nan", "1.5", "soft"}) {
    EXPECT_THAT(refusal(std::string("{error: ") + error + "}"),
                HasSubstr("swing.yaml:10: solver.error"))
        << error;
  }
  EXPECT_THAT(refusal("{error: 0.0001}"), AllOf(HasSubstr("0.002"), HasSubstr("200 substeps")));
  EXPECT_THAT(refusal("{error: 0.01, budget: 0}"), HasSubstr("solver.budget"));
}

/// Root mean square of the differences of positions over the side [m].
double difference(const Simulation& a, const Simulation& b, double side) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.state().x.size(); ++k) {
    sum += (a.state().x[k] - b.state().x[k]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(a.state().x.size())) / side;
}

/// Of a fabric, size and motion that no factor was fitted to.
TEST(ErrorEstimate, OfPositionsIsTheTrueErrorWithinAFactorOfTwo) {
  for (const char* substeps : {"8", "20"}) {
    Simulation coarse(sceneOf(std::string("{method: line_xpbd, substeps: ") + substeps + "}"));
    Simulation fine(sceneOf("{method: line_xpbd, substeps: 200}"));
    for (int k = 0; k < 36; ++k) {
      coarse.step();
      fine.step();
    }
    const double error = difference(coarse, fine, 0.8);
    ASSERT_TRUE(coarse.lastReport().error);
    EXPECT_GT(coarse.lastReport().error->position, 0.5 * error) << substeps;
    EXPECT_LT(coarse.lastReport().error->position, 2.0 * error) << substeps;
    EXPECT_GT(error, 1e-4) << substeps << ": nothing to estimate";
  }
}

TEST(ErrorEstimate, IsZeroInFreeFall) {
  const std::vector<std::string> free{"cloth.pins=[]", "drag=0"};
  Simulation simulation(sceneOf("{method: line_xpbd, substeps: 5}", free));
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_LT(simulation.lastReport().error->position, 1e-6);
  EXPECT_LT(simulation.lastReport().error->strain, 1e-6);
}

/// A square of cotton, 0.3 m, that drops by 5 cm on a table, with one edge first.
std::string landing(const std::string& substeps) {
  return R"(
cloth:
  size: [0.3, 0.3]
  particles: [31, 31]
  fabric: {preset: cotton}
  pose: {position: [0, 0, 0.0943], rpy: [0.3, 0, 0]}
obstacles: {table: {type: plane, friction: 0.5}}
drag: 0.5
phases: [{name: rest, timeout: 100}]
solver: {method: line_xpbd, sleep: false, substeps: )" +
         substeps + "}\n";
}

/// Of a cloth at rest there is nothing more to go wrong, although gravity accelerates it no longer.
TEST(ErrorEstimate, DoesNotGrowAfterALanding) {
  Simulation coarse(parseScene(landing("20"), "landing.yaml"));
  Simulation fine(parseScene(landing("200"), "landing.yaml"));
  double largest = 0.0;
  for (int k = 0; k < 72; ++k) {
    coarse.step();
    fine.step();
    largest = std::max(largest, coarse.lastReport().error->position);
  }
  const double error = difference(coarse, fine, 0.3);
  EXPECT_GT(error, 0.002) << "nothing to estimate";
  EXPECT_GT(largest, 0.5 * error);
  EXPECT_LT(largest, 1.5 * error);
  EXPECT_LT(coarse.lastReport().error->position, 0.5 * largest) << "it fades";
}

/// A strip of cotton on a table, folded once across, with a sharp crease.
class FoldedStrip {
 public:
  FoldedStrip(const std::string& bending, const std::string& solver)
      : simulation_(parseScene(text(bending, solver), "fold.yaml", {})) {
    SimulationParts parts(simulation_.scene());
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        parts.state.x[row * kColumns + column] = placeOf(column) + row * kCell * Vec3::UnitY();
      }
    }
    simulation_.adopt(saveParts(parts));
  }
  Simulation* operator->() { return &simulation_; }

 private:
  static constexpr int kColumns = 64, kRows = 8;
  static constexpr double kCell = 0.008;   // [m]
  static constexpr double kLayer = 0.001;  // [m]

  static std::string text(const std::string& bending, const std::string& solver) {
    return R"(
cloth: {size: [0.504, 0.056], particles: [64, 8], fabric: {preset: cotton}, bending: )" +
           bending + R"(}
obstacles: {table: {type: plane, friction: 0.5}}
drag: 2.0
phases: [{name: rest, timeout: 100}]
solver: )" +
           solver;
  }
  /// The upper layer comes down, within four columns, from a fold that stands upright.
  static Vec3 placeOf(int column) {
    const bool isUpper = column >= kColumns / 2;
    const int steps = isUpper ? column - kColumns / 2 : kColumns / 2 - 1 - column;
    if (!isUpper) return {-kCell * steps, 0.0, kLayer};
    const double fall = 0.25 * (kCell - kLayer) * std::min(steps, 4);
    return {-kCell * steps, 0.0, kLayer + kCell - fall};
  }

  Simulation simulation_;
};

/// Displacements in vain are measured in every fourth substep. While bending acted in every second
/// one, an odd number of substeps measured it in every second step: 0.14 in place of 0.002.
TEST(ErrorEstimate, OfStrainIsNoMatterOfOddAndEvenSubsteps) {
  for (const char* bending : {"springs", "plate"}) {
    const auto estimateWith = [&](const std::string& substeps) {
      FoldedStrip strip(bending, "{method: line_xpbd, substeps: " + substeps + "}");
      double largest = 0.0;
      for (int k = 0; k < 40; ++k) {
        strip->step();
        if (k >= 30) largest = std::max(largest, strip->lastReport().error->strain);
      }
      return largest;
    };
    const double even = estimateWith("28");
    EXPECT_GT(even, 1e-4) << bending;
    EXPECT_NEAR(estimateWith("29"), even, 0.2 * even) << bending;
  }
}

TEST(ErrorControl, ComesBackToLongSubstepsAtRest) {
  FoldedStrip strip("plate", "{error: 0.01}");
  int most = 0;
  for (int k = 0; k < 300; ++k) {
    strip->step();
    most = std::max(most, strip->lastReport().substeps);
  }
  EXPECT_GT(most, 20);
  EXPECT_EQ(strip->lastReport().substeps, 20);
}

TEST(ErrorControl, TakesMoreSubstepsForASmallerError) {
  const auto substepsOf = [](const std::string& error) {
    Simulation simulation(sceneOf("{error: " + error + ", budget: 300}"));
    int sum = 0;
    for (int k = 0; k < 36; ++k) {
      simulation.step();
      sum += simulation.lastReport().substeps;
    }
    const ErrorEstimate estimate = *simulation.lastReport().error;
    EXPECT_EQ(estimate.sufficed, estimate.largestPosition <= std::stod(error));
    EXPECT_LT(estimate.position, 2.0 * std::stod(error)) << error;
    return sum;
  };
  const int few = substepsOf("0.1");
  EXPECT_EQ(few, 36 * 20);
  EXPECT_GT(substepsOf("0.003"), few);
}

TEST(ErrorControl, TellsTheLengthOfTheSubstepsThatItTook) {
  Simulation simulation(sceneOf("{error: 0.003, budget: 300}"));
  const double dt = simulation.scene().solver.dt;
  const double asked = simulation.substep();
  EXPECT_GT(asked, 0.0);
  for (int k = 0; k < 36; ++k) simulation.step();
  EXPECT_GT(simulation.lastReport().substeps, 20);
  EXPECT_NEAR(simulation.substep(), dt / simulation.lastReport().substeps, 1e-12);
}

TEST(ErrorControl, SaysWhenTheBudgetDoesNotSuffice) {
  Simulation simulation(sceneOf("{error: 0.002, budget: 4}"));
  for (int k = 0; k < 36; ++k) {
    simulation.step();
    EXPECT_EQ(simulation.lastReport().substeps, 4);
  }
  const ErrorEstimate error = *simulation.lastReport().error;
  EXPECT_FALSE(error.sufficed);
  EXPECT_THAT(shortfallText(error),
              AllOf(HasSubstr("solver.budget (4 substeps)"), HasSubstr("0.002")));
  ASSERT_EQ(simulation.warnings().size(), 1U);
  EXPECT_EQ(simulation.warnings()[0].text, shortfallText(error));
  const auto summary = nlohmann::json::parse(summaryJson(simulation, RunRecord(), 1.0));
  EXPECT_EQ(summary.at("error_estimate").at("budget_sufficed"), false);
  EXPECT_EQ(summary.at("error_estimate").at("asked"), 0.002);
  EXPECT_GT(summary.at("error_estimate").at("largest_position"), 0.002);
}

TEST(ErrorControl, GoesOnFromASavedStateToTheBit) {
  const Scene scene = sceneOf("{error: 0.004, budget: 200}");
  Simulation straight(scene);
  for (int k = 0; k < 20; ++k) straight.step();
  Simulation loaded(scene);
  ASSERT_TRUE(loaded.apply(Restore{straight.save()}).success);
  for (int k = 0; k < 20; ++k) {
    straight.step();
    loaded.step();
    ASSERT_EQ(straight.lastReport().substeps, loaded.lastReport().substeps) << k;
  }
  EXPECT_EQ(straight.save(), loaded.save());
}

}  // namespace
}  // namespace cloth_sim
