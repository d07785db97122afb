#pragma once
/// \file Immutable copies of what a simulation shows to others.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/clamp/grip_event.h"
#include "cloth_sim/scene/phase_script.h"
#include "cloth_sim/solver/step_guard.h"
#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {

/// Where a cloth is among the particles, and in the material plane.
struct ClothPlace {
  std::string name;
  std::int32_t firstParticle = 0;  ///< of those that it had at the start: ids in a row
  std::int32_t particles = 0;      ///< at the start; edits add more at the end of all
  double materialOffset = 0.0;     ///< u where its own u is 0 [m]
};

/// The surface at one revision; shared by all snapshots of that revision.
struct Topology {
  std::uint64_t revision = 0;
  std::vector<ClothPlace> cloths;
  std::vector<Face> faces;
  std::vector<Vec2> material;  ///< per vertex [m]
  /// Structural and shear springs, as vertex pairs with rest lengths: what strain is drawn from.
  struct Link {
    VertexId a = kNone;
    VertexId b = kNone;
    double restLength = 0.0;  ///< [m]
  };
  std::vector<Link> links;
  /// Boundary edges that were not boundary at the start: where it tore.
  std::vector<std::array<VertexId, 2>> tornEdges;
  double shortestEdge = 0.0;  ///< at rest [m]
  double stableStep = 0.0;    ///< bound for explicit methods [s]; see cloth/stable_step.h
};

struct ClampSnapshot {
  std::string name;
  Pose pose;
  Vec2 plateSize = Vec2::Zero();  ///< [m]
  double gap = 0.0;               ///< [m]
  ClampState state = ClampState::kOpen;
  GripContents contents;  ///< now
  bool slipping = false;
  double slipped = 0.0;             ///< how far the cloth has slid since it was grasped [m]
  std::optional<double> gripForce;  ///< [N]; absent: any
  Wrench wrench;
};

/// Counts of failed springs. total = structural + shear + bend = torn + cut.
struct BrokenCounts {
  int total = 0;
  std::array<int, kSpringKinds> byKind{0, 0, 0};
  int torn = 0;
  int cut = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(total, byKind, torn, cut);
  }
};

/// One connected piece of cloth.
struct PieceSnapshot {
  int faces = 0;
  double mass = 0.0;                 ///< [kg]
  double restArea = 0.0;             ///< [m^2]
  Vec3 centreOfMass = Vec3::Zero();  ///< in the world [m]
};

/// Loose pieces that were taken away.
struct DroppedScraps {
  int count = 0;
  double mass = 0.0;      ///< [kg]
  double restArea = 0.0;  ///< [m^2]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(count, mass, restArea);
  }
};

/// What may be turned while a simulation runs, as it is now.
struct Tuning {
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
  std::optional<Wind> wind;
  bool tearing = false;  ///< enabled
  TearRatios ratio{};
  double stiffness = 1.0;  ///< times the scene's [-]
};

/// What takes a look at every particle, spring and face.
struct Figures {
  std::vector<PieceSnapshot> pieces{PieceSnapshot{}};  ///< the largest first
  double mass = 0.0;                                   ///< [kg]
  double restArea = 0.0;                               ///< [m^2]
  Energies energies;
  double meanSpeed = 0.0;   ///< [m/s]
  double maxStretch = 1.0;  ///< length over rest length
  std::uint64_t hash = 0;   ///< stateHash
};

/// What a snapshot is to show.
enum class Detail { kShape, kFigures };

struct Snapshot {
  double time = 0.0;       ///< [s]
  std::uint64_t step = 0;  ///< steps since the start or the last reset
  std::shared_ptr<const Topology> topology;
  std::vector<Vec3> positions;  ///< per vertex [m]
  std::vector<ClampSnapshot> clamps;
  std::vector<Obstacle> obstacles;  ///< with their pose now
  std::string phase;                ///< "" without a script; the last one's name once it is done
  ScriptStatus script = ScriptStatus::kIdle;
  int particles = 0;
  int faces = 0;
  std::array<int, kSpringKinds> springs{0, 0, 0};  ///< active, by kind
  BrokenCounts broken;
  DroppedScraps dropped;
  Tuning tuning;
  int substeps = 0;   ///< of the last step
  GuardRecord guard;  ///< what was done about steps that were too long
  bool failed = false;
  std::string failure;             ///< why the simulation stopped; "" if it did not
  std::optional<Figures> figures;  ///< with Detail::kFigures
};

}  // namespace cloth_sim
