#include "scenes.h"

#include <cmath>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

constexpr int kSamples = 4;

bool operates(const PhaseSpec& phase) {
  return !phase.notches.empty() || !phase.strokes.empty() || !phase.refinements.empty();
}

}  // namespace

bool StudyScene::isSmooth() const {
  const bool hasPlate = std::any_of(scene.cloths.begin(), scene.cloths.end(),
                                    [](const ClothSpec& cloth) { return cloth.plate; });
  return !hasPlate && scene.obstacles.empty() && scene.clamps.empty() && !scene.wind &&
         !scene.tearing.enabled && std::none_of(scene.phases.begin(), scene.phases.end(), operates);
}

const std::vector<std::string>& studySceneNames() {
  static const std::vector<std::string> names{"hang_swing", "in_plane_wave", "drape_sphere",
                                              "table_edge", "seam_tear"};
  return names;
}

StudyScene loadStudyScene(const std::string& folder, const std::string& name) {
  Scene scene = loadScene(folder + "/" + name + ".yaml");
  double duration = 0.0;
  for (const PhaseSpec& phase : scene.phases) duration += phase.timeout.value_or(0.0);
  StudyScene study = studyOf(std::move(scene), duration);
  study.name = name;
  return study;
}

StudyScene studyOf(Scene scene, double duration, int multiple) {
  StudyScene study;
  const double unit = multiple * scene.solver.dt;
  const auto units = std::max<long>(1, std::lround(duration / unit));
  for (int k = 1; k <= kSamples; ++k) {
    const double at =
        unit * std::max<long>(1, std::lround(static_cast<double>(units) * k / kSamples));
    if (study.samples.empty() || at > study.samples.back()) study.samples.push_back(at);
  }
  study.name = scene.name;
  study.duration = unit * units;
  study.tearing = scene.tearing.enabled;
  study.scene = std::move(scene);
  return study;
}

}  // namespace cloth_sim
