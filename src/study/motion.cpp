#include "motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth_sim {
namespace {

constexpr double kThickAir = 4.0;  ///< drag that soon brings a cloth to rest [1/s]

Scene cottonSquare(int particles) {
  Scene scene;
  ClothSpec& cloth = scene.cloths[0];
  cloth.columns = cloth.rows = particles;
  cloth.width = cloth.height = 1.0;
  cloth.fabric = fabricPreset("cotton");
  scene.drag = 0.5;
  return scene;
}

Obstacle obstacle(const std::string& name, const Shape& shape, const Vec3& position) {
  Obstacle result;
  result.name = name;
  result.shape = shape;
  result.pose.position = position;
  return result;
}

/// A clamp that is open around its patch. \param place  relative to the middle of the cloth [m].
ClampSpec openClamp(const std::string& name, const ClampPatch& patch, const ClothSpec& cloth,
                    const Vec3& place) {
  ClampSpec clamp;
  clamp.name = name;
  clamp.patch = patch;
  clamp.pose.position = cloth.pose.position + place;
  clamp.gapOpen = 0.03;
  clamp.closingSpeed = 1.0;
  return clamp;
}

/// A clamp at a corner of the upper edge that grasps 5 cm of the cloth.
ClampSpec cornerClamp(const std::string& name, const ClothSpec& cloth, bool right) {
  const int reach = std::max(1, cloth.columns / 32);
  const ClampPatch patch{right ? cloth.columns - 1 : 0, cloth.rows - 1, reach, 0};
  ClampSpec clamp = openClamp(name, patch, cloth, Vec3(right ? 0.5 : -0.5, 0.5, 0.0));
  clamp.maxLinearSpeed = 2.0;
  clamp.maxLinearAcceleration = 20.0;
  return clamp;
}

/// A clamp at the middle of a side that grasps 4 cm of the cloth.
ClampSpec sideClamp(const std::string& name, const ClothSpec& cloth, bool right) {
  const int reach = std::max(1, cloth.columns / 40);
  const int column = right ? cloth.columns - 1 - reach : reach;
  const double x = cloth.width * (column / (cloth.columns - 1.0) - 0.5);
  return openClamp(name, ClampPatch{column, cloth.rows / 2, reach, 0}, cloth, Vec3(x, 0.0, 0.0));
}

/// A phase that moves the clamps for a time, wherever they are at its end; they grasp if they do
/// not move.
PhaseSpec moveClamps(const std::string& name, const Vec3& left, const Vec3& right, double time) {
  PhaseSpec phase;
  phase.name = name;
  for (const auto& [clamp, by] : {std::pair("left", left), std::pair("right", right)}) {
    ClampAction action;
    action.clamp = clamp;
    if (by.isZero()) action.grasp = true;
    if (!by.isZero()) action.moveBy = by;
    phase.clamps.push_back(action);
  }
  phase.timeout = time;
  phase.onTimeout = OnTimeout::kContinue;
  return phase;
}

PhaseSpec moveBoth(const std::string& name, const Vec3& by, double time) {
  return moveClamps(name, by, by, time);
}

}  // namespace

Motion edgeSwing(int n) {
  Motion motion{"swing", cottonSquare(n), 0.8};
  ClothSpec& cloth = motion.scene.cloths[0];
  cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.25 * M_PI, Vec3::UnitX()));
  for (int k = 0; k < n; ++k) cloth.pins.push_back({k, n - 1});
  return motion;
}

Motion cornerHang(int n) {
  Motion motion{"hang", cottonSquare(n), 1.5};
  motion.scene.cloths[0].pins = {{0, n - 1}, {n - 1, n - 1}};
  return motion;
}

Motion ballDrop(int n) {
  Motion motion{"drop", cottonSquare(n), 2.0, true};
  constexpr double kRadius = 0.25;
  motion.scene.cloths[0].pose.position.z() = 0.05;
  motion.scene.obstacles = {obstacle("ball", SphereShape{kRadius}, Vec3(0.0, 0.0, -kRadius))};
  motion.scene.drag = kThickAir;
  return motion;
}

Motion tableEdge(int n) {
  Motion motion{"table", cottonSquare(n), 1.0};
  motion.scene.cloths[0].pose.position.z() = 1e-3;
  // Its top is z = 0, its edge x = 0.1.
  motion.scene.obstacles = {
      obstacle("table", BoxShape{Vec3(1.2, 1.4, 0.04)}, Vec3(-0.5, 0.0, -0.02))};
  motion.scene.obstacles[0].friction = 0.8;
  return motion;
}

Motion shakenTowel(int n) {
  Motion motion{"towel", cottonSquare(n), 1.5};
  Scene& scene = motion.scene;
  scene.drag = kThickAir;
  scene.cloths[0].pose.position.z() = 1e-3;
  scene.obstacles = {obstacle("ground", PlaneShape(), Vec3::Zero())};
  scene.clamps = {cornerClamp("left", scene.cloths[0], false),
                  cornerClamp("right", scene.cloths[0], true)};
  scene.phases = {moveBoth("grasp", Vec3::Zero(), 0.1), moveBoth("lift", Vec3(0.0, 0.0, 1.2), 0.8),
                  moveBoth("back", Vec3(0.0, 0.1, 0.0), 0.2),
                  moveBoth("forth", Vec3(0.0, -0.2, 0.0), 0.2),
                  moveBoth("hold", Vec3(0.0, 0.1, 0.0), 0.2)};
  return motion;
}

Motion seamPull(int n) {
  Motion motion{"pull", cottonSquare(n), 1.2, false, true};
  constexpr double kSpeed = 0.2;   // of each clamp [m/s]
  constexpr double kNotch = 0.09;  // length [m]
  constexpr double kRatio = 1.2;   // of springs that fail
  Scene& scene = motion.scene;
  ClothSpec& cloth = scene.cloths[0];
  cloth.pose.position.z() = 1e-3;
  scene.obstacles = {obstacle("table", PlaneShape(), Vec3::Zero())};
  scene.clamps = {sideClamp("left", cloth, false), sideClamp("right", cloth, true)};
  const int left = n / 2 - 1;  // the column beside the seam
  const double middle = cloth.width * (left + 0.5) / (n - 1);
  scene.tearing.enabled = true;
  scene.tearing.ratio.fill(kRatio);
  scene.tearing.seam = Seam{{Vec2(middle, 0.0), Vec2(middle, cloth.height)}, 0.0};
  const Vec3 away(0.5, 0.0, 0.0);
  PhaseSpec pull = moveClamps("pull", -away, away, 1.1);
  for (ClampAction& action : pull.clamps) action.speed = kSpeed;
  pull.quasiStatic = true;
  pull.notches = {{Vec2(middle, 0.0), Vec2(middle, kNotch)}};
  scene.phases = {moveBoth("grasp", Vec3::Zero(), 0.1), pull};
  return motion;
}

const std::vector<MotionMaker>& motionMakers() {
  static const std::vector<MotionMaker> all = {edgeSwing, cornerHang,  ballDrop,
                                               tableEdge, shakenTowel, seamPull};
  return all;
}

double energyScale(const Motion& motion) {
  const ClothSpec& cloth = motion.scene.cloths[0];
  return cloth.fabric.arealDensity * cloth.width * cloth.height * motion.scene.gravity.norm() *
         0.5 * cloth.height;
}

}  // namespace cloth_sim
