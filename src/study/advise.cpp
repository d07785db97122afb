#include "cloth_sim/study/advise.h"

#include <cmath>
#include <iomanip>
#include <ostream>

namespace cloth_sim {
namespace {

constexpr int kMostSubsteps = 4096;
/// The converged run shall be better than what it judges by this factor ...
constexpr double kReferencePart = 0.1;
/// ... and is divided this often for that, at most.
constexpr int kHalvings = 4;
/// A run that broke off says little of what more substeps cost; after this much of them a method is
/// given up [s of CPU time].
constexpr double kMostForFailures = 20.0;

/// Collects what is tried, and knows when a method is not worth going on with.
class Adviser {
 public:
  Adviser(const StudyScene& study, Advice& advice, const Announce& announce)
      : study_(study), advice_(advice), announce_(announce) {}

  void climb(const SolverInfo& method) {
    double spent = 0.0;
    bool within = false;  // the run before
    for (int substeps = 1; substeps <= kMostSubsteps; substeps *= 2) {
      const WorkPrecisionRow row = attempt(method, substeps);
      advice_.tried.push_back(row);
      if (row.run.outcome == Outcome::kRefused) return;
      const bool withinNow = row.error <= advice_.bound;
      if (within && withinNow) return accept(advice_.tried.size() - 2);
      within = withinNow;
      spent += row.run.cpuTime;
      const bool failed = row.run.outcome == Outcome::kDiverged;
      const double cost = failed ? 0.0 : row.run.cpuPerSimulatedSecond();
      if ((within ? cost : 2.0 * cost) > cheapest() || (failed && spent > kMostForFailures)) return;
    }
  }

 private:
  WorkPrecisionRow attempt(const SolverInfo& method, int substeps) {
    const double iterations = findParameter(method, "iterations") != nullptr
                                  ? findParameter(method, "iterations")->defaultValue
                                  : 0.0;
    const Configuration configuration = configure(method, study_.scene.solver.dt, substeps,
                                                  static_cast<int>(std::lround(iterations)));
    announce_(method.name + ", " + std::to_string(substeps) + " substeps");
    WorkPrecisionRow row{study_.name, configuration, runScene(study_, configuration), 0.0,
                         study_.tearing};
    row.error = errorAgainst(advice_.reference, study_, row.run);
    return row;
  }

  double cheapest() const {  ///< of those accepted [s/s]
    return advice_.best ? advice_.tried[*advice_.best].run.cpuPerSimulatedSecond()
                        : std::numeric_limits<double>::infinity();
  }

  void accept(std::size_t k) {
    if (advice_.tried[k].run.cpuPerSimulatedSecond() < cheapest()) advice_.best = k;
  }

  const StudyScene& study_;
  Advice& advice_;
  const Announce& announce_;
};

void writeFigures(std::ostream& out, const RunResult& run, double error) {
  out << std::setprecision(3);
  if (run.outcome != Outcome::kOk) {
    out << toString(run.outcome) << '\n';
  } else {
    out << "error " << error << ", " << run.cpuPerSimulatedSecond()
        << " s of CPU per simulated second\n";
  }
}

/// Of the substeps with which a method diverges only the most are of interest.
bool isFollowedByDivergence(const std::vector<WorkPrecisionRow>& rows, std::size_t k) {
  return k + 1 < rows.size() && rows[k].run.outcome == Outcome::kDiverged &&
         rows[k + 1].run.outcome == Outcome::kDiverged &&
         rows[k + 1].configuration.method == rows[k].configuration.method;
}

void writeTrial(std::ostream& out, const WorkPrecisionRow& row) {
  const bool diverged = row.run.outcome == Outcome::kDiverged;
  out << "  " << std::left << std::setw(18) << row.configuration.method->name << std::right
      << (diverged ? " up to " : "       ") << std::setw(4) << row.configuration.substeps
      << " substeps: ";
  writeFigures(out, row.run, row.error);
}

void writeBlock(std::ostream& out, const Scene& scene) {
  out << "solver:\n  method: " << scene.solver.method << "\n  dt: " << std::setprecision(17)
      << scene.solver.dt << '\n';
  for (const auto& [name, value] : scene.solver.parameters) {
    out << "  " << name << ": " << value << '\n';
  }
}

}  // namespace

Advice advise(StudyScene study, double bound, const Announce& announce) {
  Advice advice;
  advice.bound = bound;
  announce("the scene's own configuration");
  advice.own = runScene(study);
  // Where it does not come apart, positions are what there is to compare.
  study.tearing = !std::isnan(advice.own.tearing.separation);
  announce("a converged run");
  advice.reference = convergeReference(study, {kReferencePart * bound, kHalvings});
  advice.ownError = errorAgainst(advice.reference, study, advice.own);
  Adviser adviser(study, advice, announce);
  for (const SolverInfo& method : solverRegistry()) adviser.climb(method);
  return advice;
}

void writeAdvice(std::ostream& out, const StudyScene& study, const Advice& advice) {
  out << study.name << ", " << study.duration << " s, against " << advice.reference.source
      << " (own error " << std::setprecision(2) << advice.reference.ownError << ")\n";
  for (std::size_t k = 0; k < advice.tried.size(); ++k) {
    if (!isFollowedByDivergence(advice.tried, k)) writeTrial(out, advice.tried[k]);
  }
  out << "The scene's own (" << study.scene.solver.method << "): ";
  writeFigures(out, advice.own, advice.ownError);
  if (!advice.best) {
    out << "None of them has an error of at most " << advice.bound
        << " and keeps it with more substeps. Where errors stop\n"
           "falling with more substeps, only a shorter dt helps.\n";
    return;
  }
  const WorkPrecisionRow& best = advice.tried[*advice.best];
  out << "Cheapest with an error of at most " << std::setprecision(6) << advice.bound << ": ";
  writeFigures(out, best.run, best.error);
  writeBlock(out, withConfiguration(study.scene, best.configuration));
}

}  // namespace cloth_sim
