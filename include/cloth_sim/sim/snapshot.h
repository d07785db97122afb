#pragma once
/// \file Immutable copies of a simulation for everybody else: publishers, recordings, figures.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/clamp/grip_event.h"
#include "cloth_sim/cloth/strain.h"
#include "cloth_sim/contact/layers.h"
#include "cloth_sim/scene/phase_script.h"
#include "cloth_sim/sim/counts.h"
#include "cloth_sim/sim/result_warning.h"
#include "cloth_sim/solver/error_estimate.h"
#include "cloth_sim/solver/step_guard.h"
#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {

/// The place of a cloth among the particles and in the material plane.
struct ClothPlace {
  std::string name;
  std::int32_t firstParticle = 0;  ///< its particles have consecutive ids from here at the start
  std::int32_t particles = 0;      ///< number at the start; edits append more behind all cloths
  double materialOffset = 0.0;     ///< u in the common material plane where its own u is 0 [m]
  std::optional<Grid> grid;        ///< that its mesh was made from, if any
};

/// The surface at one revision; shared by all snapshots of that revision.
struct Topology {
  std::uint64_t revision = 0;
  std::vector<ClothPlace> cloths;
  std::vector<Face> faces;     ///< vertex triples, counter-clockwise in material coordinates
  std::vector<Vec2> material;  ///< material coordinates by vertex [m]
  std::vector<StrainLine> strainLines;  ///< structural and shear springs (cloth/strain.h)
  /// Boundary edges that were not boundary at the start: the edges of tears and cuts.
  std::vector<std::array<VertexId, 2>> tornEdges;
  double shortestEdge = 0.0;  ///< at rest [m]
  double stableStep = 0.0;    ///< longest step of explicit methods [s]; see cloth/stable_step.h
};

struct ClampSnapshot {
  std::string name;
  Pose pose;
  Vec2 plateSize = Vec2::Zero();  ///< [m]
  double gap = 0.0;               ///< [m]
  ClampState state = ClampState::kOpen;
  GripContents contents;
  bool slipping = false;
  bool blocked = false;             ///< a layer of cloth keeps what it holds from following
  double slipped = 0.0;             ///< distance that the cloth has slid since the grasp [m]
  std::optional<double> gripForce;  ///< [N]; absent: no limit
  Wrench wrench;                    ///< of the cloth on the clamp, mean over the last step
};

/// One connected piece of cloth.
struct PieceSnapshot {
  int faces = 0;
  double mass = 0.0;                 ///< [kg]
  double restArea = 0.0;             ///< [m^2]
  Vec3 centreOfMass = Vec3::Zero();  ///< in the world [m]
};

/// Settings that commands may change while a simulation runs.
struct Tuning {
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
  std::optional<Wind> wind;     ///< absent: none
  bool tearing = false;         ///< whether springs may fail
  TearRatios ratio{};           ///< length over rest length at failure, by kind of spring [-]
  bool quasiStatic = false;     ///< whether motion is declared to be quasi-static
  double stiffness = 1.0;       ///< times the scene's stiffness [-]
};

/// Quantities that take a pass over all particles, springs or faces.
struct Figures {
  std::vector<PieceSnapshot> pieces{PieceSnapshot{}};  ///< the largest first
  double mass = 0.0;                                   ///< [kg]
  double restArea = 0.0;                               ///< [m^2]
  Energies energies;
  double meanSpeed = 0.0;   ///< [m/s]
  double maxStretch = 1.0;  ///< largest length over rest length, structural and shear springs [-]
  std::uint64_t hash = 0;   ///< stateHash
};

/// Contents of a snapshot: without or with figures.
enum class Detail { kShape, kFigures };

/// Contact between layers in a snapshot: its report alone, or with the places of the contacts.
enum class ContactDetail { kReport, kPoints };

/// A copy of a simulation between two steps.
struct Snapshot {
  double time = 0.0;       ///< [s]
  std::uint64_t step = 0;  ///< steps since the start or the last reset
  std::shared_ptr<const Topology> topology;
  std::vector<Vec3> positions;  ///< by vertex [m]
  std::vector<ClampSnapshot> clamps;
  std::vector<Obstacle> obstacles;       ///< with their pose now
  std::vector<Wrench> obstacleWrenches;  ///< of the cloth, by obstacle; see Obstacles::wrenches
  std::string phase;                     ///< current or last phase; "" without a script
  std::string phaseProgress;             ///< its number and what ends it, for people
  ScriptStatus script = ScriptStatus::kIdle;
  int particles = 0;
  int faces = 0;
  std::array<int, kSpringKinds> springs{0, 0, 0};  ///< number of active springs, by kind
  BrokenCounts broken;
  DroppedScraps dropped;
  Tuning tuning;
  int substeps = 0;                    ///< of the last step
  std::optional<ErrorEstimate> error;  ///< after the last step; absent: the method estimates none
  std::optional<LayerReport> layers;   ///< of the last step; absent: layers do not touch
  /// After the last step, with ContactDetail::kPoints; absent: not asked for, or as `layers`.
  std::optional<std::vector<LayerContactPoint>> contactPoints;
  GuardRecord guard;  ///< interventions of the step guard
  bool failed = false;
  std::string failure;                  ///< why the simulation stopped; "" if it did not
  std::vector<ResultWarning> warnings;  ///< what is doubtful although it goes on
  std::optional<Figures> figures;       ///< with Detail::kFigures
};

}  // namespace cloth_sim
