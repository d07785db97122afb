#include "reference.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/build.h"
#include "support/csv.h"
#include "support/input_file.h"

namespace cloth_sim {
namespace {

/// The steps of the coarsest run are the scene's, divided by this.
constexpr int kStepDivision = 2;
/// Substep of the coarsest run, relative to the longest stable one.
constexpr double kStepMargin = 0.5;
/// Relative difference of figures by rounding on another machine.
constexpr double kSameFigure = 1e-9;
constexpr std::uint64_t kMaxReferenceSize = 1ULL << 30;  // [bytes]

/// Tells whether a method is explicit and of second order: its limit of omega h is finite, not
/// zero.
bool isReferenceMethod(const SolverInfo& info) {
  return info.order == 2 && info.stabilityLimit > 0.0 && std::isfinite(info.stabilityLimit);
}

double difference(const StudyScene& study, const RunResult& run, const RunResult& finer) {
  Reference reference;
  reference.trajectory = finer.trajectory;
  reference.tearing = finer.tearing;
  return errorAgainst(reference, study, run);
}

/// Returns a few sums over everything in a scene that decides its motion.
std::vector<double> figuresOf(const StudyScene& study) {
  const Model model = buildModel(study.scene.cloths);
  const State state = initialState(study.scene.cloths, model, study.scene.seed);
  double stiffness = 0.0, damping = 0.0, rest = 0.0, ends = 0.0;
  for (const Spring& spring : model.springs.slots()) {
    stiffness += spring.stiffness;
    damping += spring.damping;
    rest += spring.restLength;
    ends += spring.stiffness * (spring.a + 2.0 * spring.b);
  }
  double place = 0.0, speed = 0.0;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    place += (v + 1.0) * state.x[v].norm();
    speed += (v + 1.0) * state.v[v].norm();
  }
  double pins = 0.0;
  for (const KinematicTarget& pin : pinTargets(study.scene.cloths, model, state)) {
    pins += pin.vertex + 1.0;
  }
  const Vec3& g = study.scene.gravity;
  return {totalMass(model),
          stiffness,
          damping,
          rest,
          ends,
          place,
          speed,
          pins,
          study.scene.drag,
          g.x() + 2.0 * g.y() + 3.0 * g.z(),
          study.duration};
}

bool sameFigures(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double p, double q) {
    return std::abs(p - q) <= kSameFigure * std::max({1e-6, std::abs(p), std::abs(q)});
  });
}

/// Reads numbers separated by spaces.
std::vector<double> numbersIn(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> numbers;
  for (double number = 0.0; in >> number;) numbers.push_back(number);
  return numbers;
}

/// Returns the rest of a line that begins with `key`; nothing for other lines.
std::optional<std::string> after(const std::string& key, const std::string& line) {
  if (line.compare(0, key.size(), key) != 0) return std::nullopt;
  return line.substr(key.size());
}

const char* const kSource = "# source: ";
const char* const kFigures = "# figures of the scene: ";
const char* const kOwnError = "# own error: ";

/// Adds a row "t,vertex,x,y,z" to a trajectory. Rows are ordered by time, then by vertex.
void addRow(const CsvRow& row, Trajectory& trajectory) {
  const double time = row.number("t");
  if (trajectory.times.empty() || time > trajectory.times.back()) {
    trajectory.times.push_back(time);
    trajectory.positions.emplace_back();
  }
  std::vector<Vec3>& positions = trajectory.positions.back();
  if (row.number("vertex") != static_cast<double>(positions.size())) {
    throw std::invalid_argument("vertices are not in order");
  }
  positions.emplace_back(row.number("x"), row.number("y"), row.number("z"));
}

}  // namespace

const SolverInfo& referenceMethod() {
  for (const SolverInfo& info : solverRegistry()) {
    if (isReferenceMethod(info)) return info;
  }
  throw std::runtime_error("the registry has no explicit method of second order for references");
}

double errorAgainst(const Reference& reference, const StudyScene& study, const RunResult& run) {
  if (run.outcome != Outcome::kOk) return std::numeric_limits<double>::quiet_NaN();
  if (!study.tearing) {
    return trajectoryError(run.trajectory, reference.trajectory, study.side());
  }
  return std::abs(run.tearing.separation / reference.tearing.separation - 1.0);
}

Reference convergeReference(const StudyScene& study, const ConvergenceGoal& goal) {
  const SolverInfo& method = referenceMethod();
  double dt = study.scene.solver.dt / kStepDivision;
  const double longest = kStepMargin * stableStep(buildModel(study.scene.cloths));
  const int substeps = std::max(1, static_cast<int>(std::ceil(dt / longest)));
  RunResult run = runScene(study, configure(method, dt, substeps, 0));
  Reference reference;
  reference.converged = false;
  reference.cpuTime = run.cpuTime;
  for (int k = 0; k < goal.halvings && !reference.converged; ++k) {
    if (k > 0 && reference.cpuTime + 2.0 * run.cpuTime > goal.mostCpuTime) break;
    dt *= 0.5;
    RunResult finer = runScene(study, configure(method, dt, substeps, 0));
    reference.ownError = difference(study, run, finer);
    reference.converged = reference.ownError <= goal.tolerance;
    reference.cpuTime += finer.cpuTime;
    run = std::move(finer);
  }
  if (run.outcome != Outcome::kOk) throw std::runtime_error(study.name + ": " + run.why);
  reference.trajectory = std::move(run.trajectory);
  reference.tearing = run.tearing;
  std::ostringstream source;
  source << method.name << " with steps of " << dt << " s and " << substeps << " substeps";
  reference.source = source.str();
  return reference;
}

void writeReference(std::ostream& out, const StudyScene& study, const Reference& reference) {
  out << "# Reference of config/study/" << study.name << ".yaml: positions [m] at times [s].\n"
      << "# Made by: rosrun cloth_sim cloth_study --make-references DIR\n"
      << kSource << reference.source << '\n'
      << kOwnError << reference.ownError << '\n'
      << kFigures << std::setprecision(17);
  for (const double figure : figuresOf(study)) out << figure << ' ';
  out << "\nt,vertex,x,y,z\n" << std::setprecision(12);
  for (std::size_t k = 0; k < reference.trajectory.times.size(); ++k) {
    const std::vector<Vec3>& x = reference.trajectory.positions[k];
    for (std::size_t v = 0; v < x.size(); ++v) {
      out << reference.trajectory.times[k] << ',' << v << ',' << x[v].x() << ',' << x[v].y() << ','
          << x[v].z() << '\n';
    }
  }
}

Reference readReference(const std::string& file, const StudyScene& study) {
  std::istringstream in(readInputFile(file, {kMaxReferenceSize, Links::kFollowed}));
  Reference reference;
  std::vector<double> figures;
  const auto readComment = [&](const std::string& line) {
    if (const auto source = after(kSource, line)) reference.source = *source;
    if (const auto error = after(kOwnError, line)) reference.ownError = parseNumber(*error);
    if (const auto text = after(kFigures, line)) figures = numbersIn(*text);
  };
  try {
    readCsv(
        in, {"t", "vertex", "x", "y", "z"},
        [&](const CsvRow& row) { addRow(row, reference.trajectory); }, readComment);
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
  if (!sameFigures(figures, figuresOf(study)) ||
      reference.trajectory.times.size() != study.samples.size()) {
    throw std::runtime_error(file + ": is of another version of the scene (make it anew with " +
                             "cloth_study --make-references)");
  }
  return reference;
}

std::string referenceFile(const std::string& folder, const std::string& name) {
  return folder + "/" + name + ".reference.csv";
}

}  // namespace cloth_sim
