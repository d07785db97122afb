#include "readers.h"
#include "section.h"

namespace cloth_sim {
namespace {

const KeyTable kSeamKeys{"`tearing.seam`", {"cloth", "path", "half_width"}};

Seam readSeam(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  node.expectKeys(kSeamKeys.names);
  Seam seam;
  const std::size_t cloth = readClothName(node, cloths);
  seam.path = readPath(node.need("path", "a list of points [u, v]"), cloths, cloth);
  Range range = kNotNegative;
  // Cloths lie side by side in the material plane: a wider seam would reach the next one.
  if (cloths.size() > 1) range.maximum = longestSide(cloths);
  node.read("half_width", seam.halfWidth, range);
  return seam;
}

const Section<TearingSettings> kTearingSection{
    "`tearing`",
    {{"enabled", &TearingSettings::enabled},
     {"by"},
     {"ratio",
      [](const SceneNode& value, TearingSettings& tearing) { tearing.ratio = readRatios(value); }},
     {"seam"},
     {"tip_speed", &TearingSettings::tipSpeed, kPositive},
     {"refine_tip", [](const SceneNode& value, TearingSettings& tearing) {
        tearing.refineTip = readRefinement(value);
      }}}};

}  // namespace

void readTearing(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                 TearingSettings& tearing) {
  tearing.enabled = true;
  kTearingSection.read(node, tearing);
  if (const auto seam = node.find("seam")) tearing.seam = readSeam(*seam, cloths);
}

void listTearingKeys(std::vector<KeyTable>& tables) {
  tables.push_back(kTearingSection.keys());
  tables.push_back(kSeamKeys);
}

}  // namespace cloth_sim
