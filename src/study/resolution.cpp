#include "resolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/sim/simulation.h"
#include "drape_radius.h"
#include "reference.h"
#include "support/cpu_clock.h"

namespace cloth_sim {
namespace {

constexpr double kSide = 0.5;          ///< of the cloth [m]
constexpr double kStableMargin = 0.7;  ///< part of the longest stable step
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSwing = M_PI / 9.0;   ///< angle of release [rad]
constexpr double kSettling = 8.0;       ///< drag that brings a cloth to rest [1/s]
constexpr double kSphere = 0.15;        ///< radius of the sphere [m]
constexpr double kHoop = 0.2;           ///< radius of the hoop [m]
constexpr double kHoopSettling = 20.0;  ///< drag in the hoop [1/s]

/// A measured quantity.
struct Quantity {
  std::string name;
  std::string unit;
};

/// A scene with the quantities that are measured while it runs.
struct Experiment {
  std::vector<Quantity> quantities;
  Scene scene;
  double duration = 0.0;  ///< [s]
  /// Called after every step; returns one value for each quantity. The last values count.
  std::function<std::vector<double>(const Simulation&)> measure;
};

Scene baseScene(int particles) {
  Scene scene;
  scene.cloths[0].columns = scene.cloths[0].rows = particles;
  scene.cloths[0].width = scene.cloths[0].height = kSide;
  scene.cloths[0].fabric = fabricPreset("interlock");
  return scene;
}

Pose tilted(double angle) {
  Pose pose;
  pose.orientation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
  return pose;
}

/// Returns pins along the upper edge of n particles.
std::vector<PinSpec> upperEdge(int n) {
  std::vector<PinSpec> pins;
  for (int k = 0; k < n; ++k) pins.push_back({k, n - 1});
  return pins;
}

Experiment sag(int n) {
  Experiment experiment{{{"sag", "m"}}, baseScene(n), 1.5, {}};
  experiment.scene.cloths[0].pose = tilted(0.5 * M_PI);  // v points up
  experiment.scene.cloths[0].pins = upperEdge(n);
  experiment.scene.drag = kSettling;
  experiment.measure = [n](const Simulation& simulation) {
    double height = 0.0;
    for (VertexId v = 0; v < n; ++v) height += simulation.state().x[v].z() / n;
    return std::vector<double>{-0.5 * kSide - height};
  };
  return experiment;
}

Experiment drape(int n) {
  Experiment experiment{{{"drape_radius", "m"}}, baseScene(n), 1.0, {}};
  Obstacle sphere;
  sphere.name = "sphere";
  sphere.shape = SphereShape{kSphere};
  sphere.pose.position.z() = -kSphere - 1e-3;
  sphere.friction = 0.5;
  experiment.scene.obstacles = {sphere};
  experiment.scene.drag = kSettling;
  experiment.measure = [](const Simulation& simulation) {
    const Grid& grid = *simulation.model().cloths[0].grid;
    return std::vector<double>{borderRadius(grid, simulation.state().x.values())};
  };
  return experiment;
}

/// Measures the period: twice the time between two passages of the centre of mass below the pins.
class PeriodMeter {
 public:
  std::vector<double> operator()(const Simulation& simulation) {
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
    return {period_};
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
  Experiment experiment{{{"swing_period", "s"}}, baseScene(n), 1.2, {}};
  const double angle = 0.5 * M_PI - kSwing;
  experiment.scene.cloths[0].pose = tilted(angle);
  experiment.scene.cloths[0].pins = upperEdge(n);
  experiment.measure = PeriodMeter(0.5 * kSide * std::cos(angle));
  return experiment;
}

/// Returns the fabric with equal stiffness in all directions: C11 - C12 = 2 C66 with C12 = C66 = G
/// is C11 = 3 G, of which the tensile stiffness is C11 - C12^2 / C11 = 8/3 G (see SpringNetwork).
Fabric isotropic(Fabric fabric) {
  fabric.tensileWeft = fabric.tensileWarp;
  fabric.shear = 3.0 / 8.0 * fabric.tensileWarp;
  return fabric;
}

Vec2 fromMiddle(const Grid& grid, int column, int row) {
  return {column * grid.spacingU() - 0.5 * kSide, row * grid.spacingV() - 0.5 * kSide};
}

/// Returns the depth of the point at material coordinates `at` from the centre, by bilinear
/// interpolation [m].
double depth(const Simulation& simulation, const Vec2& at) {
  const Grid& grid = *simulation.model().cloths[0].grid;
  const Vec2 cell = (at + 0.5 * Vec2(kSide, kSide)) / grid.spacingU();
  const int i = std::clamp(static_cast<int>(cell.x()), 0, grid.columns - 2);
  const int j = std::clamp(static_cast<int>(cell.y()), 0, grid.rows - 2);
  const double p = cell.x() - i, q = cell.y() - j;
  const auto z = [&](int column, int row) {
    return simulation.state().x[grid.vertex(column, row)].z();
  };
  return -((1 - p) * (1 - q) * z(i, j) + p * (1 - q) * z(i + 1, j) + (1 - p) * q * z(i, j + 1) +
           p * q * z(i + 1, j + 1));
}

/// Returns the mean depth at half the hoop's radius in two opposite directions [m].
double depthAlong(const Simulation& simulation, double angle) {
  const Vec2 at = 0.5 * kHoop * Vec2(std::cos(angle), std::sin(angle));
  return 0.5 * (depth(simulation, at) + depth(simulation, -at));
}

std::vector<double> hoopFigures(const Simulation& simulation) {
  const double warp = depthAlong(simulation, 0.0);
  const double along = depthAlong(simulation, 0.25 * M_PI);  // faces are split along this diagonal
  const double weft = depthAlong(simulation, 0.5 * M_PI);
  const double across = depthAlong(simulation, 0.75 * M_PI);
  const double mean = 0.25 * (warp + weft + along + across);
  return {mean, 0.5 * (along + across - warp - weft) / mean, (along - across) / mean};
}

Experiment hoop(int n) {
  Experiment experiment{
      {{"hoop_sag", "m"}, {"hoop_bias", "1"}, {"hoop_skew", "1"}}, baseScene(n), 1.0, hoopFigures};
  ClothSpec& cloth = experiment.scene.cloths[0];
  cloth.fabric = isotropic(cloth.fabric);
  const Grid grid{n, n, kSide, kSide};
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      if (fromMiddle(grid, column, row).norm() >= kHoop) cloth.pins.push_back({column, row});
    }
  }
  experiment.scene.drag = kHoopSettling;
  return experiment;
}

std::vector<ResolutionRow> run(const Experiment& experiment) {
  const double dt = experiment.scene.solver.dt;
  const double longest = kStableMargin * stableStep(buildModel(experiment.scene.cloths));
  const int substeps = static_cast<int>(std::ceil(dt / longest));
  const Configuration configuration = configure(referenceMethod(), dt, substeps, 0);
  Simulation simulation(withConfiguration(experiment.scene, configuration));
  std::vector<double> values;
  double cpu = 0.0;
  while (simulation.time() < experiment.duration - 0.5 * dt && !simulation.failed()) {
    const double start = threadCpuTime();
    simulation.step();
    cpu += threadCpuTime() - start;
    values = experiment.measure(simulation);
  }
  std::vector<ResolutionRow> rows;
  for (std::size_t k = 0; k < experiment.quantities.size(); ++k) {
    const Quantity& quantity = experiment.quantities[k];
    rows.push_back({quantity.name, experiment.scene.cloths[0].columns,
                    simulation.failed() ? kNone : values[k], quantity.unit, 0.0, substeps,
                    cpu / simulation.time()});
  }
  return rows;
}

}  // namespace

