#pragma once
/// \file Measures the longest substep with which each method is stable.

#include <string>
#include <vector>

#include "bisection.h"
#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

/// A cloth that vibrates in its fastest mode, without damping or gravity.
struct VibratingSystem {
  std::string name;        ///< "oscillator" or "cloth"
  double stiffness = 0.0;  ///< of its springs, or of its fabric along warp [N/m]
  double omega = 0.0;      ///< largest angular frequency of small vibrations [rad/s]
  Model model;
  State start;  ///< displaced along the mode
};

/// Makes two masses on a spring.
VibratingSystem makeOscillator();
/// Makes a small, flat, free cloth that vibrates in its plane. Its mode is the largest eigenvector
/// of the dense stiffness matrix.
VibratingSystem makeVibratingCloth();

/// Tells whether the energy of the springs stays bounded with substeps of `h` [s].
bool staysBounded(const SolverInfo& method, const VibratingSystem& system, double h);

struct StabilityLimit {
  const SolverInfo* method = nullptr;
  std::string system;
  double stiffness = 0.0;  ///< [N/m]
  double omega = 0.0;      ///< [rad/s]
  Bisection inOmegaH;      ///< probes and limit, in omega h
};

/// Measures the limit of a method on a system: omega h from 0.02 to 1000, to half a per cent.
StabilityLimit measureStability(const SolverInfo& method, const VibratingSystem& system);

}  // namespace cloth_sim
