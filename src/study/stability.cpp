#include "stability.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "cloth_sim/scene/build.h"
#include "run.h"

namespace cloth_sim {
namespace {

constexpr BisectionRange kRange{0.02, 1000.0, 0.005};  ///< in omega h
constexpr double kDisplacement = 0.001;  ///< largest at the start, relative to a spring's length
/// Number of steps of a probe, and of steps at its start and end whose amplitudes are compared. At
/// the lower end of the range, forward Euler grows by a factor of exp(0.02^2 / 2 * 3000) = 1.8.
constexpr int kSteps = 4000;
constexpr int kWindow = 1000;
/// Largest growth of the amplitude: beyond it a spring turns inside out, and growth may end in a
/// cycle. Symplectic Euler reaches 1 / sqrt(1 - (omega h / 2)^2) times its start: 14 at half a per
/// cent below omega h = 2.
constexpr double kMostGrowth = 50.0;
/// Growth from the first to the last window that is still bounded: samples miss the peaks by a few
/// per cent.
constexpr double kGrowth = 1.2;

constexpr double kSpringLength = 0.5;  ///< of the oscillator [m]

/// Makes one spring between vertices 0 and 1, along x: a single face whose other edges have next to
/// no stiffness.
Model oneSpring(double stiffness) {
  Fabric fabric;
  fabric.tensileWarp = 2.0 * stiffness;  // k = K A / L^2 with A = L^2 / 2
  fabric.tensileWeft = 1e-12 * stiffness;
  fabric.shear = fabric.bending = fabric.damping = 0.0;
  Model model;
  model.mesh = TriangleMesh({{0, 0}, {kSpringLength, 0}, {0, kSpringLength}}, {{0, 1, 2}});
  model.springs = SpringNetwork(model.mesh, fabric, {false, false});
  model.mass = VertexData<double>(std::vector<double>{0.02, 0.03, 1.0});
  model.cloths[0].fabric = fabric;
  return model;
}

/// Places the cloth flat in z = 0, at rest.
void layFlat(VibratingSystem& system) {
  const auto count = static_cast<std::size_t>(system.model.particleCount());
  system.start.x = VertexData<Vec3>(count, Vec3::Zero(), system.model.mesh.revision());
  system.start.v = VertexData<Vec3>(count, Vec3::Zero(), system.model.mesh.revision());
  for (VertexId v = 0; v < system.model.particleCount(); ++v) {
    system.start.x[v].head<2>() = system.model.mesh.material(v);
  }
}

/// Returns M^(-1/2) K M^(-1/2) at rest; its eigenvalues are squares of angular frequencies [1/s^2].
Eigen::MatrixXd massScaledStiffness(const VibratingSystem& system) {
  const Model& model = system.model;
  const VertexData<Vec3>& rest = system.start.x;
  const Eigen::Index n = 3 * model.particleCount();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    const Vec3 d = (rest[spring.b] - rest[spring.a]).normalized();
    const Eigen::Matrix3d block = spring.stiffness * d * d.transpose();
    const double ma = model.mass[spring.a], mb = model.mass[spring.b];
    matrix.block<3, 3>(3 * spring.a, 3 * spring.a) += block / ma;
    matrix.block<3, 3>(3 * spring.b, 3 * spring.b) += block / mb;
    matrix.block<3, 3>(3 * spring.a, 3 * spring.b) -= block / std::sqrt(ma * mb);
    matrix.block<3, 3>(3 * spring.b, 3 * spring.a) -= block / std::sqrt(ma * mb);
  }
  return matrix;
}

/// Finds the fastest mode and displaces the system along it.
void excite(double largest, VibratingSystem& system) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(massScaledStiffness(system));
  system.omega = std::sqrt(solver.eigenvalues().maxCoeff());
  const Eigen::VectorXd mode = solver.eigenvectors().rightCols<1>();
  std::vector<Vec3> shape;
  double most = 0.0;
  for (VertexId v = 0; v < system.model.particleCount(); ++v) {
    const Vec3 part = mode.segment<3>(3 * v);
    const double root = std::sqrt(system.model.mass[v]);
    shape.push_back(part / root);
    most = std::max(most, shape.back().norm());
  }
  for (VertexId v = 0; v < system.model.particleCount(); ++v) {
    system.start.x[v] += largest / most * shape[v];
  }
}

/// Returns the root of the energy of the springs: rigid motion does not count.
double amplitude(const VibratingSystem& system, const State& state) {
  return std::sqrt(energies(system.model, state, Vec3::Zero()).elastic);
}

std::unique_ptr<Solver> withOneSubstep(const SolverInfo& method, const Model& model) {
  SolverParameters given;
  if (findParameter(method, "substeps") != nullptr) given["substeps"] = 1;
  return method.create(model, completeParameters(method, given));
}

}  // namespace

VibratingSystem makeOscillator() {
  VibratingSystem system;
  system.name = "oscillator";
  system.stiffness = 5e5;
  system.model = oneSpring(system.stiffness);
  layFlat(system);
  excite(kDisplacement * kSpringLength, system);
  return system;
}

VibratingSystem makeVibratingCloth() {
  ClothSpec spec;
  spec.columns = spec.rows = 6;
  spec.width = spec.height = 0.1;
  spec.fabric = fabricPreset("cotton");
  spec.fabric.damping = 0.0;
  VibratingSystem system;
  system.name = "cloth";
  system.stiffness = spec.fabric.tensileWarp;
  system.model = buildModel(spec);
  layFlat(system);
  excite(kDisplacement * system.model.cloths[0].grid->spacingU(), system);
  return system;
}

bool staysBounded(const SolverInfo& method, const VibratingSystem& system, double h) {
  const std::unique_ptr<Solver> solver = withOneSubstep(method, system.model);
  State state = system.start;
  Controls controls;
  controls.gravity = Vec3::Zero();
  Contacts contacts;
  const double bound = kMostGrowth * amplitude(system, state);
  double first = amplitude(system, state), last = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const StepReport& report = solver->step(system.model, state, controls, contacts, {h});
    const double now = amplitude(system, state);
    if (report.status == StepStatus::kDiverged || !(now < bound)) return false;
    if (k < kWindow) first = std::max(first, now);
    if (k >= kSteps - kWindow) last = std::max(last, now);
  }
  return last <= kGrowth * first;
}

StabilityLimit measureStability(const SolverInfo& method, const VibratingSystem& system) {
  StabilityLimit limit;
  limit.method = &method;
  limit.system = system.name;
  limit.stiffness = system.stiffness;
  limit.omega = system.omega;
  limit.inOmegaH = bisectLimit(
      kRange, [&](double omegaH) { return staysBounded(method, system, omegaH / system.omega); });
  return limit;
}

}  // namespace cloth_sim
