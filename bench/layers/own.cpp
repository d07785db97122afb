#include <stdexcept>

#include "cloth_sim/sim/simulation.h"
#include "task.h"

namespace cloth_sim::bench {
namespace {

class OwnCloth final : public LayeredCloth {
 public:
  OwnCloth(const LayersTask& task, bool layers) : simulation_(sceneOf(task, layers)) {
    if (task.start != Start::kHanging) simulation_.adopt(stateAtStart(task, layers));
  }
  void advance() override {
    simulation_.step();
    if (simulation_.failed()) throw std::runtime_error(simulation_.failure());
  }
  std::vector<Vec3> positions() const override { return simulation_.state().x.values(); }
  int contacts() const override {
    const auto report = simulation_.layerReport();
    return report ? report->contacts : 0;
  }
  int pairs() const override {
    const auto report = simulation_.layerReport();
    return report ? report->pairs : 0;
  }
  int substeps() const override { return simulation_.lastReport().substeps; }

 private:
  /// The scene's saved state, with the positions of the task.
  static std::string stateAtStart(const LayersTask& task, bool layers) {
    SimulationParts parts(sceneOf(task, layers));
    const std::vector<Vec3> x = startOf(task);
    for (VertexId v = 0; v < parts.model.particleCount(); ++v) parts.state.x[v] = x[v];
    if (layers && !parts.layers->findOverlap(parts.model, x).pairs.empty()) {
      throw std::logic_error("the start has faces that touch");
    }
    return saveParts(parts);
  }

  Simulation simulation_;
};

}  // namespace

std::unique_ptr<LayeredCloth> ownCloth(const LayersTask& task, bool layers) {
  return std::make_unique<OwnCloth>(task, layers);
}

std::vector<LayersContender> contenders() {
  return {
      {"cloth_sim", "without", false, [](const LayersTask& task) { return ownCloth(task, false); }},
      {"cloth_sim", "`self_contact`", true,
       [](const LayersTask& task) { return ownCloth(task, true); }}};
}

}  // namespace cloth_sim::bench
