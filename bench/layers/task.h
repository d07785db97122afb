#pragma once
/// \file The scene of the benchmark of contact between layers, the same for all engines.

#include <memory>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim::bench {

enum class Start {
  kHanging,   ///< a cloth hangs from its two upper corners, nowhere near itself
  kHemmed,    ///< a cloth lies on a table, an eighth of it on the next: a quarter touches itself
  kFolded,    ///< a cloth lies on a table, folded once
  kTwoHalves  ///< its two halves lie there on each other, as two cloths
};

/// A square cloth of 1 m, or its two halves.
struct LayersTask {
  Start start = Start::kHanging;
  int particles = 128;  ///< along each side, even
};

/// Distance that layers keep [m].
constexpr double kThickness = 0.001;

/// \param layers  whether layers touch each other.
Scene sceneOf(const LayersTask& task, bool layers);
/// Positions at the start, in the order of the vertices of the scene [m]. Folded cloth is nowhere
/// stretched along its rows and columns; its layers are a little more than the thickness apart.
std::vector<Vec3> startOf(const LayersTask& task);

/// The height of each particle of the upper layer over its partner in the lower one [m], except
/// within 5 % of the side from the fold and for folded cloths only.
/// \param x  by vertex [m].
std::vector<double> gapsOf(const LayersTask& task, const std::vector<Vec3>& x);

/// A cloth in an engine.
class LayeredCloth {
 public:
  virtual ~LayeredCloth() = default;
  /// Simulates one frame.
  virtual void advance() = 0;
  /// By vertex of the scene [m].
  virtual std::vector<Vec3> positions() const = 0;
  /// Contacts between layers now.
  virtual int contacts() const = 0;
  /// Pairs of faces near each other; 0 where an engine has none.
  virtual int pairs() const { return 0; }
  virtual int substeps() const = 0;  ///< of the last frame
};

/// An engine with a setting.
struct LayersContender {
  std::string engine;
  std::string setting;
  bool touches = false;  ///< whether layers touch each other
  std::unique_ptr<LayeredCloth> (*make)(const LayersTask&) = nullptr;
  bool halves = false;  ///< simulates two halves where the task is a folded cloth
};

/// A cloth of this package, with its default method.
std::unique_ptr<LayeredCloth> ownCloth(const LayersTask& task, bool layers);
/// This package, without and with contact between layers.
std::vector<LayersContender> contenders();
/// Bullet, in the ways in which its soft bodies can touch.
std::vector<LayersContender> peersOf(Start start);

}  // namespace cloth_sim::bench
