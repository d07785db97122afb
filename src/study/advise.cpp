#include "advise.h"

#include <algorithm>
#include <cmath>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

constexpr int kMostSubsteps = 4096;
/// Error of the converged run, over the error that it judges.
constexpr double kReferencePart = 0.1;
/// Largest number of halvings of the converged run.
constexpr int kHalvings = 4;
/// Fraction of the budget for the converged run.
constexpr double kReferenceBudget = 0.4;
/// Longest step of a candidate, over the scene's.
constexpr int kLongestStep = 2;
/// Runs that take less CPU time are repeated, and the fastest counts [s].
constexpr double kRepeatBelow = 0.05;
constexpr int kRepetitions = 3;
/// A run is stopped when it costs this many times as much as the best: a run with twice the
/// substeps of the best only confirms it.
constexpr double kTooDear = 2.2;
/// Least fraction of the cost that a change must save.
constexpr double kLeastSaving = 0.03;

double costOf(const RunResult& run) { return run.cpuPerSimulatedSecond(); }

class Adviser {
 public:
  Adviser(const AdviceRequest& request, const Announce& announce)
      : request_(request), announce_(announce) {}

  Advice advise() {
    prepareReference();
    chooseMethod();
    if (advice_.best && request_.simplify) {
      for (const Simplification& change : simplificationsOf(advice_.study.scene)) consider(change);
      reduceSubsteps();
    }
    return std::move(advice_);
  }

 private:
  /// A method with the number of substeps of its next run.
  struct Climber {
    const SolverInfo* method;
    double dt;              ///< [s]
    int substeps = 1;       ///< of its next run
    double expected = 0.0;  ///< cost of the next run, from the last one [s/s]
    bool within = false;    ///< the last run kept the bound
    bool done = false;
    WorkPrecisionRow last;
  };

  void prepareReference() {
    const Scene scene = request_.load({});
    advice_.study = studyOf(scene, request_.duration, kLongestStep);
    advice_.bound = request_.bound;
    announce_("the scene's own configuration");
    advice_.own = runScene(advice_.study);
    // A cloth that does not come apart is judged by its positions.
    advice_.study.tearing = !std::isnan(advice_.own.tearing.separation);
    announce_("a converged run");
    advice_.reference = convergeReference(
        advice_.study,
        {kReferencePart * request_.bound, kHalvings, kReferenceBudget * request_.budget});
    advice_.ownError = errorAgainst(advice_.reference, advice_.study, advice_.own);
    advice_.cpuTime = advice_.own.cpuTime + advice_.reference.cpuTime;
  }

  void chooseMethod() {
    const double dt = advice_.study.scene.solver.dt;
    std::vector<const SolverInfo*> all;
    for (const SolverInfo& info : solverRegistry()) all.push_back(&info);
    climb(all, dt);
    if (!advice_.best) return climb(all, 0.25 * dt);
    const std::vector<const SolverInfo*> best{advice_.best->configuration.method};
    climb(best, kLongestStep * dt);
    climb(best, 0.5 * dt);
  }

  /// Runs the method whose next run is the cheapest, again and again, so that expensive runs are
  /// made only while no cheaper one keeps the bound.
  void climb(const std::vector<const SolverInfo*>& methods, double dt) {
    std::vector<Climber> climbers;
    for (const SolverInfo* method : methods) {
      Climber climber;
      climber.method = method;
      climber.dt = dt;
      climbers.push_back(std::move(climber));
    }
    while (mayGoOn()) {
      const auto next = std::min_element(climbers.begin(), climbers.end(), sooner);
      if (next->done) return;
      step(*next);
    }
  }

  static bool sooner(const Climber& a, const Climber& b) {
    return a.done != b.done ? b.done : a.expected < b.expected;
  }

  void step(Climber& climber) {
    WorkPrecisionRow row = attempt(advice_.study, configurationOf(climber));
    advice_.tried.push_back(row);
    const bool within = row.error <= request_.bound;
    const Outcome outcome = row.run.outcome;
    climber.done = (climber.within && within) || outcome == Outcome::kRefused ||
                   outcome == Outcome::kSkipped || climber.substeps >= kMostSubsteps;
    if (climber.within && within) accept(climber.last);
    climber.substeps *= 2;
    climber.expected = 2.0 * costOf(row.run);
    // A run within the bound still needs confirmation; one beyond it only becomes more expensive.
    if (!within && outcome == Outcome::kOk && climber.expected > cheapest()) climber.done = true;
    climber.within = within;
    climber.last = std::move(row);
  }

  static Configuration configurationOf(const Climber& climber) {
    const SolverParameter* iterations = findParameter(*climber.method, "iterations");
    const double count = iterations != nullptr ? iterations->defaultValue : 0.0;
    return configure(*climber.method, climber.dt, climber.substeps,
                     static_cast<int>(std::lround(count)));
  }

