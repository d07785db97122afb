#pragma once
/// \file A scene as plain validated data: what a scene file says, with every default filled in.

#include <map>
#include <memory>

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/contact/collider.h"
#include "cloth_sim/solver/registry.h"
#include "cloth_sim/solver/step_guard.h"
#include "cloth_sim/surgery/settings.h"
#include "cloth_sim/surgery/stroke.h"
#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {

/// How far a blade drawn along a path reaches to both sides of it, where nobody says [m].
constexpr double kDefaultReach = 1.0;

/// A particle that is held where the cloth starts: of a grid, or of a mesh.
struct PinSpec {
  int column = 0;
  int row = 0;
  VertexId vertex = kNone;  ///< of a mesh
};

/// A cloth that is not a grid, as a file gave it.
struct ClothMesh {
  std::vector<Vec2> material;   ///< material coordinates of each vertex, the least are 0 [m]
  std::vector<Vec3> positions;  ///< of each vertex in the cloth's frame [m]
  std::vector<Face> faces;      ///< counter-clockwise in material coordinates
};

struct ClothSpec {
  std::string name = "cloth";
  int columns = 64;     ///< particles along u, 2 ... 2048
  int rows = 64;        ///< particles along v
  double width = 1.0;   ///< along u [m]
  double height = 1.0;  ///< along v [m]
  /// Instead of a grid; then columns and rows mean nothing, and width and height are its extent in
  /// material coordinates.
  std::shared_ptr<const ClothMesh> mesh;
  /// Of the middle of a grid, where at the identity orientation u runs along x and v along y; of
  /// the origin of a mesh.
  Pose pose;
  Vec3 randomOffset =
      Vec3::Zero();              ///< half-range of a seeded uniform shift of the whole cloth [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  Fabric fabric;
  std::optional<RawSprings> raw;       ///< springs by constants instead of by the fabric
  std::optional<double> particleMass;  ///< [kg] instead of the fabric's areal density
  SpringSelection springs;
  bool plate = false;  ///< the bending energy of a plate (PlateBending) instead of bend springs
  std::vector<PinSpec> pins;
};

/// The longest side of any [m].
double longestSide(const std::vector<ClothSpec>& cloths);

/// Where each cloth's own u = 0 lies in the material plane [m]: the first at 0, each further one at
/// the first whole metre that is at least 1 m, and twice the longest side of any, beyond the end of
/// the one before. So what is beside a cloth is no other one.
std::vector<double> materialOffsets(const std::vector<ClothSpec>& cloths);

/// How a method was chosen for a scene that left it open.
struct AutoChoice {
  double error = 0.0;  ///< that the scene asks for
  std::string source;  ///< where the choice comes from, in words
};

/// When a cloth counts as at rest and is no longer computed.
struct SleepSettings {
  double speed = 1e-3;  ///< every particle is slower than this [m/s], > 0 ...
  double after = 0.5;   ///< ... for this long [s], > 0
};

struct SolverSpec {
  std::string method = "xpbd";
  double dt = 1.0 / 60.0;  ///< of one simulation step [s]
  StepGuard guard = StepGuard::kAllow;
  SolverParameters parameters;                           ///< complete
  std::optional<SleepSettings> sleep = SleepSettings();  ///< absent: every step is computed
  std::optional<AutoChoice> choice;  ///< the scene says `auto`: all of the above is chosen
};

/// What must hold for a phase to end: all that are given, at the same time.
struct PhaseConditions {
  std::optional<double> elapsed;         ///< since the phase began [s]
  std::optional<double> meanSpeedBelow;  ///< [m/s] ...
  double meanSpeedFor = 0.0;             ///< ... for this long without a break [s]
  bool contact = false;                  ///< some particle has touched an obstacle in this phase
  bool clampsAtTarget = false;           ///< every clamp stands at its target
  bool clampsClosed = false;             ///< every clamp told to close in this script is closed
  std::optional<int> piecesAtLeast;      ///< connected pieces of cloth
  std::optional<int> brokenAtLeast;      ///< springs failed in all

  bool none() const;
};

/// What a phase tells one clamp when it begins.
struct ClampAction {
  std::string clamp;
  bool hold = false;                ///< stop where it is, as soon as its limits allow
  bool attach = false;              ///< go to the middle of its patch, where the cloth is now
  std::optional<bool> grasp;        ///< true: close; false: release
  std::optional<Vec3> moveBy;       ///< target: where its target is now, plus this [m]
  std::optional<Vec3> moveTo;       ///< target position [m]
  std::optional<Quat> orientation;  ///< target orientation
  std::optional<double> speed;      ///< limit on the linear speed while this phase lasts [m/s]
};

struct ObstacleAction {
  std::string obstacle;
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

enum class OnTimeout { kContinue, kFail };

struct PhaseSpec {
  std::string name;
  std::vector<ClampAction> clamps;
  std::vector<ObstacleAction> obstacles;
  std::optional<Wind> wind;           ///< from here on
  std::optional<bool> tearing;        ///< enable switch
  std::optional<TearRatios> ratio;    ///< thresholds from here on
  std::vector<MaterialPath> notches;  ///< cuts given in material coordinates
  std::vector<Stroke> strokes;        ///< cuts given in the world
  std::vector<RefineNear> refinements;
  PhaseConditions until;          ///< none: the phase lasts until its time-out or a command
  std::optional<double> timeout;  ///< [s]
  OnTimeout onTimeout = OnTimeout::kFail;
};

struct Scene {
  std::string name;  ///< file name without path and ending
  std::string text;  ///< the scene file with the overrides in it, as YAML; "" if it is of no file
  std::vector<ClothSpec> cloths{ClothSpec()};  ///< at least one
  SurgerySettings surgery;                     ///< of all cloths
  SolverSpec solver;
  Vec3 gravity = Vec3(0.0, 0.0, -9.81);
  double drag = 0.0;  ///< [1/s]
  std::optional<Wind> wind;
  std::vector<Obstacle> obstacles;
  std::vector<ClampSpec> clamps;
  TearingSettings tearing;
  std::vector<PhaseSpec> phases;
  std::uint64_t seed = 1;
  /// Of all that the file says except its method, and the length of a step: the same for the same
  /// scene. "" if it comes from no file.
  std::string contentKey;
};

}  // namespace cloth_sim
