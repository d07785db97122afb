#include "advise.h"

#include <algorithm>
#include <cmath>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

constexpr int kMostSubsteps = 4096;
/// The converged run shall be better than what it judges by this factor ...
constexpr double kReferencePart = 0.1;
/// ... and is divided this often for that, at most ...
constexpr int kHalvings = 4;
/// ... with this part of the budget.
constexpr double kReferenceBudget = 0.4;
/// Candidates have steps up to this many times the scene's.
constexpr int kLongestStep = 2;
/// Runs that take less are repeated, and the best counts [s of CPU time].
constexpr double kRepeatBelow = 0.05;
constexpr int kRepetitions = 3;
/// A run that costs this many times as much as the best is of no interest: the one with twice its
/// substeps only confirms.
constexpr double kTooDear = 2.2;
/// A change that saves less than this part is not worth making.
constexpr double kLeastSaving = 0.03;

double costOf(const RunResult& run) { return run.cpuPerSimulatedSecond(); }

class Adviser {
 public:
  Adviser(const AdviceRequest& request, const Announce& announce)
      : request_(request), announce_(announce) {}

  Advice advise() {
    look();
    chooseMethod();
    if (advice_.best && request_.simplify) {
      for (const Simplification& change : simplificationsOf(advice_.study.scene)) consider(change);
      lighten();
    }
    return std::move(advice_);
  }

 private:
  /// A method on its way up the substeps.
  struct Climber {
    const SolverInfo* method;
    double dt;              ///< [s]
    int substeps = 1;       ///< of its next run
    double expected = 0.0;  ///< what that will cost, by the run before [s/s]
    bool within = false;    ///< the run before
    bool done = false;
    WorkPrecisionRow last;
  };

  void look() {
    const Scene scene = request_.load({});
    advice_.study = studyOf(scene, request_.duration, kLongestStep);
    advice_.bound = request_.bound;
    announce_("the scene's own configuration");
    advice_.own = runScene(advice_.study);
    // Where it does not come apart, positions are what there is to compare.
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

  /// Always the one whose next run will cost least: so the dear runs are made only as long as no
  /// cheaper one keeps the bound.
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
    // What is within the bound still needs its confirmation; what is not gets only dearer.
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

  /// One run, and its error against the scene as it is.
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

  /// Tries a change on top of those made, and makes it if it keeps the bound and saves something.
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

  /// Of several resolutions the coarsest that will do has been made.
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

  /// Fewer substeps, now that the scene is a simpler one.
  void lighten() {
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