  /// Runs a scene and determines its error relative to the unchanged scene.
  WorkPrecisionRow attempt(const StudyScene& scene, const Configuration& configuration) {
    announce_(configuration.method->name + ", " + std::to_string(configuration.substeps) +
              " substeps of " + std::to_string(configuration.dt) + " s");
    StudyScene study = scene;
    study.mostCpuTime = std::min(kTooDear * cheapest() * study.duration,
                                 std::max(request_.budget - advice_.cpuTime, kRepeatBelow));
    WorkPrecisionRow row{study.name, configuration, runScene(study, configuration), 0.0,
                         study.tearing};
    advice_.cpuTime += row.run.cpuTime;
    repeat(study, row);
    row.error = errorOf(study, row.run);
    return row;
  }

  void repeat(const StudyScene& study, WorkPrecisionRow& row) {
    if (row.run.outcome != Outcome::kOk) return;
    for (int k = 1; k < kRepetitions && row.run.cpuTime < kRepeatBelow; ++k) {
      const double again = runScene(study, row.configuration).cpuTime;
      advice_.cpuTime += again;
      row.run.cpuTime = std::min(row.run.cpuTime, again);
    }
  }

  double errorOf(const StudyScene& study, const RunResult& run) const {
    const Grid grid = gridOf(study.scene), original = gridOf(advice_.study.scene);
    if (run.outcome != Outcome::kOk || study.tearing ||
        (grid.columns == original.columns && grid.rows == original.rows)) {
      return errorAgainst(advice_.reference, advice_.study, run);
    }
    RunResult onOriginal = run;
    onOriginal.trajectory = onGrid(run.trajectory, grid, original);
    return errorAgainst(advice_.reference, advice_.study, onOriginal);
  }

  double cheapest() const {  ///< [s/s]
    return advice_.best ? costOf(advice_.best->run) : std::numeric_limits<double>::infinity();
  }

  void accept(const WorkPrecisionRow& row) {
    if (costOf(row.run) < cheapest()) advice_.best = row;
  }

  bool mayGoOn() {
    if (advice_.cpuTime > request_.budget) advice_.complete = false;
    return advice_.complete;
  }

  /// Tries a change on top of those kept, and keeps it if it saves cost within the bound.
  void consider(const Simplification& change) {
    if (!mayGoOn()) return;
    TriedChange tried{change, {}, std::numeric_limits<double>::quiet_NaN(), cheapest(), false};
    if (change.overrides.empty() || madeCoarser(change)) {
      if (change.overrides.empty()) advice_.changes.push_back(tried);
      return;
    }
    std::vector<std::string> overrides = advice_.overrides;
    overrides.insert(overrides.end(), change.overrides.begin(), change.overrides.end());
    try {
      const StudyScene study = changed(overrides);
      const WorkPrecisionRow row = attempt(study, advice_.best->configuration);
      tried.run = row.run;
      tried.error = row.error;
      tried.made = row.error <= request_.bound && tried.saved() >= kLeastSaving;
      if (tried.made) {
        advice_.best = row;
        advice_.overrides = std::move(overrides);
      }
    } catch (const SceneError& error) {
      tried.change.obstacle = error.what();
    }
    advice_.changes.push_back(std::move(tried));
  }

  /// Tells whether `change` is a resolution and a coarser one was kept already.
  bool madeCoarser(const Simplification& change) const {
    const auto isResolution = [](const std::string& text) {
      return text.rfind("cloth.particles=", 0) == 0;
    };
    return isResolution(change.overrides.front()) &&
           std::any_of(advice_.overrides.begin(), advice_.overrides.end(), isResolution);
  }

  StudyScene changed(const std::vector<std::string>& overrides) const {
    StudyScene study = advice_.study;
    study.scene = request_.load(overrides);
    return study;
  }

  /// Tries fewer substeps for the simplified scene.
  void reduceSubsteps() {
    if (advice_.overrides.empty()) return;
    const StudyScene study = changed(advice_.overrides);
    for (const double part : {0.5, 0.5, 0.5, 0.75}) {
      Configuration fewer = advice_.best->configuration;
      const int substeps = static_cast<int>(std::lround(part * fewer.substeps));
      if (substeps < 1 || substeps == fewer.substeps || !mayGoOn()) continue;
      fewer.substeps = substeps;
      const WorkPrecisionRow row = attempt(study, fewer);
      if (row.error <= request_.bound) accept(row);
    }
  }

  const AdviceRequest& request_;
  const Announce& announce_;
  Advice advice_;
};

}  // namespace

Advice advise(const AdviceRequest& request, const Announce& announce) {
  return Adviser(request, announce).advise();
}

}  // namespace cloth_sim
