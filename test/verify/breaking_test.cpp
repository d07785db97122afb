/// \file Limits of the methods. Every method of the registry runs every trial with its own
/// defaults, in steps of 1/60 s unless the trial says otherwise. breaking.csv keeps the known
/// outcomes: a method that begins to fail, or no longer fails, is a finding either way. With
/// CLOTH_SIM_RECORD=1 this test adds the rows that are missing, and compares nothing. To record a
/// row again, delete it first.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iomanip>
#include <map>
#include <sstream>

#include "cloth_sim/sim/simulation.h"
#include "fewer_cases.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

constexpr double kDt = 1.0 / 60.0;  // [s]

/// Result of a trial.
struct Outcome {
  bool failed = false;      ///< the method or the simulation reported a failure
  std::string failure;      ///< its message
  bool shownFinite = true;  ///< the snapshots of all steps, the failed one included, were finite
  double error = 0.0;       ///< at the end, in the trial's own measure
  double farthest = 0.0;    ///< largest coordinate that was shown [m]
  double residual = 0.0;    ///< largest of those that steps ended with, as the method measures it
};

struct Trial {
  std::string name;
  std::string measure;     ///< what `error` is
  double tolerance = 0.0;  ///< a larger error is a wrong result
  std::function<Outcome(const std::string& method)> run;
};

enum class Fate { kSurvived, kWrong, kFailed };

/// The word for a fate in breaking.csv.
const char* toString(Fate fate) {
  switch (fate) {
    case Fate::kSurvived:
      return "survived";
    case Fate::kWrong:
      return "wrong";
    case Fate::kFailed:
      return "failed";
  }
  return "?";
}

// ---- how trials are run -----------------------------------------------------------------------

/// Returns whether the positions in a snapshot are finite, and none of its figures is NaN. A figure
/// may be infinite in the step before a method fails: the square of 1e200 m/s overflows.
bool showsNumbers(Simulation& simulation) {
  const auto shown = simulation.snapshot();
  const auto finite = [](const Vec3& x) { return x.allFinite(); };
  const Figures& told = *shown->figures;
  const std::array<double, 6> figures{told.energies.kinetic, told.energies.elastic,
                                      told.energies.gravity, told.meanSpeed,
                                      told.maxStretch,       told.mass};
  return isFinite(simulation.state()) &&
         std::all_of(shown->positions.begin(), shown->positions.end(), finite) &&
         std::none_of(figures.begin(), figures.end(), [](double x) { return std::isnan(x); });
}

/// Steps on, and looks at every state that is shown.
void watch(Simulation& simulation, double seconds, Outcome& outcome) {
  const double end = simulation.time() + seconds - 1e-9;
  while (simulation.time() < end && !simulation.failed()) {
    simulation.step();
    outcome.shownFinite = outcome.shownFinite && showsNumbers(simulation);
    outcome.residual = std::max(outcome.residual, simulation.lastReport().residual);
    for (const Vec3& x : simulation.state().x) {
      outcome.farthest = std::max(outcome.farthest, x.cwiseAbs().maxCoeff());
    }
  }
  outcome.failed = simulation.failed();
  outcome.failure = simulation.failure();
}

/// A method without a simulation around it, that nobody sees: it has to tell when it fails.
void watch(Rig& rig, double dt, double seconds, Outcome& outcome) {
  const int steps = static_cast<int>(std::lround(seconds / dt));
  for (int k = 0; k < steps && !outcome.failed; ++k) {
    outcome.failed = !rig.run(dt, 1);
    outcome.shownFinite = outcome.shownFinite && (outcome.failed || isFinite(rig.state));
  }
  outcome.failure = outcome.failed ? "status" : "";
}

Rig rigOf(const std::string& method, Model model) {
  return Rig(findSolver(method), std::move(model), {});
}

/// A square cloth in the plane y = 0, its upper border at z = 0.
Scene uprightScene(const std::string& method, int particles, double side, const Fabric& fabric) {
  Scene scene;
  scene.cloths[0] = clothOf(particles, particles, side / (particles - 1), fabric);
  scene.cloths[0].pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  scene.cloths[0].pose.position.z() = -0.5 * side;
  scene.drag = 3.0;
  scene.solver.method = method;
  scene.solver.dt = kDt;
  scene.solver.parameters = completeParameters(findSolver(method), {});
  return scene;
}

void pinUpperRow(Scene& scene) {
  for (int column = 0; column < scene.cloths[0].columns; ++column) {
    scene.cloths[0].pins.push_back({column, scene.cloths[0].rows - 1});
  }
}

// ---- the trials -------------------------------------------------------------------------------

