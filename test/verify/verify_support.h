#pragma once
/// \file Small models with analytic solutions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/scene.h"
#include "unit/core_support.h"

namespace cloth_sim::verify_support {

constexpr double kGravity = 9.81;  // [m/s^2]

/// Returns whether the method converges to the stiffness of the fabric.
inline bool isConsistent(const SolverInfo& info) { return info.order > 0; }

/// Returns a bound on the largest angular frequency of a model, by Gershgorin's circles [rad/s].
inline double frequencyBound(const Model& model) {
  const double h = stableStep(model), tau = model.cloths[0].fabric.damping;
  return 2.0 / std::sqrt(h * h + 2.0 * h * tau);
}

/// A clamp "hand" for a patch of the first cloth, parallel to it at height `z` [m]; it closes at
/// once.
inline ClampSpec quickHand(const Scene& scene, const ClampPatch& patch, double z) {
  ClampSpec hand;
  hand.name = "hand";
  hand.patch = patch;
  hand.pose.position.z() = z;
  hand.pose.orientation = scene.cloths[0].pose.orientation;
  hand.closingSpeed = 10.0;
  return hand;
}

/// A method with a model and a state of its own.
class Rig {
 public:
  /// Makes a run with one substep per step unless `parameters` give another number.
  Rig(const SolverInfo& info, Model cloth, const SolverParameters& parameters = {{"substeps", 1.0}})
      : model(std::move(cloth)),
        state(testing_support::flatState(model)),
        solver_(info.create(model, completeParameters(info, parameters))) {}

  /// Holds a particle at its position.
  void hold(VertexId v) { controls.kinematic.push_back({v, state.x[v], Vec3::Zero()}); }

  /// Takes `steps` steps of length `h`. \return whether the method reported no failure.
  bool run(double h, int steps) {
    for (int k = 0; k < steps; ++k) {
      Contacts contacts;
      if (solver_->step(model, state, controls, contacts, {h}).status != StepStatus::kOk) {
        return false;
      }
    }
    return true;
  }

  Model model;
  State state;
  Controls controls;

 private:
  std::unique_ptr<Solver> solver_;
};

/// Makes a chain along x: `count` masses m [kg] at distances of `spacing` [m], joined by springs of
/// stiffness k [N/m] and retardation time tau [s]. The model has two such chains, the rows of a
/// strip with almost no stiffness between them.
inline Model chainOf(int count, double spacing, double k, double m, double tau = 0.0) {
  Fabric fabric;
  fabric.tensileWarp = 2.0 * k;  // k = K A / L^2, with one face, A = L^2 / 2, on each edge
  fabric.tensileWeft = 1e-12 * k;
  fabric.shear = 0.0;
  fabric.bending = 0.0;
  fabric.damping = tau;
  ClothSpec spec = testing_support::clothOf(count, 2, spacing, fabric);
  spec.springs = {false, false};
  spec.particleMass = m;
  return buildModel(spec);
}

/// Calls `visit(row, column, vertex)` on every particle of a grid.
template <typename Visit>
void forGrid(const Model& model, const Visit& visit) {
  for (int row = 0; row < model.cloths[0].grid->rows; ++row) {
    for (int column = 0; column < model.cloths[0].grid->columns; ++column) {
      visit(row, column, model.cloths[0].grid->vertex(column, row));
    }
  }
}

inline double totalEnergy(const Rig& rig) {
  const Energies e = energies(rig.model, rig.state, rig.controls.gravity);
  return e.kinetic + e.elastic + e.gravity;
}

/// The speed of the fastest particle [m/s].
inline double fastestSpeed(const State& state) {
  double fastest = 0.0;
  for (const Vec3& v : state.v.values()) fastest = std::max(fastest, v.norm());
  return fastest;
}

/// Records a measured value in the XML report.
inline void record(const std::string& name, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  testing::Test::RecordProperty(name, text);
}

/// Instantiates the tests of a file for every registered method.
class OverMethods : public testing::TestWithParam<std::string> {
 protected:
  const SolverInfo& info() const { return findSolver(GetParam()); }
};

}  // namespace cloth_sim::verify_support
