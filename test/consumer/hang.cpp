/// \file A program that uses the library: a cloth hangs, is cut, and is saved; no ROS anywhere.

#include <cloth_sim/cloth/strain.h>
#include <cloth_sim/scene/load.h>
#include <cloth_sim/sim/simulation.h>
#include <cloth_sim/sim/summary.h>
#include <cloth_sim/solver/registry.h>
#include <cloth_sim/surgery/stroke.h>

#include <algorithm>
#include <iostream>

int main() {
  using namespace cloth_sim;
  Simulation simulation(parseScene(R"(
cloth: {size: [0.4, 0.4], particles: [9, 9], pins: [corner_00, corner_10]}
)",
                                   "hang"));
  RunRecord record = startRecord(simulation);
  for (int k = 0; k < 10; ++k) simulation.step();
  const Stroke stroke =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.02, 0.0)}, Vec3::UnitZ(), 1.0);
  const CommandResult cut = simulation.apply(CutAlong{stroke});
  if (!cut.success) {
    std::cerr << cut.message << '\n';
    return 1;
  }
  for (int k = 0; k < 10; ++k) simulation.step();

  const auto snapshot = simulation.snapshot();
  std::vector<float> strains;
  vertexStrains(snapshot->topology->strainLines, snapshot->positions, strains);
  std::cout << "methods " << solverRegistry().size() << ", pieces " << simulation.pieces()
            << ", strain " << *std::max_element(strains.begin(), strains.end()) << '\n'
            << summaryJson(simulation, record, 1.0, false) << '\n';
  return simulation.failed() ? 1 : 0;
}