/// Warp a million times as stiff as weft: a strain of 1e-6 in the stiff springs is right.
Outcome stiffnessRatio(const std::string& method) {
  Fabric fabric;
  fabric.arealDensity = 0.1;
  fabric.tensileWarp = 1e6;
  fabric.tensileWeft = 1.0;
  fabric.shear = 0.0;
  fabric.bending = 0.0;
  Scene scene = uprightScene(method, 6, 0.2, fabric);
  scene.cloths[0].springs = {false, false};
  scene.cloths[0].pins = {{0, 5}, {5, 5}};
  Simulation simulation(scene);
  Outcome outcome;
  watch(simulation, 2.0, outcome);
  for (const Spring& spring : simulation.model().springs.slots()) {
    if (spring.direction != ThreadDirection::kWarp) continue;
    const double strain = stretch(spring, simulation.state()) - 1.0;
    outcome.error = std::max(outcome.error, std::abs(strain));
  }
  return outcome;
}

/// Ten kilogrammes on nine beads of one gramme each, on springs that they stretch by a twentieth.
Outcome massRatio(const std::string& method) {
  const int links = 10;
  const double spacing = 0.05, light = 1e-3, heavy = 10.0;
  const double k = heavy * kGravity / (0.05 * spacing);
  Rig rig = rigOf(method, chainOf(links + 1, spacing, k, light));
  rig.controls.drag = 20.0;
  for (Vec3& x : rig.state.x) x = Vec3(0.0, x.y(), -x.x());
  for (const int row : {0, 1}) {
    rig.hold(rig.model.cloths[0].grid->vertex(0, row));
    rig.model.mass[rig.model.cloths[0].grid->vertex(links, row)] = heavy;
  }
  Outcome outcome;
  watch(rig, kDt, 2.0, outcome);
  const Vec3 way = rig.state.x[rig.model.cloths[0].grid->vertex(links, 0)] - rig.state.x[0];
  outcome.error = std::abs((way.norm() / (links * spacing) - 1.0) / 0.05 - 1.0);
  return outcome;
}

/// Drawn aside by a metre at 50 m/s; three seconds later it should hang, stretched by its weight.
/// (It may lie in folds, for nothing keeps cloth from lying in itself.)
Outcome yankedClamp(const std::string& method) {
  Scene scene = uprightScene(method, 9, 0.2, fabricPreset("interlock"));
  ClampSpec hand = quickHand(scene, {4, 8, 2}, -0.02);
  hand.maxLinearSpeed = 50.0;
  hand.maxLinearAcceleration = 1e5;
  scene.clamps = {hand};
  Simulation simulation(scene);
  simulation.apply(SetGrasp{"hand", true});
  Outcome outcome;
  watch(simulation, 1.0, outcome);
  Pose aside = hand.pose;
  aside.position.x() += 1.0;
  simulation.apply(SetClampTarget{"hand", aside});
  watch(simulation, 3.0, outcome);
  outcome.error = maxStretch(simulation.model(), simulation.state()) - 1.0;
  return outcome;
}

/// A ball of 8 cm radius appears with the cloth a centimetre off its middle.
Outcome sphereInside(const std::string& method) {
  Scene scene = uprightScene(method, 11, 0.3, fabricPreset("interlock"));
  pinUpperRow(scene);
  Obstacle ball;
  ball.name = "ball";
  ball.shape = SphereShape{0.08};
  ball.pose.position = Vec3(0.0, 5.0, 0.0);
  scene.obstacles = {ball};
  Simulation simulation(scene);
  Outcome outcome;
  watch(simulation, 0.2, outcome);
  simulation.apply(MoveObstacle{"ball", Pose{Vec3(0.0, 0.01, -0.15), Quat::Identity()}});
  watch(simulation, 1.5, outcome);
  const Collider& collider = simulation.colliders().all().front();
  for (const Vec3& x : simulation.state().x) {
    outcome.error = std::max(outcome.error, -collider.gap(x, simulation.time()) / 0.08);
  }
  return outcome;
}

/// Mean |strain| of structural springs.
double meanStrain(const Rig& rig) {
  double sum = 0.0;
  int count = 0;
  for (const Spring& spring : rig.model.springs.slots()) {
    if (spring.kind != SpringKind::kStructural) continue;
    sum += std::abs(stretch(spring, rig.state) - 1.0);
    ++count;
  }
  return sum / count;
}

/// A cloth of 0.3 m in a ball of radius `radius`, left alone for two seconds.
Outcome collapsed(const std::string& method, double radius) {
  Rig rig = rigOf(method, buildModel(clothOf(8, 8, 0.3 / 7, fabricPreset("interlock"))));
  rig.controls.gravity.setZero();
  rig.controls.drag = 5.0;
  Generator random(3);
  for (Vec3& x : rig.state.x) x = randomVector(random, radius);
  Outcome outcome;
  watch(rig, kDt, 2.0, outcome);
  outcome.error = meanStrain(rig);
  return outcome;
}

