#include "run.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cloth_sim/sim/simulation.h"
#include "support/cpu_clock.h"

namespace cloth_sim {
namespace {

/// A particle farther from the origin than this many sides of the cloth counts as diverged.
constexpr double kFarAway = 1e3;

/// Steps a simulation to its end and records its cost, trajectory and tears.
class TimedRun {
 public:
  TimedRun(const StudyScene& study, Simulation& simulation)
      : study_(study), simulation_(simulation) {}

  RunResult run() {
    const double half = 0.5 * simulation_.scene().solver.dt;
    while (simulation_.time() < study_.duration - half && !over()) step();
    result_.simulatedTime = simulation_.time();
    result_.tearing.torn = simulation_.broken().torn;
    return std::move(result_);
  }

 private:
  bool over() const {
    if (result_.outcome != Outcome::kOk) return true;
    return study_.tearing && simulation_.pieces() > 1;
  }

  void step() {
    const double start = threadCpuTime();
    simulation_.step();
    result_.cpuTime += threadCpuTime() - start;
    checkFailure();
    if (result_.cpuTime > study_.mostCpuTime) giveUp();
    noteTears();
    if (result_.outcome == Outcome::kOk) {
      result_.largestStretch = std::max(result_.largestStretch, simulation_.observeMaxStretch());
      noteSample();
    }
  }

  void checkFailure() {
    const double far = kFarAway * study_.side();
    const auto isFar = [far](const Vec3& x) { return !(x.cwiseAbs().maxCoeff() < far); };
    const std::vector<Vec3>& x = simulation_.state().x.values();
    if (simulation_.failed()) {
      diverged(simulation_.failure());
    } else if (std::any_of(x.begin(), x.end(), isFar)) {
      diverged("particles flew away");
    }
  }

  void giveUp() {
    if (result_.outcome != Outcome::kOk) return;
    result_.outcome = Outcome::kSkipped;
    result_.why = "it takes too long";
  }

  void diverged(const std::string& why) {
    result_.outcome = Outcome::kDiverged;
    result_.why = why;
  }

  void noteTears() {
    TearRecord& record = result_.tearing;
    for (const FailureEvent& event : simulation_.takeEvents()) {
      if (event.cause != FailureCause::kTear) continue;
      if (std::isnan(record.firstFailure)) record.firstFailure = event.time;
      lastTear_ = event.time;
    }
    // The last failure parted the cloth; events have the time within the step.
    if (simulation_.pieces() > 1 && std::isnan(record.separation)) record.separation = lastTear_;
  }

  void noteSample() {
    const std::size_t next = result_.trajectory.times.size();
    const double half = 0.5 * simulation_.scene().solver.dt;
    if (next >= study_.samples.size() || simulation_.time() < study_.samples[next] - half) return;
    result_.trajectory.times.push_back(simulation_.time());
    result_.trajectory.positions.push_back(simulation_.state().x.values());
  }

  const StudyScene& study_;
  Simulation& simulation_;
  RunResult result_;
  double lastTear_ = 0.0;
};

void setIfKnown(const SolverInfo& info, const char* name, int value, SolverParameters& given) {
  if (findParameter(info, name) != nullptr) given[name] = value;
}

RunResult refused(const std::string& why) {
  RunResult result;
  result.outcome = Outcome::kRefused;
  result.why = why;
  return result;
}

RunResult runAs(const StudyScene& study, const Scene& scene) {
  try {
    Simulation simulation(scene);
    return TimedRun(study, simulation).run();
  } catch (const std::invalid_argument& error) {
    return refused(error.what());
  }
}

}  // namespace

Configuration configure(const SolverInfo& method, double dt, int substeps, int iterations) {
  Configuration result{&method, dt, substeps, iterations};
  if (findParameter(method, "substeps") == nullptr) {
    result.dt = dt / substeps;
    result.substeps = 1;
  }
  if (findParameter(method, "iterations") == nullptr) result.iterations = 0;
  return result;
}

Scene withConfiguration(Scene scene, const Configuration& configuration) {
  const SolverInfo& method = *configuration.method;
  SolverParameters given;
  setIfKnown(method, "substeps", configuration.substeps, given);
  setIfKnown(method, "iterations", configuration.iterations, given);
  scene.solver.method = method.name;
  scene.solver.dt = configuration.dt;
  scene.solver.realTimeBudget.reset();
  scene.solver.guard = StepGuard::kAllow;  // no repair of steps that are too long
  scene.solver.sleep.reset();              // every step is computed
  scene.solver.parameters = completeParameters(method, given);
  return scene;
}

const char* toString(Outcome outcome) {
  switch (outcome) {
    case Outcome::kOk:
      return "ok";
    case Outcome::kDiverged:
      return "diverged";
    case Outcome::kWrong:
      return "wrong";
    case Outcome::kRefused:
      return "refused";
    case Outcome::kSkipped:
      return "skipped";
  }
  return "";
}

RunResult runScene(const StudyScene& study) {
  Scene awake = study.scene;
  awake.solver.sleep.reset();
  return runAs(study, awake);
}

RunResult runScene(const StudyScene& study, const Configuration& configuration) {
  try {
    return runAs(study, withConfiguration(study.scene, configuration));
  } catch (const std::invalid_argument& error) {
    return refused(error.what());
  }
}

double trajectoryError(const Trajectory& trajectory, const Trajectory& reference, double side) {
  const auto& a = trajectory.positions;
  const auto& b = reference.positions;
  const double none = std::numeric_limits<double>::infinity();
  if (a.empty() || a.size() != b.size()) return none;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].size() != b[k].size()) return none;
    for (std::size_t p = 0; p < a[k].size(); ++p) sum += (a[k][p] - b[k][p]).squaredNorm();
    count += a[k].size();
  }
  const double error = std::sqrt(sum / static_cast<double>(count)) / side;
  return std::isfinite(error) ? error : none;
}

}  // namespace cloth_sim
