#include "work_precision.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "pareto.h"

namespace cloth_sim {
namespace {

/// Error above which a run is wrong: the side of the cloth, or the whole time until it separates.
constexpr double kWrong = 1.0;

std::vector<int> iterationCounts(const SolverInfo& method, const std::vector<double>& multiples) {
  const SolverParameter* parameter = findParameter(method, "iterations");
  if (parameter == nullptr) return {0};
  std::set<int> counts;
  for (const double multiple : multiples) {
    const double count = std::round(parameter->defaultValue * multiple);
    counts.insert(static_cast<int>(std::clamp(count, parameter->minimum, parameter->maximum)));
  }
  return {counts.begin(), counts.end()};
}

std::string seconds(double time) {
  std::ostringstream text;
  text.precision(2);
  text << time << " s";
  return text.str();
}

/// Measures the runs of a climb in turn; skips those that would be too expensive.
class Climber {
 public:
  Climber(const StudyScene& study, const Ladder& ladder) : study_(study), ladder_(ladder) {}

  WorkPrecisionRow measure(const Configuration& configuration) {
    WorkPrecisionRow row{study_.name, configuration, {}, 0.0, study_.tearing};
    const double expected = expectedCost(configuration);
    if (expected > ladder_.mostPerRun) {
      row.run.outcome = Outcome::kSkipped;
      row.run.why = "it would take about " + seconds(expected) + ", at most " +
                    seconds(ladder_.mostPerRun) + " are allowed";
    } else {
      row.run = bestRun(configuration);
      last_ = configuration;
      lastCost_ = row.run.cpuTime;
    }
    return row;
  }

 private:
  /// Returns the expected CPU time of a run, proportional to the number of substeps, from the run
  /// before [s]; 0 for the first run.
  double expectedCost(const Configuration& next) const {
    if (last_.method == nullptr) return 0.0;
    return lastCost_ * (next.substeps / next.dt) / (last_.substeps / last_.dt);
  }

  RunResult bestRun(const Configuration& configuration) const {
    RunResult best = runScene(study_, configuration);
    for (int k = 1; k < ladder_.repetitions && best.cpuTime < ladder_.repeatBelow; ++k) {
      best.cpuTime = std::min(best.cpuTime, runScene(study_, configuration).cpuTime);
    }
    return best;
  }

  const StudyScene& study_;
  const Ladder& ladder_;
  Configuration last_;
  double lastCost_ = 0.0;  ///< [s]
};

std::string describe(const StudyScene& study, const Configuration& configuration) {
  return study.name + ", " + configuration.method->name + ", " +
         std::to_string(configuration.substeps) + " substeps";
}

}  // namespace

Ladder quickLadder() {
  Ladder ladder;
  ladder.stepDivisions = {1, 4};
  ladder.substeps = {1, 2, 5, 10, 20, 40, 80, 160, 320};
  ladder.substepsWithIterations = {1, 2, 5, 10, 20, 40};
  ladder.iterations = {0.1, 1.0};
  ladder.repetitions = 2;
  ladder.repeatBelow = 0.05;
  ladder.mostPerRun = 30.0;  // reached only on a machine ten times too slow
  return ladder;
}

Ladder fullLadder() {
  Ladder ladder;
  ladder.stepDivisions = {1, 4};
  ladder.substeps = {1, 2, 4, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 1024, 2048};
  ladder.substepsWithIterations = {1, 2, 4, 8, 12, 16, 24, 32, 48, 64, 96, 128};
  ladder.iterations = {0.1, 0.3, 1.0, 4.0};
  ladder.repetitions = 3;
  ladder.repeatBelow = 1.0;
  ladder.mostPerRun = 10.0;
  return ladder;
}

std::vector<Climb> climbs(const SolverInfo& method, double dt, const Ladder& ladder) {
  const bool iterates = findParameter(method, "iterations") != nullptr;
  const std::vector<int>& counts = iterates ? ladder.substepsWithIterations : ladder.substeps;
  std::vector<Climb> result;
  for (const int iterations : iterationCounts(method, ladder.iterations)) {
    for (const int division : ladder.stepDivisions) {
      Climb climb;
      for (const int substeps : counts) {
        if (substeps % division != 0) continue;
        climb.push_back(configure(method, dt / division, substeps / division, iterations));
      }
      result.push_back(std::move(climb));
    }
  }
  return result;
}

std::vector<WorkPrecisionRow> measureClimb(const StudyScene& study, const Climb& climb,
                                           const Ladder& ladder, const Announce& announce) {
  std::vector<WorkPrecisionRow> rows;
  Climber climber(study, ladder);
  for (const Configuration& configuration : climb) {
    announce(describe(study, configuration));
    rows.push_back(climber.measure(configuration));
  }
  return rows;
}

void judge(const Reference& reference, const StudyScene& study, WorkPrecisionRow& row) {
  row.error = errorAgainst(reference, study, row.run);
  if (row.run.outcome != Outcome::kOk || row.error <= kWrong) return;
  row.run.outcome = Outcome::kWrong;
  row.run.why = std::isnan(row.error) ? "it never came apart" : "its error is above 1";
}

std::vector<WorkPrecisionRow> paretoRows(const std::vector<WorkPrecisionRow>& rows) {
  std::vector<std::string> scenes;
  for (const WorkPrecisionRow& row : rows) {
    if (scenes.empty() || scenes.back() != row.scene) scenes.push_back(row.scene);
  }
  std::vector<WorkPrecisionRow> front;
  for (const std::string& scene : scenes) {
    std::vector<WorkPrecisionRow> of;
    std::vector<CostAndError> points;
    for (const WorkPrecisionRow& row : rows) {
      if (row.scene != scene || row.run.outcome != Outcome::kOk) continue;
      of.push_back(row);
      points.push_back({row.run.cpuPerSimulatedSecond(), row.error});
    }
    for (const std::size_t k : paretoFront(points)) front.push_back(of[k]);
  }
  return front;
}

}  // namespace cloth_sim