/// All on one line, so that no face has an area or a normal, in a wind of 10 m/s across it.
Outcome degenerateFaces(const std::string& method) {
  Rig rig = rigOf(method, buildModel(clothOf(8, 8, 0.3 / 7, fabricPreset("interlock"))));
  rig.controls.gravity.setZero();
  rig.controls.drag = 5.0;
  rig.controls.wind = Wind{Vec3(0.0, 3.0, 10.0), 1.2, 1.0};
  for (Vec3& x : rig.state.x) x = Vec3(x.x(), 0.0, 0.0);
  Outcome outcome;
  watch(rig, kDt, 2.0, outcome);
  outcome.error = meanStrain(rig);
  return outcome;
}

/// Cuts through nearly the same points: a star of six, and six side by side, a tenth of a
/// millimetre apart. What hangs on should be stretched by no more than 20 %.
Outcome slivers(const std::string& method) {
  Scene scene = uprightScene(method, 9, 0.2, fabricPreset("interlock"));
  pinUpperRow(scene);
  scene.surgery.snap = 0.05;
  scene.surgery.minEdge = 1e-6;
  Simulation simulation(scene);
  Outcome outcome;
  watch(simulation, 0.2, outcome);
  const auto cut = [&](const Vec3& from, const Vec3& to) {
    simulation.apply(CutAlong{strokeAlong({from, to}, Vec3::UnitY(), 0.5)});
  };
  const Vec3 middle(1e-3, 0.0, -0.1);
  for (int k = 0; k < 6; ++k) {
    const double angle = k * M_PI / 6.0;
    const Vec3 arm = 0.05 * Vec3(std::cos(angle), 0.0, std::sin(angle));
    cut(middle - arm, middle + arm);
    const Vec3 side(0.0, 0.0, 1e-4 * k);
    cut(Vec3(-0.09, 0.0, -0.16) + side, Vec3(0.02, 0.0, -0.161) + side);
  }
  watch(simulation, 1.0, outcome);
  outcome.error = maxStretch(simulation.model(), simulation.state()) - 1.0;
  return outcome;
}

/// Steps of 0.1 s. A strip that hangs is longer by rho g L / (2 K) = 2e-4.
Outcome longSteps(const std::string& method) {
  Fabric fabric;
  fabric.arealDensity = 0.1;
  fabric.tensileWarp = fabric.tensileWeft = 500.0;
  fabric.shear = 10.0;
  fabric.bending = 0.0;
  Scene scene = uprightScene(method, 6, 0.2, fabric);
  pinUpperRow(scene);
  scene.solver.dt = 0.1;
  Simulation simulation(scene);
  Outcome outcome;
  watch(simulation, 5.0, outcome);
  const State& state = simulation.state();
  const Grid& grid = *simulation.model().cloths[0].grid;
  const double length = (state.x[grid.vertex(2, 5)] - state.x[grid.vertex(2, 0)]).norm();
  outcome.error = std::abs(length / 0.2 - 1.0 - 2e-4);
  return outcome;
}

/// A clamp tears away at 20 m/s what is pinned above. No mass may be lost, and something must tear.
Outcome tornByShock(const std::string& method) {
  Scene scene = uprightScene(method, 9, 0.2, fabricPreset("interlock"));
  pinUpperRow(scene);
  scene.tearing.enabled = true;
  scene.tearing.ratio = {1.3, 1.3, 1.5};
  ClampSpec hand = quickHand(scene, {4, 1, 1}, -0.18);
  hand.maxLinearSpeed = 20.0;
  hand.maxLinearAcceleration = 1e5;
  scene.clamps = {hand};
  Simulation simulation(scene);
  const double mass = totalMass(simulation.model());
  simulation.apply(SetGrasp{"hand", true});
  Outcome outcome;
  watch(simulation, 0.1, outcome);
  Pose away = hand.pose;
  away.position.z() -= 2.0;
  simulation.apply(SetClampTarget{"hand", away});
  watch(simulation, 0.2, outcome);
  outcome.error = std::abs(totalMass(simulation.model()) / mass - 1.0);
  if (simulation.pieces() < 2) outcome.error = 1.0;
  return outcome;
}

