/// \file Refinement of a cloth that hangs at rest: it stays where it hangs.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/sim/simulation.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

constexpr int kSide = 65;           ///< particles of a side
constexpr double kSettling = 3.0;   ///< [s]
constexpr double kAfterwards = 0.5;  ///< [s]

/// A square metre of cotton that hangs in the plane y = 0, its upper edge at z = 0.
Scene hangingScene(const std::string& method, bool fromEdge) {
  Scene scene;
  ClothSpec& cloth = scene.cloths[0];
  cloth = clothOf(kSide, kSide, 1.0 / (kSide - 1), fabricPreset("cotton"));
  cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  cloth.pose.position.z() = -0.5;
  for (int column = 0; column < kSide; column += fromEdge ? 1 : kSide - 1) {
    cloth.pins.push_back({column, kSide - 1});
  }
  scene.drag = 3.0;
  scene.solver.method = method;
  scene.solver.sleep.reset();
  scene.solver.parameters = completeParameters(findSolver(method), {{"substeps", 20.0}});
  return scene;
}

void run(Simulation& simulation, double seconds) {
  const double end = simulation.time() + seconds - 1e-9;
  while (simulation.time() < end) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
  }
}

double largestStrain(const Simulation& simulation) {
  return maxStretch(simulation.model(), simulation.state()) - 1.0;
}

/// Six bisections of the faces within 2 cm of a stroke across the middle of the cloth.
RefineNear aroundTheStroke(const Simulation& simulation) {
  const Grid& grid = *simulation.model().cloths[0].grid;
  RefineNear request;
  for (int column = 16; column <= 48; ++column) {
    request.path.push_back(simulation.state().x[grid.vertex(column, 32)]);
  }
  request.refinement = {0.02, 6, 0.0};
  return request;
}

/// What refinement did to a cloth at rest.
struct Disturbance {
  double farthest = 0.0;        ///< largest distance of an original particle from where it was [m]
  double farthestWithout = 0.0;  ///< the same if nothing is refined [m]
  double strainBefore = 0.0;    ///< largest [-]
  double strainAfter = 0.0;     ///< largest [-]
  int added = 0;                ///< particles
};

double farthestMove(const std::vector<Vec3>& from, const State& to) {
  double farthest = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    farthest = std::max(farthest, (to.x.values()[k] - from[k]).norm());
  }
  return farthest;
}

Disturbance disturb(const std::string& method, bool fromEdge) {
  Simulation simulation(hangingScene(method, fromEdge));
  run(simulation, kSettling);
  Disturbance result;
  const std::vector<Vec3> start = simulation.state().x.values();
  result.strainBefore = largestStrain(simulation);
  const std::string saved = simulation.save();
  run(simulation, kAfterwards);
  result.farthestWithout = farthestMove(start, simulation.state());
  simulation.load(saved);
  EXPECT_TRUE(simulation.apply(RefineMesh{aroundTheStroke(simulation)}).success);
  result.added = simulation.model().particleCount() - kSide * kSide;
  const int steps = 30;
  for (int k = 0; k < steps; ++k) {
    run(simulation, kAfterwards / steps);
    result.farthest = std::max(result.farthest, farthestMove(start, simulation.state()));
    result.strainAfter = std::max(result.strainAfter, largestStrain(simulation));
  if (getenv("VV")) printf("%d far %.4g now %.4g strain %.4g speed %.3g\n", k, result.farthest, farthestMove(start, simulation.state()), largestStrain(simulation), meanSpeed(simulation.state()));
  }
  record("added", result.added);
  record("farthest", result.farthest);
  record("farthest_without", result.farthestWithout);
  record("strain_before", result.strainBefore);
  record("strain_after", result.strainAfter);
  printf("%s %d: added %d farthest %.4g (without %.4g) strain %.5g -> %.5g\n", method.c_str(), fromEdge, result.added, result.farthest, result.farthestWithout, result.strainBefore, result.strainAfter);
  return result;
}

TEST(RefinementAtRest, Probe) {
  if (const char* second = getenv("SECOND")) {
    const bool edge = getenv("CORNERS") == nullptr;
    Simulation simulation(hangingScene("line_xpbd", edge));
    run(simulation, kSettling);
    RefineNear request = aroundTheStroke(simulation);
    if (getenv("GEN")) request.refinement.generations = atoi(getenv("GEN"));
    const std::vector<Vec3> start = simulation.state().x.values();
    EXPECT_TRUE(simulation.apply(RefineMesh{request}).success);
    const std::vector<Vec3> all = simulation.state().x.values();
    Scene scene = hangingScene(second, edge);
    if (getenv("SUB")) scene.solver.parameters["substeps"] = atoi(getenv("SUB"));
    if (getenv("GUARD")) scene.solver.guard = StepGuard::kSubdivide;
    Simulation other(scene);
    other.adopt(simulation.save());
    printf("%s particles %d strain at start %.4g\n", second, other.model().particleCount(), largestStrain(other));
    for (int k = 0; k < (getenv("N") ? atoi(getenv("N")) : 30); ++k) {
      run(other, 1.0 / 60);
      printf("%d far %.4g all %.4g strain %.4g speed %.3g sub %d res %.3g\n", k, farthestMove(start, other.state()), farthestMove(all, other.state()), largestStrain(other), meanSpeed(other.state()), other.lastReport().substeps, other.lastReport().residual);
    }
    return;
  }
  const char* m = getenv("MM");
  disturb(m ? m : "line_xpbd", getenv("CORNERS") == nullptr);
}

}  // namespace
}  // namespace cloth_sim
