#pragma once
/// \file Common interface of the cloths that a peer and this package simulate.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "figures.h"

namespace cloth_sim::bench {

/// Task for all contenders: a square cloth and its obstacles.
struct Task {
  int particles = 128;        ///< along each side
  double side = 1.0;          ///< [m]
  double mass = 0.2;          ///< [kg]
  double frame = 1.0 / 60.0;  ///< [s]
  double duration = 5.0;      ///< [s]
  /// Sphere on the ground, on which the cloth falls. Without one, the cloth hangs from its two
  /// upper corners.
  struct Sphere {
    Vec3 centre;
    double radius = 0.0;  ///< [m]
  };
  std::optional<Sphere> sphere;
  double height = 1.0;  ///< of the middle of the cloth at the start [m]
};

class Cloth {
 public:
  virtual ~Cloth() = default;
  /// Simulates one frame.
  virtual void advance() = 0;
  virtual Grid3 positions() const = 0;
  virtual Grid3 velocities() const = 0;
};

/// An engine with its setting.
struct Contender {
  std::string engine;
  std::string setting;
  std::function<std::unique_ptr<Cloth>(const Task&)> make;
};

/// Bullet's soft body.
/// \param substeps  per frame.
/// \param iterations  per substep.
Contender bullet(int substeps, int iterations);
/// This package.
/// \param method  name in the registry.
/// \param overrides  of the scene, such as "solver.iterations=2".
Contender own(const std::string& method, const std::vector<std::string>& overrides);

}  // namespace cloth_sim::bench
