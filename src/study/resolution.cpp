#include "cloth_sim/study/resolution.h"

#include <cmath>
#include <functional>
#include <limits>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/sim/build.h"
#include "cloth_sim/sim/simulation.h"
#include "cpu_clock.h"

namespace cloth_sim {
namespace {

constexpr double kSide = 0.5;    ///< of the cloth [m]
constexpr double kMargin = 0.7;  ///< part of the longest stable step
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSwing = M_PI / 9.0;  ///< [rad]
constexpr double kSettling = 8.0;      ///< drag that brings a cloth to rest [1/s]
constexpr double kSphere = 0.15;       ///< radius [m]

/// What is measured: a scene, and a figure that builds up while it runs.
struct Experiment {
  std::string quantity;
  std::string unit;
  Scene scene;
  double duration = 0.0;  ///< [s]
  /// Called after every step; the last value that it returns counts.
  std::function<double(const Simulation&)> measure;
};

Scene baseScene(int particles) {
  Scene scene;
  scene.cloth.columns = scene.cloth.rows = particles;
  scene.cloth.width = scene.cloth.height = kSide;
  scene.cloth.fabric = fabricPreset("interlock");
  return scene;
}

Pose tilted(double angle) {
  Pose pose;
  pose.orientation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
  return pose;
}

/// A row of particles across the cloth.
std::vector<PinSpec> upperEdge(int n) {
  std::vector<PinSpec> pins;
  for (int k = 0; k < n; ++k) pins.push_back({k, n - 1});
  return pins;
}

Experiment sag(int n) {
  Experiment experiment{"sag", "m", baseScene(n), 1.5, {}};
  experiment.scene.cloth.pose = tilted(0.5 * M_PI);  // v points up
  experiment.scene.cloth.pins = upperEdge(n);
  experiment.scene.drag = kSettling;
  experiment.measure = [n](const Simulation& simulation) {
    double height = 0.0;
    for (VertexId v = 0; v < n; ++v) height += simulation.state().x[v].z() / n;
    return -0.5 * kSide - height;
  };
  return experiment;
}

Experiment drape(int n) {
  Experiment experiment{"drape_radius", "m", baseScene(n), 1.5, {}};
  Obstacle sphere;
  sphere.name = "sphere";
  sphere.shape = SphereShape{kSphere};
  sphere.pose.position.z() = -kSphere - 1e-3;
  sphere.friction = 0.5;
  experiment.scene.obstacles = {sphere};
  experiment.scene.drag = kSettling;
  experiment.measure = [n](const Simulation& simulation) {
    const Grid& grid = *simulation.model().grid;
    double sum = 0.0;
    for (int k = 0; k + 1 < n; ++k) {
      for (const VertexId v : {grid.vertex(k, 0), grid.vertex(n - 1, k), grid.vertex(k + 1, n - 1),
                               grid.vertex(0, k + 1)}) {
        sum += simulation.state().x[v].head<2>().norm();
      }
    }
    return sum / (4.0 * (n - 1));
  };
  return experiment;
}

/// Twice the time between two passages of the centre of mass below the pins.
class PeriodMeter {
 public:
  double operator()(const Simulation& simulation) {
    const Vec3 centre = centreOfMass(simulation.model(), simulation.state());
    const double across = centre.y() - pinY_;
    if (before_ != 0.0 && (across > 0.0) != (before_ > 0.0)) {
      const double crossing =
          simulation.time() - (simulation.time() - time_) * across / (across - before_);
      if (!std::isnan(crossing_)) period_ = 2.0 * (crossing - crossing_);
      crossing_ = crossing;
    }
    before_ = across;
    time_ = simulation.time();
    return period_;
  }
  explicit PeriodMeter(double pinY) : pinY_(pinY) {}

 private:
  double pinY_;  ///< [m]
  double before_ = 0.0;
  double time_ = 0.0;
  double crossing_ = kNone;
  double period_ = kNone;
};

Experiment swing(int n) {
  Experiment experiment{"swing_period", "s", baseScene(n), 1.2, {}};
  const double angle = 0.5 * M_PI - kSwing;
  experiment.scene.cloth.pose = tilted(angle);
  experiment.scene.cloth.pins = upperEdge(n);
  experiment.measure = PeriodMeter(0.5 * kSide * std::cos(angle));
  return experiment;
}

ResolutionRow run(Experiment experiment) {
  const double dt = experiment.scene.solver.dt;
  const double longest = kMargin * stableStep(buildModel(experiment.scene.cloth));
  const int substeps = static_cast<int>(std::ceil(dt / longest));
  const Configuration configuration = configure(referenceMethod(), dt, substeps, 0);
  Simulation simulation(withConfiguration(experiment.scene, configuration));
  ResolutionRow row;
  row.quantity = experiment.quantity;
  row.unit = experiment.unit;
  row.particles = experiment.scene.cloth.columns;
  row.substeps = substeps;
  row.value = kNone;
  double cpu = 0.0;
  while (simulation.time() < experiment.duration - 0.5 * dt && !simulation.failed()) {
    const double start = threadCpuTime();
    simulation.step();
    cpu += threadCpuTime() - start;
    row.value = experiment.measure(simulation);
  }
  if (simulation.failed()) row.value = kNone;
  row.cpuPerSimulatedSecond = cpu / simulation.time();
  return row;
}

}  // namespace

std::vector<ResolutionRow> measureResolution(const std::vector<int>& particles,
                                             const Announce& announce) {
  std::vector<ResolutionRow> rows;
  for (const auto& experiment : {sag, drape, swing}) {
    const std::size_t first = rows.size();
    for (const int n : particles) {
      announce("resolution, " + std::to_string(n) + " particles a side");
      rows.push_back(run(experiment(n)));
    }
    for (std::size_t k = first; k < rows.size(); ++k) {
      rows[k].difference = rows[k].value / rows.back().value - 1.0;
    }
  }
  return rows;
}

}  // namespace cloth_sim
