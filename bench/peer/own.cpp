#include <sstream>

#include "cloth.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim::bench {
namespace {

std::string sceneOf(const Task& task) {
  std::ostringstream out;
  out << "cloth:\n  size: [" << task.side << ", " << task.side << "]\n  particles: ["
      << task.particles << ", " << task.particles << "]\n  pose: {position: [0.0, 0.0, "
      << task.height << "]" << (task.sphere ? "" : ", rpy: [1.5707963267948966, 0.0, 0.0]")
      << "}\n  fabric: {preset: cotton, areal_density: " << task.mass / (task.side * task.side)
      << "}\n  bending: springs\n";
  if (!task.sphere) out << "  pins: [corner_01, corner_11]\n";
  out << "drag: 0.5\nsolver: {sleep: false, dt: " << task.frame
      << "}\nphases: [{name: all, timeout: 1000.0}]\n";
  // Tearing is enabled, as it is where people cut and tear, at a ratio that no spring reaches: the
  // first jerk stretches those beside the pins by 7 with few substeps of `xpbd`.
  out << "tearing: {enabled: true, ratio: 1000.0}\n";
  if (task.sphere) {
    const Vec3& c = task.sphere->centre;
    out << "obstacles:\n  ground: {type: plane}\n  ball: {type: sphere, radius: "
        << task.sphere->radius << ", position: [" << c.x() << ", " << c.y() << ", " << c.z()
        << "], friction: 0.5}\n";
  }
  return out.str();
}

class OwnCloth final : public Cloth {
 public:
  OwnCloth(const Task& task, const std::vector<std::string>& overrides)
      : simulation_(parseScene(sceneOf(task), "task", overrides)) {}

  void advance() override {
    simulation_.step();
    if (simulation_.failed()) throw std::runtime_error(simulation_.failure());
  }
  Grid3 positions() const override { return copy(simulation_.state().x); }
  Grid3 velocities() const override { return copy(simulation_.state().v); }

 private:
  static Grid3 copy(const VertexData<Vec3>& data) {
    Grid3 result;
    for (VertexId v = 0; v < static_cast<VertexId>(data.size()); ++v) result.push_back(data[v]);
    return result;
  }

  Simulation simulation_;
};

}  // namespace

Contender own(const std::string& method, const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {"solver.method=" + method};
  all.insert(all.end(), overrides.begin(), overrides.end());
  std::string setting = method;
  for (const std::string& text : overrides) setting += " " + text.substr(text.find('.') + 1);
  return {"cloth_sim", setting,
          [=](const Task& task) { return std::make_unique<OwnCloth>(task, all); }};
}

}  // namespace cloth_sim::bench
