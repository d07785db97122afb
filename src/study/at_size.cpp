#include "at_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/cloth/strain.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/sim/simulation.h"
#include "reference.h"
#include "support/cpu_clock.h"

namespace cloth_sim {
namespace {

constexpr double kReferenceMargin = 0.35;  ///< part of the longest stable step
constexpr int kStepsPerSample = 3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A scene with the time that it runs.
struct Motion {
  std::string name;
  Scene scene;
  double duration = 0.0;  ///< [s]
};

Scene cottonSquare(int particles) {
  Scene scene;
  ClothSpec& cloth = scene.cloths[0];
  cloth.columns = cloth.rows = particles;
  cloth.width = cloth.height = 1.0;
  cloth.fabric = fabricPreset("cotton");
  scene.drag = 0.5;
  return scene;
}

Motion edgeSwing(int n) {
  Motion motion{"swing", cottonSquare(n), 0.8};
  ClothSpec& cloth = motion.scene.cloths[0];
  cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.25 * M_PI, Vec3::UnitX()));
  for (int k = 0; k < n; ++k) cloth.pins.push_back({k, n - 1});
  return motion;
}

Motion cornerHang(int n) {
  Motion motion{"hang", cottonSquare(n), 1.5};
  motion.scene.cloths[0].pins = {{0, n - 1}, {n - 1, n - 1}};
  return motion;
}

/// A method with its settings.
struct Setting {
  std::string method;
  int substeps = 0;
  int iterations = 0;
  double error = 0.0;
};

Scene withSetting(const Scene& scene, const Setting& setting) {
  const SolverInfo& method = findSolver(setting.method);
  Scene result = withConfiguration(
      scene, configure(method, scene.solver.dt, std::max(1, setting.substeps), setting.iterations));
  if (setting.error > 0.0) result.solver.parameters["error"] = setting.error;
  return result;
}

std::vector<Setting> settings() {
  std::vector<Setting> all;
  for (const int n : {10, 20, 40, 80}) all.push_back({"xpbd", n, 0, 0.0});
  for (const int n : {8, 10, 14, 20, 30, 40}) all.push_back({"line_xpbd", n, 0, 0.0});
  for (const double error : {0.02, 0.01}) all.push_back({"line_xpbd", 0, 0, error});
  all.push_back({"projective", 1, 1, 0.0});
  all.push_back({"projective", 10, 1, 0.0});
  all.push_back({"projective", 20, 2, 0.0});
  return all;
}

/// The cloth at one time, but for its positions.
struct Sample {
  std::vector<double> strains;  ///< of structural and shear springs [-]
  Vec3 force = Vec3::Zero();    ///< on all pins [N]
  double energy = 0.0;          ///< kinetic, elastic and potential [J]
};

struct Record {
  Trajectory trajectory;
  std::vector<Sample> samples;  ///< at the times of the trajectory
  double cost = 0.0;            ///< [s] per step
  std::string failure;
  std::optional<ErrorEstimate> estimate;
};

std::vector<double> strainsOf(const Simulation& simulation) {
  std::vector<double> strains;
  for (const Spring spring : simulation.model().springs.slots()) {
    if (!spring.exists() || !traitsOf(spring.kind).isMembrane) continue;
    strains.push_back(strainOfStretch(stretch(spring, simulation.state())));
  }
  return strains;
}

Sample sampleOf(const Simulation& simulation) {
  Sample sample;
  sample.strains = strainsOf(simulation);
  for (const Vec3& reaction : simulation.lastReport().reactions) sample.force += reaction;
  const Energies energy =
      energies(simulation.model(), simulation.state(), simulation.scene().gravity);
  sample.energy = energy.kinetic + energy.elastic + energy.gravity;
  return sample;
}