std::vector<ResolutionRun> resolutionRuns(const std::vector<int>& particles) {
  std::vector<ResolutionRun> runs;
  for (const auto& experiment : {sag, drape, swing, hoop}) {
    for (const int n : particles) {
      const std::string name = experiment(2).quantities.front().name;
      runs.push_back({name, n, [experiment, n] { return run(experiment(n)); }});
    }
  }
  return runs;
}

std::vector<ResolutionRow> compareWithFinest(std::vector<ResolutionRow> rows) {
  const auto sameQuantity = [](const std::string& name) {
    return [name](const ResolutionRow& row) { return row.quantity == name; };
  };
  std::vector<ResolutionRow> sorted;
  while (!rows.empty()) {
    const auto rest = std::stable_partition(rows.begin(), rows.end(),
                                            sameQuantity(std::string(rows.front().quantity)));
    std::sort(rows.begin(), rest, [](const ResolutionRow& a, const ResolutionRow& b) {
      return a.particles < b.particles;
    });
    const ResolutionRow finest = *(rest - 1);
    for (auto row = rows.begin(); row != rest; ++row) {
      row->difference =
          finest.unit == "1" ? row->value - finest.value : row->value / finest.value - 1.0;
      sorted.push_back(*row);
    }
    rows.erase(rows.begin(), rest);
  }
  return sorted;
}

}  // namespace cloth_sim
