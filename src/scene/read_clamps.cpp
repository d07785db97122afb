#include "readers.h"
#include "section.h"

namespace cloth_sim {
namespace {

constexpr int kMaxPatchRadius = 1024;  // [particles]

const Section<ClampPatch> kPatchSection{
    "`clamps.<name>.patch`",
    {{"cloth"}, {"particle"}, {"radius", &ClampPatch::radius, 0, kMaxPatchRadius}}};

ClampPatch readPatch(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  ClampPatch patch = kPatchSection.read(node);
  patch.cloth = readClothName(node, cloths);
  const PinSpec centre = readParticle(node.need("particle", "[column, row]"), cloths[patch.cloth]);
  patch.column = centre.column;
  patch.row = centre.row;
  return patch;
}

/// Position of the centre of a patch at the start, without the random offset of the cloth [m].
Vec3 patchPosition(const ClampPatch& patch, const ClothSpec& cloth) {
  const double u = cloth.width * patch.column / (cloth.columns - 1);
  const double v = cloth.height * patch.row / (cloth.rows - 1);
  return cloth.pose.toWorld({u - 0.5 * cloth.width, v - 0.5 * cloth.height, 0.0});
}

/// Reads the pose of a clamp. By default it is above the centre of its patch by the open gap.
void readClampPose(const SceneNode& node, const std::vector<ClothSpec>& cloths, ClampSpec& clamp) {
  const auto pose = node.find("pose");
  if (!pose && !clamp.patch) node.missing("pose", "a map, as the clamp has no patch");
  if (clamp.patch) {
    const ClothSpec& cloth = cloths[clamp.patch->cloth];
    clamp.pose.position = patchPosition(*clamp.patch, cloth) + Vec3(0.0, 0.0, clamp.gapOpen);
  }
  if (!pose) return;
  readPoseMap(*pose, clamp.pose);
}

/// Keys that are read by hand need the cloths. The pose follows from the patch and the open gap.
const Section<ClampSpec> kClampSection{
    "`clamps.<name>`",
    {{"pose"},
     {"patch"},
     {"plate_size", &ClampSpec::plateSize, kPositive},
     {"gap_open", &ClampSpec::gapOpen, kPositive},
     {"gap_closed", &ClampSpec::gapClosed, kPositive},
     {"closing_speed", &ClampSpec::closingSpeed, kPositive},
     {"max_speed", &ClampSpec::maxLinearSpeed, kPositive},
     {"max_angular_speed", &ClampSpec::maxAngularSpeed, kPositive},
     {"max_acceleration", &ClampSpec::maxLinearAcceleration, kPositive},
     {"grip_force", &ClampSpec::gripForce, kPositive}}};

void checkGap(const SceneNode& node, const ClampSpec& clamp) {
  if (clamp.gapClosed < clamp.gapOpen) return;
  node.refuse("expected gap_closed < gap_open (got " + shortNumber(clamp.gapClosed) + " and " +
              shortNumber(clamp.gapOpen) + ")");
}

ClampSpec readClamp(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  const std::string error = clampNameError(node.key());
  if (!error.empty()) node.refuse(error);
  ClampSpec clamp = kClampSection.read(node);
  clamp.name = node.key();
  checkGap(node, clamp);
  if (const auto patch = node.find("patch")) clamp.patch = readPatch(*patch, cloths);
  readClampPose(node, cloths, clamp);
  return clamp;
}

}  // namespace

void readClamps(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                std::vector<ClampSpec>& clamps) {
  for (const SceneNode& entry : node.entries()) clamps.push_back(readClamp(entry, cloths));
}

void listClampKeys(std::vector<KeyTable>& tables) {
  tables.push_back(kClampSection.keys());
  tables.push_back(kPatchSection.keys());
}

}  // namespace cloth_sim
