/// \file A simulation without ROS: how far a cloth sags between two corners, and a cut through it.

#include <algorithm>
#include <cstdio>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

int main(int argc, char** argv) try {
  using namespace cloth_sim;
  if (argc != 2) {
    std::fprintf(stderr, "usage: core_example SCENE.yaml\n");
    return 2;
  }
  Simulation simulation(loadScene(argv[1], {"cloth.particles=[33, 33]"}));
  while (simulation.time() < 1.0 && !simulation.failed()) simulation.step();
  double lowest = simulation.state().x[0].z();
  for (const Vec3& x : simulation.state().x) lowest = std::min(lowest, x.z());
  std::printf("t = %.2f s: the lowest particle is at z = %.3f m\n", simulation.time(), lowest);

  const std::vector<Vec3> path{Vec3(-1.0, 0.0, 0.8), Vec3(1.0, 0.0, 0.8)};
  const CommandResult cut = simulation.apply(CutAlong{strokeAlong(path, Vec3::UnitY(), 1.0)});
  std::printf("%s\n", cut.message.c_str());
  return cut.success ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 2;
}
