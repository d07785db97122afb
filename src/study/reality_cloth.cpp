#include "reality_cloth.h"

#include <algorithm>
#include <stdexcept>

#include "cloth_sim/scene/build.h"

namespace cloth_sim {

HeldCloth::HeldCloth(const ClothSpec& spec, const HeldMethod& method)
    : model_(buildModel(spec)), method_(method) {
  const SolverInfo& info = findSolver(method.name);
  state = initialState({spec}, model_, 1);
  solver_ = info.create(model_, completeParameters(info, method.parameters));
  controls.gravity = Vec3(0.0, 0.0, -kRealityGravity);
}

void HeldCloth::hold(VertexId v) {
  auto& held = controls.kinematic;
  const auto at =
      std::lower_bound(held.begin(), held.end(), v,
                       [](const KinematicTarget& a, VertexId b) { return a.vertex < b; });
  if (at == held.end() || at->vertex != v) held.insert(at, {v, state.x[v], Vec3::Zero()});
}

void HeldCloth::moveHeld(const Vec3& by) {
  for (KinematicTarget& target : controls.kinematic) {
    target.position += by;
    target.velocity = by / method_.dt;
  }
}

void HeldCloth::step() {
  Contacts contacts;
  report_ = solver_->step(model_, state, controls, contacts, {method_.dt});
  if (report_.status != StepStatus::kOk) {
    throw std::runtime_error(method_.name + " diverged in a comparison with measured cloth");
  }
  time_ += method_.dt;
}

bool HeldCloth::settle(double speed, double most, double calm) {
  const double end = time_ + most;
  double calmSince = time_;
  while (time_ < end) {
    step();
    if (fastest() > speed) calmSince = time_;
    if (time_ - calmSince >= calm) return true;
  }
  return false;
}

double HeldCloth::fastest() const {
  double square = 0.0;
  for (const Vec3& v : state.v.values()) square = std::max(square, v.squaredNorm());
  return std::sqrt(square);
}

Fabric plainFabric(double density, double bending, double tensile, double shear) {
  Fabric fabric;
  fabric.arealDensity = density;
  fabric.bending = bending;
  fabric.tensileWarp = fabric.tensileWeft = tensile;
  fabric.shear = shear;
  fabric.damping = 0.0;
  fabric.thickness = 0.0;
  return fabric;
}

ClothSpec stripOf(const Fabric& fabric, int cells, int rows, double spacing) {
  ClothSpec spec;
  spec.columns = cells + 1;
  spec.rows = rows;
  spec.width = spacing * cells;
  spec.height = spacing * (rows - 1);
  spec.fabric = fabric;
  spec.springs = {true, false};
  spec.plate = true;
  return spec;
}

}  // namespace cloth_sim
