#pragma once
/// \file A scene: the contents of a scene file as plain data, validated and with every default
/// filled in. docs/scene.md documents the keys.

#include <map>
#include <memory>

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/contact/collider.h"
#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/solver/registry.h"
#include "cloth_sim/solver/step_guard.h"
#include "cloth_sim/surgery/settings.h"
#include "cloth_sim/surgery/stroke.h"
#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {

/// Default reach of a blade to both sides of the path that it is drawn along [m].
constexpr double kDefaultReach = 1.0;

/// A particle that stays where the cloth starts.
struct PinSpec {
  int column = 0;           ///< of a grid
  int row = 0;              ///< of a grid
  VertexId vertex = kNone;  ///< of a mesh; kNone: the cloth is a grid
};

/// The mesh of a cloth that comes from a file.
struct ClothMesh {
  std::vector<Vec2> material;   ///< material coordinates by vertex, with a minimum of 0 [m]
  std::vector<Vec3> positions;  ///< by vertex, in the frame of the cloth [m]
  std::vector<Face> faces;      ///< counter-clockwise in material coordinates
};

/// One cloth: a grid, or a mesh from a file.
struct ClothSpec {
  std::string name = "cloth";
  int columns = 64;     ///< particles along u, 2 ... 2048
  int rows = 64;        ///< particles along v
  double width = 1.0;   ///< along u [m]
  double height = 1.0;  ///< along v [m]
  Diagonals diagonals = Diagonals::kOneWay;
  /// Takes the place of the grid if present. Columns, rows and diagonals then have no meaning, and
  /// width and height are the extent of the mesh in material coordinates.
  std::shared_ptr<const ClothMesh> mesh;
  /// Pose of the centre of a grid, or of the origin of a mesh. At the identity, u runs along x and
  /// v along y.
  Pose pose;
  /// Half-range of a uniform random shift of the whole cloth, drawn from Scene::seed [m].
  Vec3 randomOffset = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  Fabric fabric;
  std::optional<RawSprings> raw;       ///< constants instead of the fabric's
  std::optional<double> particleMass;  ///< [kg]; absent: from the areal density
  SpringSelection springs;
  bool plate = false;  ///< the bending energy of a plate (PlateBending) instead of bend springs
  std::vector<PinSpec> pins;
};

/// The longest side of all cloths [m].
double longestSide(const std::vector<ClothSpec>& cloths);

/// Offset of each cloth along u in the material plane of the model [m]. The first is 0. Each
/// further cloth starts at the first whole metre that is at least 1 m, and at least twice the
/// longest side of all cloths, beyond the end of the previous one, so no search near a cloth meets
/// another one.
std::vector<double> materialOffsets(const std::vector<ClothSpec>& cloths);

/// The choice of the method for a scene with `method: auto`.
struct AutoChoice {
  double error = 0.0;  ///< bound that the scene asks for [-]
  std::string source;  ///< origin of the choice, in words
};

/// The conditions under which a cloth counts as at rest and its steps are skipped.
struct SleepSettings {
  double speed = 1e-3;  ///< bound on the displacement of a particle in a step, over dt [m/s], > 0
  double after = 0.5;   ///< time for which the bound has to hold [s], > 0
};

/// The method, and the length of the steps that it takes.
struct SolverSpec {
  std::string method = "line_xpbd";  ///< a name of the registry
  double dt = 1.0 / 60.0;            ///< length of one simulation step [s], > 0
  StepGuard guard = StepGuard::kAllow;
  /// Parameters of the method; absent ones have its defaults. A scene file that names no method
  /// has `error` here (docs/scene.md).
  SolverParameters parameters;
  /// Present with `budget: real_time`: the budget that a calibration has led to. 0: it is still to
  /// be found (sim/real_time.h).
  std::optional<int> realTimeBudget;
  std::optional<SleepSettings> sleep = SleepSettings();  ///< absent: the cloth never sleeps
  std::optional<AutoChoice> choice;  ///< present with `method: auto`, which fills in the rest
};

