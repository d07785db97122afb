#include "cloth_sim/study/work_precision.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "cloth_sim/study/pareto.h"

namespace cloth_sim {
namespace {

/// Errors above this (the cloth's side, or the whole time until it separates) are no answer.
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

/// One method on one scene: climbs the ladder, and stops where it gets too expensive.
class Climber {
 public:
  Climber(const StudyScene& study, const Reference& reference, const Ladder& ladder)
      : study_(study), reference_(reference), ladder_(ladder) {}

  WorkPrecisionRow measure(const Configuration& configuration) {
    WorkPrecisionRow row{study_.name, configuration, {}, 0.0, study_.tearing};
    const double expected = expectedCost(configuration);
    if (expected > ladder_.mostPerRun) {
      skip("it would take about " + seconds(expected) + ", at most " + seconds(ladder_.mostPerRun) +
               " are allowed",
           row);
    } else if (spent_ + expected > ladder_.mostPerMethod) {
      skip("the method's " + seconds(ladder_.mostPerMethod) + " for this scene are used up", row);
    } else {
      row.run = bestRun(configuration);
      last_ = configuration;
      lastCost_ = row.run.cpuTime;
    }
    judge(row);
    return row;
  }

 private:
  /// From the run before: work grows with the number of substeps. Nothing is known of a method's
  /// first run, nor of one after a run that broke off.
  double expectedCost(const Configuration& next) const {
    if (last_.method == nullptr || last_.iterations != next.iterations) return 0.0;
    const double growth = next.substeps / next.dt / (last_.substeps / last_.dt);
    return lastCost_ * growth;
  }

  static void skip(const std::string& why, WorkPrecisionRow& row) {
    row.run.outcome = Outcome::kSkipped;
    row.run.why = why;
  }

  RunResult bestRun(const Configuration& configuration) {
    RunResult best = runScene(study_, configuration);
    spent_ += best.cpuTime;
    for (int k = 1; k < ladder_.repetitions && best.cpuTime < ladder_.repeatBelow; ++k) {
      const RunResult again = runScene(study_, configuration);
      spent_ += again.cpuTime;
      best.cpuTime = std::min(best.cpuTime, again.cpuTime);
    }
    return best;
  }

  void judge(WorkPrecisionRow& row) const {
    row.error = errorAgainst(reference_, study_, row.run);
    if (row.run.outcome != Outcome::kOk || row.error <= kWrong) return;
    row.run.outcome = Outcome::kWrong;
    row.run.why = std::isnan(row.error) ? "it never came apart" : "its error is above 1";
  }

  const StudyScene& study_;
  const Reference& reference_;
  const Ladder& ladder_;
  Configuration last_;
  double lastCost_ = 0.0;  ///< [s]
  double spent_ = 0.0;     ///< [s]
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
  ladder.iterations = {1.0};
  ladder.repetitions = 2;
  ladder.repeatBelow = 0.05;
  ladder.mostPerRun = 0.8;
  ladder.mostPerMethod = 1.6;
  return ladder;
}

Ladder fullLadder() {
  Ladder ladder;
  ladder.stepDivisions = {1, 4};
  ladder.substeps = {1, 2, 4, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 1024, 2048};
  ladder.iterations = {0.25, 1.0, 4.0};
  ladder.repetitions = 3;
  ladder.repeatBelow = 1.0;
  ladder.mostPerRun = 20.0;
  ladder.mostPerMethod = 120.0;
  return ladder;
}

std::vector<Configuration> climb(const SolverInfo& method, double dt, const Ladder& ladder) {
  std::vector<Configuration> rungs;
  for (const int iterations : iterationCounts(method, ladder.iterations)) {
    for (const int division : ladder.stepDivisions) {
      for (const int substeps : ladder.substeps) {
        if (substeps % division != 0) continue;
        rungs.push_back(configure(method, dt / division, substeps / division, iterations));
      }
    }
  }
  return rungs;
}

std::vector<WorkPrecisionRow> measureWorkPrecision(const StudyScene& study,
                                                   const Reference& reference, const Ladder& ladder,
                                                   const Announce& announce) {
  std::vector<WorkPrecisionRow> rows;
  for (const SolverInfo& method : solverRegistry()) {
    Climber climber(study, reference, ladder);
    for (const Configuration& configuration : climb(method, study.scene.solver.dt, ladder)) {
      announce(describe(study, configuration));
      rows.push_back(climber.measure(configuration));
    }
  }
  return rows;
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
