#pragma once
/// \file A scene with contact, wind, clamps, cuts and tears at the same time.

#include <algorithm>
#include <cmath>
#include <string>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim::testing_support {

/// A cloth of n x n particles that falls on a sphere over a table, is notched, grasped and torn,
/// and is refined where it tears.
inline Scene busyScene(const std::string& method, int n = 64) {
  const bool limited = std::isfinite(findSolver(method).stabilityLimit);
  // A finer cloth has shorter springs and lighter particles: the largest stable step shrinks with
  // n.
  const std::string substeps = limited ? std::to_string(std::max(50, 50 * n / 64)) : "2";
  const std::string last = std::to_string(n - 3);
  const std::string half = std::to_string(n / 2);
  const std::string bending = findSolver(method).followsFabric ? "plate" : "springs";
  const std::string friction =
      findSolver(method).hasBendFriction ? ", bending_hysteresis: 2.0e-4" : "";
  return parseScene(R"(
seed: 3
cloth:
  size: [1, 1]
  particles: [)" + std::to_string(n) +
                        ", " + std::to_string(n) + R"(]
  pose: {position: [0, 0, 0.21]}
  random_offset: 0.01
  velocity: [0, 0, -1]
  fabric: {preset: interlock, damping: 1.0e-5)" +
                        friction +
                        R"(}
  bending: )" + bending +
                        R"(
solver: {method: )" + method +
                        R"(, dt: 0.0166666666666666667, substeps: )" + substeps +
                        R"(}
drag: 1.0
wind: {velocity: [1, 0, 0]}
obstacles:
  table: {type: board, size: [1.6, 1.6, 0.05], position: [0, 0, -0.025]}
  sphere: {type: sphere, radius: 0.1, position: [0, 0, 0.1]}
clamps:
  left: {patch: {particle: [2, )" +
                        half + R"(], radius: 3}, closing_speed: 3.0}
  right: {patch: {particle: [)" +
                        last + ", " + half + R"(], radius: 3}, closing_speed: 3.0}
tearing: {ratio: 1.2, seam: {path: [[0.5, 0], [0.5, 1]]}}
phases:
  - {name: fall, notch: [[0.5, 0], [0.5, 0.2]], timeout: 0.08}
  - {name: close, clamps: {all: {grasp: true}}, timeout: 0.08}
  - name: pull
    clamps: {left: {move_by: [-1, 0, 0.2], speed: 2.0}, right: {move_by: [1, 0, 0.2], speed: 2.0}}
    timeout: 10.0
)",
                    "busy.yaml");
}

inline std::uint64_t hashOf(const Simulation& simulation) {
  return stateHash(simulation.model(), simulation.state());
}

}  // namespace cloth_sim::testing_support