Record record(const Motion& motion, const Setting& setting) {
  Record result;
  Simulation simulation(withSetting(motion.scene, setting));
  const int steps = static_cast<int>(std::lround(motion.duration / motion.scene.solver.dt));
  for (int k = 1; k <= steps && !simulation.failed(); ++k) {
    const double start = threadCpuTime();
    simulation.step();
    result.cost += (threadCpuTime() - start) / steps;
    if (k % kStepsPerSample != 0 && k != steps) continue;
    result.trajectory.times.push_back(simulation.time());
    result.trajectory.positions.push_back(simulation.state().x.values());
    result.samples.push_back(sampleOf(simulation));
  }
  result.failure = simulation.failure();
  result.estimate = simulation.lastReport().error;
  return result;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

double percentile999(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> differences(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) differences[k] = std::abs(a[k] - b[k]);
  const auto at =
      differences.begin() + static_cast<std::ptrdiff_t>(differences.size() * 999 / 1000);
  std::nth_element(differences.begin(), at, differences.end());
  return *at;
}

/// The energy that gravity releases when the cloth falls by half its side: the scale of errors [J].
double energyScale(const Motion& motion) {
  const ClothSpec& cloth = motion.scene.cloths[0];
  return cloth.fabric.arealDensity * cloth.width * cloth.height * 9.81 * 0.5 * cloth.height;
}

/// Fills in the errors of a run.
void compare(const Motion& motion, const Record& run, const Record& reference, AtSizeRow& row) {
  double forces = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < reference.samples.size(); ++k) {
    const Sample& a = run.samples[k];
    const Sample& b = reference.samples[k];
    row.strain = std::max(row.strain, std::abs(largest(a.strains) - largest(b.strains)));
    row.strain999 = std::max(row.strain999, percentile999(a.strains, b.strains));
    forces += (a.force - b.force).squaredNorm();
    scale += b.force.squaredNorm();
    row.energy = std::max(row.energy, std::abs(a.energy - b.energy) / energyScale(motion));
  }
  row.position =
      trajectoryError(run.trajectory, reference.trajectory, longestSide(motion.scene.cloths));
  row.force = std::sqrt(forces / scale);
}

AtSizeRow judged(const Motion& motion, const Setting& setting, const Record& run,
                 const Record& reference) {
  AtSizeRow row;
  row.scene = motion.name;
  row.particles = motion.scene.cloths[0].columns;
  row.method = setting.method;
  row.substeps = setting.substeps;
  row.iterations = setting.iterations;
  row.error = setting.error;
  row.cost = run.cost;
  row.estimatedPosition = run.estimate ? run.estimate->largestPosition : kNan;
  row.estimatedStrain = run.estimate ? run.estimate->largestStrain : kNan;
  row.status = run.failure.empty() ? "ok" : run.failure;
  if (run.failure.empty()) {
    compare(motion, run, reference, row);
  } else {
    row.position = row.strain = row.strain999 = row.force = row.energy = kNan;
  }
  return row;
}

std::vector<AtSizeRow> measure(const Motion& motion) {
  const double longest = kReferenceMargin * stableStep(buildModel(motion.scene.cloths));
  const int substeps = static_cast<int>(std::ceil(motion.scene.solver.dt / longest));
  const Setting fine{referenceMethod().name, substeps, 0, 0.0};
  const Setting coarse{referenceMethod().name, substeps / 2, 0, 0.0};
  const Record reference = record(motion, fine);
  std::vector<AtSizeRow> rows{judged(motion, fine, record(motion, coarse), reference)};
  rows.front().cost = reference.cost;
  rows.front().status = "reference";
  for (const Setting& setting : settings()) {
    rows.push_back(judged(motion, setting, record(motion, setting), reference));
  }
  return rows;
}

}  // namespace

std::vector<AtSizeRun> atSizeRuns(const std::vector<int>& particles) {
  std::vector<AtSizeRun> runs;
  for (const auto& motion : {edgeSwing, cornerHang}) {
    for (const int n : particles) {
      runs.push_back({motion(2).name, n, [motion, n] { return measure(motion(n)); }});
    }
  }
  return runs;
}

void writeAtSize(std::ostream& out, const std::vector<AtSizeRow>& rows) {
  out << "scene,particles,method,substeps,iterations,error,ms_per_frame,real_time_factor,"
         "position_error,strain_error,strain_error_999,force_error,energy_error,"
         "estimated_position,estimated_strain,status\n";
  for (const AtSizeRow& row : rows) {
    out << row.scene << ',' << row.particles << ',' << row.method << ',' << row.substeps << ','
        << row.iterations << ',' << row.error << ',' << 1e3 * row.cost << ','
        << 1.0 / (60.0 * row.cost) << ',' << row.position << ',' << row.strain << ','
        << row.strain999 << ',' << row.force << ',' << row.energy << ',' << row.estimatedPosition
        << ',' << row.estimatedStrain << ',' << row.status << '\n';
  }
}

}  // namespace cloth_sim