const std::vector<Trial>& trials() {
  static const std::vector<Trial> all{
      {"stiffness_ratio_1e6", "largest strain of the stiff springs", 0.01, stiffnessRatio},
      {"mass_ratio_1e4", "error of the elongation, relative", 0.05, massRatio},
      {"clamp_yanked_at_50_m_s", "largest strain", 0.2, yankedClamp},
      {"sphere_inside", "deepest overlap over the radius", 0.01, sphereInside},
      {"all_in_one_point", "mean strain of structural springs", 0.2,
       [](const std::string& method) { return collapsed(method, 0.0); }},
      {"crushed_to_a_millimetre", "mean strain of structural springs", 0.2,
       [](const std::string& method) { return collapsed(method, 1e-3); }},
      {"faces_without_area_in_wind", "mean strain of structural springs", 0.2, degenerateFaces},
      {"slivers_after_cuts", "largest strain", 0.2, slivers},
      {"steps_of_0.1_s", "error of the length, relative", 0.01, longSteps},
      {"torn_by_shock", "mass lost, relative; 1: nothing came off", 1e-9, tornByShock},
  };
  return all;
}

// ---- the known outcomes -----------------------------------------------------------------------

/// Trial and method.
using Pairing = std::pair<std::string, std::string>;

struct Known {
  std::string fate;
  double error = 0.0;  ///< of a wrong result; else 0
};

std::string knownFile() { return std::string(CLOTH_SIM_SOURCE_DIR) + "/test/verify/breaking.csv"; }

std::map<Pairing, Known> readKnown() {
  std::map<Pairing, Known> rows;
  std::ifstream file(knownFile());
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string trial, method, fate, error;
    std::getline(fields, trial, ',');
    std::getline(fields, method, ',');
    std::getline(fields, fate, ',');
    std::getline(fields, error, ',');
    rows[{trial, method}] = {fate, std::stod(error)};
  }
  return rows;
}

/// Writes the rows by trial, in the order of `trials`, then by method.
void writeKnown(const std::map<Pairing, Known>& rows) {
  std::ofstream file(knownFile());
  file << "trial,method,fate,error\n" << std::setprecision(2);
  for (const Trial& trial : trials()) {
    for (const auto& [pairing, known] : rows) {
      if (pairing.first != trial.name) continue;
      file << pairing.first << ',' << pairing.second << ',' << known.fate << ',' << known.error
           << '\n';
    }
  }
}

bool isRecording() { return std::getenv("CLOTH_SIM_RECORD") != nullptr; }

Fate fateOf(const Trial& trial, const Outcome& outcome) {
  if (outcome.failed) return Fate::kFailed;
  return outcome.error <= trial.tolerance ? Fate::kSurvived : Fate::kWrong;
}

std::vector<std::string> trialNames() {
  std::vector<std::string> names;
  for (const Trial& trial : trials()) names.push_back(trial.name);
  return names;
}

class Breaking : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 public:
  static void SetUpTestSuite() { allKnown = readKnown(); }
  static void TearDownTestSuite() {
    if (isRecording()) writeKnown(allKnown);
  }

 protected:
  static std::map<Pairing, Known> allKnown;  ///< shared by the trials of the suite
};

std::map<Pairing, Known> Breaking::allKnown;

INSTANTIATE_TEST_SUITE_P(Registry, Breaking,
                         testing::Combine(testing::ValuesIn(fewerCasesOf(trialNames())),
                                          testing::ValuesIn(solverNames())),
                         [](const auto& test) {
                           std::string name =
                               std::get<0>(test.param) + "_" + std::get<1>(test.param);
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST_P(Breaking, EndsAsKnown) {
  const auto& [trialName, method] = GetParam();
  const auto isIt = [&, name = trialName](const Trial& trial) { return trial.name == name; };
  const Trial& trial = *std::find_if(trials().begin(), trials().end(), isIt);
  const Pairing pairing{trialName, method};
  if (isRecording() && allKnown.count(pairing) != 0) return;
  const Outcome outcome = trial.run(method);
  const Fate fate = fateOf(trial, outcome);
  record("error", outcome.error);
  record("farthest", outcome.farthest);
  record("residual", outcome.residual);
  EXPECT_TRUE(outcome.shownFinite) << "numbers that are not finite were shown";
  EXPECT_EQ(outcome.failed, !outcome.failure.empty());

  if (isRecording()) {
    allKnown[pairing] = {toString(fate), fate == Fate::kWrong ? outcome.error : 0.0};
    return;
  }
  ASSERT_EQ(allKnown.count(pairing), 1u)
      << "no row for this method: run the test with CLOTH_SIM_RECORD=1 to add it to breaking.csv";
  const Known& known = allKnown.at(pairing);
  EXPECT_EQ(toString(fate), known.fate)
      << trial.measure << ": " << outcome.error << " " << outcome.failure;
  if (known.fate == toString(Fate::kWrong) && fate == Fate::kWrong) {
    // Chaos and compilers may change the digits, not the size.
    EXPECT_LT(std::abs(std::log(outcome.error / known.error)), std::log(2.0)) << outcome.error;
  }
}

}  // namespace
}  // namespace cloth_sim
