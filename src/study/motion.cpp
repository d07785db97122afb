#include "motion.h"

namespace cloth_sim {
namespace {

Scene cottonSquare(int particles) {
  Scene scene;
  ClothSpec& cloth = scene.cloths[0];
  cloth.columns = cloth.rows = particles;
  cloth.width = cloth.height = 1.0;
  cloth.fabric = fabricPreset("cotton");
  scene.drag = 0.5;
  return scene;
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

double energyScale(const Motion& motion) {
  const ClothSpec& cloth = motion.scene.cloths[0];
  return cloth.fabric.arealDensity * cloth.width * cloth.height * motion.scene.gravity.norm() *
         0.5 * cloth.height;
}

}  // namespace cloth_sim
