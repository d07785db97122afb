#include <algorithm>
#include <stdexcept>

#include "keys.h"
#include "readers.h"

namespace cloth_sim {

namespace {

constexpr Range kTimeStep{0.0, 1.0, true, false};  // [s]
constexpr int kMaxPatchRadius = 1024;              // [particles]

const char* const kAuto = "auto";
constexpr Range kError{0.0, 1.0, true, false};

/// The method; nullptr if it is to be chosen.
const SolverInfo* readMethod(const SceneNode& node, SolverSpec& solver) {
  const auto method = node.find("method");
  if (!method) return &findSolver(solver.method);
  std::vector<std::pair<std::string, const SolverInfo*>> known;
  for (const SolverInfo& info : solverRegistry()) known.emplace_back(info.name, &info);
  known.emplace_back(kAuto, nullptr);
  const SolverInfo* info = method->choice(known);
  if (info != nullptr) solver.method = info->name;
  return info;
}

void readParameter(const SceneNode& node, const SolverParameter& parameter,
                   SolverParameters& parameters) {
  const auto value = node.find(parameter.name);
  if (!value) return;
  parameters[parameter.name] =
      parameter.integer
          ? static_cast<double>(value->integer(static_cast<std::int64_t>(parameter.minimum),
                                               static_cast<std::int64_t>(parameter.maximum)))
          : value->number({parameter.minimum, parameter.maximum, false, false});
}

void readParameters(const SceneNode& node, const SolverInfo& info, SolverParameters& parameters) {
  for (const SolverParameter& parameter : info.parameters) {
    readParameter(node, parameter, parameters);
  }
  try {
    parameters = completeParameters(info, parameters);
  } catch (const std::invalid_argument& error) {
    node.refuse(error.what());
  }
}

std::optional<SleepSettings> readSleep(const SceneNode& node) {
  SleepSettings sleep;
  if (node.isScalar()) return node.boolean() ? std::optional(sleep) : std::nullopt;
  node.expectKeys(keys::kSleep);
  node.read("speed", sleep.speed, kPositive);
  node.read("after", sleep.after, kPositive);
  return sleep;
}

ClampPatch readPatch(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  node.expectKeys(keys::kPatch);
  ClampPatch patch;
  patch.cloth = readClothName(node, cloths);
  const PinSpec centre = readParticle(node.need("particle", "[column, row]"), cloths[patch.cloth]);
  patch.column = centre.column;
  patch.row = centre.row;
  node.read("radius", patch.radius, 0, kMaxPatchRadius);
  return patch;
}

/// Where the middle of a patch is before the cloth's random offset.
Vec3 patchPosition(const ClampPatch& patch, const ClothSpec& cloth) {
  const double u = cloth.width * patch.column / (cloth.columns - 1);
  const double v = cloth.height * patch.row / (cloth.rows - 1);
  return cloth.pose.toWorld({u - 0.5 * cloth.width, v - 0.5 * cloth.height, 0.0});
}

/// Above its patch by the open gap, unless the scene gives a place.
void readClampPose(const SceneNode& node, const std::vector<ClothSpec>& cloths, ClampSpec& clamp) {
  const auto pose = node.find("pose");
  if (!pose && !clamp.patch) node.missing("pose", "a map, as the clamp has no patch");
  if (clamp.patch) {
    const ClothSpec& cloth = cloths[clamp.patch->cloth];
    clamp.pose.position = patchPosition(*clamp.patch, cloth) + Vec3(0.0, 0.0, clamp.gapOpen);
  }
  if (!pose) return;
  pose->expectKeys(keys::kPose);
  readPose(*pose, clamp.pose);
}

void readGap(const SceneNode& node, ClampSpec& clamp) {
  node.read("gap_open", clamp.gapOpen, kPositive);
  node.read("gap_closed", clamp.gapClosed, kPositive);
  if (clamp.gapClosed < clamp.gapOpen) return;
  node.refuse("expected gap_closed < gap_open (got " + shortNumber(clamp.gapClosed) + " and " +
              shortNumber(clamp.gapOpen) + ")");
}

ClampSpec readClamp(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  const std::string defect = clampNameDefect(node.key());
  if (!defect.empty()) node.refuse(defect);
  node.expectKeys(keys::kClamp);
  ClampSpec clamp;
  clamp.name = node.key();
  if (const auto patch = node.find("patch")) clamp.patch = readPatch(*patch, cloths);
  readGap(node, clamp);
  readClampPose(node, cloths, clamp);
  node.read("plate_size", clamp.plateSize, kPositive);
  node.read("closing_speed", clamp.closingSpeed, kPositive);
  node.read("max_speed", clamp.maxLinearSpeed, kPositive);
  node.read("max_angular_speed", clamp.maxAngularSpeed, kPositive);
  node.read("max_acceleration", clamp.maxLinearAcceleration, kPositive);
  node.read("grip_force", clamp.gripForce, kPositive);
  return clamp;
}

Seam readSeam(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  node.expectKeys(keys::kSeam);
  Seam seam;
  const std::size_t cloth = readClothName(node, cloths);
  seam.path = readPath(node.need("path", "a list of points [u, v]"), cloths, cloth);
  // Wider, and it would reach the next one.
  Range range = kNotNegative;
  if (cloths.size() > 1) range.maximum = longestSide(cloths);
  node.read("half_width", seam.halfWidth, range);
  return seam;
}

}  // namespace

void readSolver(const SceneNode& node, SolverSpec& solver) {
  if (!node.isMap()) node.expected("a map with a method");
  const SolverInfo* info = readMethod(node, solver);
  keys::Keys allowed = keys::kSolver;
  if (info != nullptr) {
    for (const SolverParameter& parameter : info->parameters) allowed.push_back(parameter.name);
  }
  node.expectKeys(allowed);
  node.read("dt", solver.dt, kTimeStep);
  if (const auto guard = node.find("step_guard")) {
    solver.guard = guard->choice<StepGuard>({{"allow", StepGuard::kAllow},
                                             {"subdivide", StepGuard::kSubdivide},
                                             {"refuse", StepGuard::kRefuse}});
  }
  if (const auto sleep = node.find("sleep")) solver.sleep = readSleep(*sleep);
  const auto error = node.find("error");
  if (info == nullptr) {
    solver.choice = AutoChoice{node.need("error", kError.text()).number(kError), ""};
  } else {
    if (error) error->refuse("expected only beside method: auto (got " + info->name + ")");
    readParameters(node, *info, solver.parameters);
  }
}

Wind readWind(const SceneNode& node) {
  node.expectKeys(keys::kWind);
  Wind wind;
  node.read("velocity", wind.velocity);
  node.read("density", wind.density, kNotNegative);
  node.read("drag_coefficient", wind.dragCoefficient, kNotNegative);
  return wind;
}

void readClamps(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                std::vector<ClampSpec>& clamps) {
  for (const SceneNode& entry : node.entries()) clamps.push_back(readClamp(entry, cloths));
}

void readTearing(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                 TearingSettings& tearing) {
  node.expectKeys(keys::kTearing);
  tearing.enabled = true;
  node.read("enabled", tearing.enabled);
  if (const auto ratio = node.find("ratio")) tearing.ratio = readRatios(*ratio);
  if (const auto seam = node.find("seam")) tearing.seam = readSeam(*seam, cloths);
  node.read("tip_speed", tearing.tipSpeed, kPositive);
  if (const auto refine = node.find("refine_tip")) tearing.refineTip = readRefinement(*refine);
}

}  // namespace cloth_sim