/// The conditions that end a phase as soon as all that are present hold at the same time.
struct PhaseConditions {
  std::optional<double> elapsed;         ///< time since the phase began [s]
  std::optional<double> meanSpeedBelow;  ///< bound on the mean speed of the particles [m/s]
  double meanSpeedFor = 0.0;         ///< time for which the bound has to hold without a break [s]
  bool contact = false;              ///< some particle has touched an obstacle in this phase
  bool clampsAtTarget = false;       ///< every clamp stands at its target
  bool clampsClosed = false;         ///< every clamp that the script closes is closed
  std::optional<int> piecesAtLeast;  ///< number of connected pieces of cloth
  std::optional<int> brokenAtLeast;  ///< number of broken springs since the start

  /// Tells whether no condition is present.
  bool none() const;
  /// Returns what holds when the phase ends, as "the cloth is in 2 pieces"; "" without conditions.
  std::string text() const;
};

/// The commands of a phase to one clamp, given when the phase begins.
struct ClampAction {
  std::string clamp;
  bool hold = false;                ///< stop as soon as the limits allow
  bool attach = false;              ///< move to the present position of the centre of its patch
  std::optional<bool> grasp;        ///< true: close; false: release
  std::optional<Vec3> moveBy;       ///< displacement of the target [m]
  std::optional<Vec3> moveTo;       ///< new position of the target [m]
  std::optional<Quat> orientation;  ///< target orientation
  std::optional<double> speed;      ///< limit on the linear speed while this phase lasts [m/s]
};

/// The new velocities of an obstacle from the beginning of a phase on.
struct ObstacleAction {
  std::string obstacle;
  Vec3 velocity = Vec3::Zero();         ///< [m/s]
  Vec3 angularVelocity = Vec3::Zero();  ///< in the axes of the world [rad/s]
};

/// The consequence of a time-out of a phase whose conditions do not hold.
enum class OnTimeout { kContinue, kFail };

/// One phase of the script of a scene: actions at its beginning, and the conditions of its end.
struct PhaseSpec {
  std::string name;
  std::vector<ClampAction> clamps;
  std::vector<ObstacleAction> obstacles;
  std::optional<Wind> wind;           ///< absent: as before
  std::optional<bool> tearing;        ///< switches tearing on or off; absent: as before
  std::optional<TearRatios> ratio;    ///< limits of stretch; absent: as before
  std::optional<bool> quasiStatic;    ///< whether accelerations are negligible; absent: as before
  std::vector<MaterialPath> notches;  ///< cuts along paths in material coordinates
  std::vector<Stroke> strokes;        ///< cuts by blades in the world
  std::vector<RefineNear> refinements;
  PhaseConditions until;          ///< without any, the time-out or a command ends the phase
  std::optional<double> timeout;  ///< [s]
  OnTimeout onTimeout = OnTimeout::kFail;
};

/// Treatment of cloth that touches or intersects itself at the start.
enum class StartContact {
  kRefuse,   ///< the scene is not loaded
  kUntangle  ///< it is opened up
};

/// Everything that defines a simulation.
struct Scene {
  std::string name;  ///< file name without folder and extension
  std::string text;  ///< the file with its overrides, as YAML; "" without a file
  std::vector<ClothSpec> cloths{ClothSpec()};  ///< at least one
  SurgerySettings surgery;                     ///< for all cloths
  SolverSpec solver;
  Vec3 gravity = Vec3(0.0, 0.0, -9.81);
  double drag = 0.0;         ///< rate of linear air drag, dv/dt = -drag v [1/s], >= 0
  bool quasiStatic = false;  ///< accelerations are negligible: methods may add inertia
  std::optional<Wind> wind;
  bool selfContact = false;  ///< layers of cloth touch each other
  /// The reason why several cloths pass through each other although the scene does not say that
  /// they do; "" for none.
  std::string noLayers;
  StartContact startContact = StartContact::kRefuse;  ///< with `selfContact`
  std::optional<double> layerFriction;  ///< between layers [-], >= 0; absent: the fabrics'
  std::vector<Obstacle> obstacles;
  std::vector<ClampSpec> clamps;
  TearingSettings tearing;
  std::vector<PhaseSpec> phases;
  std::uint64_t seed = 1;  ///< of all random numbers
  /// The scene as it was loaded, if this one has other numbers of particles (scene/resolution.h).
  std::shared_ptr<const Scene> original;
  /// Hash of the length of a step and of all of the file but `solver`: equal for equal scenes. ""
  /// without a file.
  std::string contentKey;
};

}  // namespace cloth_sim
