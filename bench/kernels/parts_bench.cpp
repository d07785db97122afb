// The parts of a step around the solve, each alone, at 128 x 128 and other sizes.

#include <benchmark/benchmark.h>

#include "constraints/particles.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

void detectContacts(benchmark::State& run) {
  Warm warm(overSphere(static_cast<int>(run.range(0)), "xpbd"), 20);
  const Simulation& simulation = warm.simulation();
  Contacts contacts;
  for (auto _ : run) {
    contacts.clear();
    simulation.colliders().detect(simulation.state(), 1.0 / 60.0, 1e-3, contacts);
  }
  std::size_t near = 0;
  for (const ContactCandidates& c : contacts.candidates) near += c.vertices.size();
  run.counters["candidates"] = static_cast<double>(near);
}
BENCHMARK(detectContacts)->Name("part/detect_contacts")->Arg(64)->Arg(128)->Arg(256);

void projectContacts(benchmark::State& run) {
  Warm warm(overSphere(static_cast<int>(run.range(0)), "xpbd"), 20);
  const Simulation& simulation = warm.simulation();
  Contacts contacts;
  contacts.clear();
  simulation.colliders().detect(simulation.state(), 1.0 / 60.0, 1e-3, contacts);
  Particles particles;
  particles.layOut(simulation.model());
  particles.resize();
  particles.load(simulation.state());
  particles.loadMasses(simulation.model(), {});
  particles.start = particles.x;
  for (auto _ : run) contacts.project(particles.view(), simulation.time(), 1e-3);
}
BENCHMARK(projectContacts)->Name("part/project_contacts")->Arg(64)->Arg(128)->Arg(256);

/// \param stride  how far a particle moves from look to look [m].
void tearLaw(benchmark::State& run, double stride) {
  const Simulation simulation(hanging(static_cast<int>(run.range(0)), "xpbd"));
  State state = simulation.state();
  TearingSettings settings;
  settings.enabled = true;
  settings.ratio.fill(10.0);
  Tearing tearing(settings, simulation.model());
  for (auto _ : run) {
    stride = -stride;
    state.x[0].z() += stride;
    benchmark::DoNotOptimize(tearing.plan(simulation.model(), state, 1.0 / 60.0));
  }
}
BENCHMARK_CAPTURE(tearLaw, still, 0.0)->Name("part/tear_law/still")->Arg(64)->Arg(128)->Arg(256);
BENCHMARK_CAPTURE(tearLaw, moving, 0.02)->Name("part/tear_law/moving")->Arg(64)->Arg(128)->Arg(256);

/// A clamp around the middle of the cloth.
Clamp clampOn(const Simulation& simulation) {
  const State& state = simulation.state();
  ClampSpec spec;
  spec.name = "clamp";
  const Grid& grid = *simulation.model().cloths[0].grid;
  spec.pose.position = state.x[grid.vertex(grid.columns / 2, grid.rows / 2)];
  spec.pose.orientation = Eigen::AngleAxisd(M_PI / 2.0, Vec3::UnitX());
  return Clamp(spec);
}

constexpr double kAMinute = 60.0;  // enough to close, and to go anywhere

/// The work of a clamp in a step in which it moves.
void holdInClamp(benchmark::State& run) {
  const Simulation simulation(hanging(static_cast<int>(run.range(0)), "xpbd"));
  Clamp clamp = clampOn(simulation);
  clamp.close();
  clamp.advance(simulation.model(), simulation.state(), kAMinute);
  clamp.guide({clamp.pose(), Vec3::UnitY(), Vec3::UnitY(), 0.0});
  std::vector<KinematicTarget> targets;
  const std::vector<Vec3> reactions(clamp.held().size(), Vec3::UnitZ());
  for (auto _ : run) {
    targets.clear();
    clamp.clearWrench();
    clamp.advance(simulation.model(), simulation.state(), 1.0 / 60.0);
    clamp.appendTargets(targets);
    clamp.addReactions(targets, reactions);
  }
  run.counters["held"] = static_cast<double>(clamp.held().size());
}
BENCHMARK(holdInClamp)->Name("part/clamp/hold")->Arg(64)->Arg(128)->Arg(256);

/// The step in which the plates meet: which particles are between them?
void graspWithClamp(benchmark::State& run) {
  const Simulation simulation(hanging(static_cast<int>(run.range(0)), "xpbd"));
  const Clamp open = clampOn(simulation);
  for (auto _ : run) {
    Clamp clamp = open;
    clamp.close();
    clamp.advance(simulation.model(), simulation.state(), kAMinute);
    benchmark::DoNotOptimize(clamp.held().data());
  }
}
BENCHMARK(graspWithClamp)->Name("part/clamp/grasp")->Arg(64)->Arg(128)->Arg(256);

void startUp(benchmark::State& run, const std::string& method) {
  const Scene scene = hanging(static_cast<int>(run.range(0)), method);
  for (auto _ : run) {
    Simulation simulation(scene);
    simulation.step();
  }
}
BENCHMARK_CAPTURE(startUp, xpbd, "xpbd")
    ->Name("part/start_up/xpbd")
    ->RangeMultiplier(2)
    ->Range(32, 1024)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(startUp, projective, "projective")
    ->Name("part/start_up/projective")
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cloth_sim::bench
