#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>

#include "cloth_sim/scene/load.h"
#include "scene/section.h"

#ifndef CLOTH_SIM_SOURCE_DIR
#define CLOTH_SIM_SOURCE_DIR "."
#endif

namespace cloth_sim {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

const std::string kSceneFolder = std::string(CLOTH_SIM_SOURCE_DIR) + "/config/scenes";

std::string shipped(const std::string& name) { return kSceneFolder + "/" + name + ".yaml"; }

/// Returns the error message of a scene; "" if it is valid.
std::string complaint(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  try {
    parseScene(yaml, "s.yaml", overrides);
    return "";
  } catch (const SceneError& error) {
    return error.what();
  }
}

Scene parse(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return parseScene(yaml, "s.yaml", overrides);
}

/// A scene with something of everything.
const char* const kFull = R"(seed: 5
cloth:
  size: [2.0, 1.0]
  particles: [21, 11]
  pose: {position: [0, 0, 1]}
solver: {method: xpbd, dt: 0.01, substeps: 7}
obstacles:
  table: {type: board, size: [1, 1, 0.1], friction: 0.7}
  ball: {type: sphere, radius: 0.1}
clamps:
  left: {patch: {particle: [1, 5]}}
  free: {pose: {position: [1, 0, 1]}}
tearing:
  ratio: 2
  seam: {path: [[1, 0], [1, 1]]}
phases:
  - name: wait
    until: {elapsed: 1}
  - name: go
    clamps: {all: {move_by: [0, 0, 1], speed: 0.1}, free: {speed: 0.2}}
    timeout: 3
)";

// ---- what is there by default -----------------------------------------------------------------

TEST(Scene, SaysHowCellsAreDivided) {
  EXPECT_EQ(parse("cloth: {}").cloths[0].diagonals, Diagonals::kOneWay);
  EXPECT_EQ(parse("cloth: {diagonals: one_way}").cloths[0].diagonals, Diagonals::kOneWay);
  const Scene scene = parse("cloth: {particles: [5, 5], diagonals: alternating}");
  EXPECT_EQ(scene.cloths[0].diagonals, Diagonals::kAlternating);
}

TEST(Scene, NeedsOnlyACloth) {
  const Scene scene = parse("cloth: {}");
  EXPECT_EQ(scene.name, "s");
  EXPECT_EQ(scene.cloths[0].columns, 64);
  EXPECT_EQ(scene.cloths[0].fabric.name, "cotton");
  EXPECT_TRUE(scene.cloths[0].springs.shear);
  EXPECT_TRUE(scene.cloths[0].springs.bend);
  EXPECT_EQ(scene.solver.method, "line_xpbd");
  EXPECT_EQ(scene.solver.parameters.at("error"), 0.01);
  EXPECT_EQ(scene.solver.parameters.at("budget"), 40.0);
  EXPECT_EQ(scene.gravity, Vec3(0.0, 0.0, -9.81));
  EXPECT_FALSE(scene.wind.has_value());
  EXPECT_FALSE(scene.tearing.enabled);
  EXPECT_EQ(scene.tearing.ratio[0], kNever);
  EXPECT_TRUE(scene.obstacles.empty());
  EXPECT_TRUE(scene.clamps.empty());
  EXPECT_TRUE(scene.phases.empty());
}

TEST(Scene, ReadsWhatIsGiven) {
  const Scene scene = parse(kFull);
  EXPECT_EQ(scene.seed, 5u);
  EXPECT_EQ(scene.cloths[0].width, 2.0);
  EXPECT_EQ(scene.cloths[0].rows, 11);
  EXPECT_EQ(scene.solver.dt, 0.01);
  EXPECT_EQ(scene.solver.parameters.at("substeps"), 7.0);
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].name, "table");
  EXPECT_EQ(std::get<BoxShape>(scene.obstacles[0].shape).size, Vec3(1.0, 1.0, 0.1));
  EXPECT_EQ(scene.obstacles[0].friction, 0.7);
  EXPECT_EQ(std::get<SphereShape>(scene.obstacles[1].shape).radius, 0.1);
  EXPECT_FALSE(scene.obstacles[1].friction.has_value()) << "the fabric's";
  EXPECT_TRUE(scene.tearing.enabled);
  EXPECT_EQ(scene.tearing.ratio, (TearRatios{2.0, 2.0, 2.0}));
  ASSERT_EQ(scene.tearing.seam->path.size(), 2u);
  ASSERT_EQ(scene.phases.size(), 2u);
  EXPECT_EQ(scene.phases[0].until.elapsed, 1.0);
  EXPECT_EQ(scene.phases[1].timeout, 3.0);
}

TEST(Scene, ClampStartsAboveItsPatch) {
  const Scene scene = parse(kFull);
  const ClampSpec& left = scene.clamps[0];
  // Particle (1, 5) of a cloth of 2 m x 1 m with its middle at (0, 0, 1), spacing 0.1 m.
  EXPECT_TRUE(left.pose.position.isApprox(Vec3(-0.9, 0.0, 1.0 + left.gapOpen), 1e-12));
  EXPECT_EQ(left.patch->radius, 3);
  EXPECT_FALSE(scene.clamps[1].patch.has_value());
  EXPECT_EQ(scene.clamps[1].pose.position, Vec3(1.0, 0.0, 1.0));
}

TEST(Scene, OneClampsActionGoesBeforeThatOfAll) {
  const std::vector<ClampAction> actions = parse(kFull).phases[1].clamps;
  ASSERT_EQ(actions.size(), 2u);
  EXPECT_EQ(actions[0].clamp, "left");
  EXPECT_EQ(actions[0].speed, 0.1);
  EXPECT_EQ(actions[1].clamp, "free");
  EXPECT_EQ(actions[1].speed, 0.2);
  EXPECT_EQ(actions[1].moveBy, Vec3(0.0, 0.0, 1.0));
}

TEST(Scene, RotationsByAnglesOrQuaternion) {
  const double h = std::sqrt(0.5);
  const Scene scene = parse(
      "cloth: {pose: {rpy: [1.5707963267948966, 0, 0]}}\n"
      "obstacles: {p: {type: plane, orientation: [0.7071068, 0, 0, 0.7071068]}}");
  const Quat quarterTurn(h, h, 0.0, 0.0);
  EXPECT_LT(scene.cloths[0].pose.orientation.angularDistance(quarterTurn), 1e-12);
  EXPECT_LT(scene.obstacles[0].pose.orientation.angularDistance(quarterTurn), 1e-6);
  EXPECT_NEAR(scene.obstacles[0].pose.orientation.norm(), 1.0, 1e-15);
}

TEST(Scene, FabricByNameOrByValues) {
  EXPECT_EQ(parse("cloth: {fabric: denim}").cloths[0].fabric.arealDensity, 0.324);
  EXPECT_EQ(parse("cloth: {fabric: {preset: denim}}").cloths[0].fabric.name, "denim");
  const Fabric custom = parse("cloth: {fabric: {preset: denim, damping: 0}}").cloths[0].fabric;
  EXPECT_EQ(custom.name, "custom");
  EXPECT_EQ(custom.damping, 0.0);
  EXPECT_EQ(custom.tensileWarp, 2028.0);
}

TEST(Scene, RawSpringsNameTheKindsThereAre) {
  const ClothSpec cloth =
      parse("cloth: {raw_springs: {structural: 10, shear: 5, per_stretch: true}}").cloths[0];
  EXPECT_TRUE(cloth.springs.shear);
  EXPECT_FALSE(cloth.springs.bend);
  EXPECT_TRUE(cloth.raw->perStretch);
  EXPECT_FALSE(parse("cloth: {bending: none}").cloths[0].springs.bend);
  EXPECT_FALSE(parse("cloth: {bending: plate}").cloths[0].springs.bend);
  EXPECT_TRUE(parse("cloth: {bending: plate}").cloths[0].plate);
  EXPECT_TRUE(parse("cloth: {bending: hinge}").cloths[0].plate) << "the name in older scenes";
  EXPECT_FALSE(parse("cloth: {bending: plate, fabric: {bending: 0}}").cloths[0].plate);
  EXPECT_FALSE(parse("cloth: {fabric: {bending: 0}}").cloths[0].springs.bend);
}

TEST(Scene, AClothThatNamesAFabricBendsByTheEnergyOfAPlate) {
  const auto isPlate = [](const std::string& yaml) {
    const ClothSpec cloth = parse(yaml).cloths[0];
    EXPECT_NE(cloth.plate, cloth.springs.bend) << yaml;
    return cloth.plate;
  };
  EXPECT_TRUE(isPlate("cloth: {fabric: silk}"));
  EXPECT_FALSE(isPlate("cloth: {fabric: silk, bending: springs}"));
  EXPECT_FALSE(isPlate("cloth: {}"));
  EXPECT_FALSE(isPlate("cloth: {fabric: silk}\nsolver: {method: pbd}"));
  EXPECT_FALSE(isPlate("cloth: [{name: a, fabric: silk}, {name: b, fabric: {damping: 0.01}}]"));
}

TEST(Scene, PinsByParticleAndByName) {
  const std::vector<PinSpec> pins =
      parse("cloth: {particles: [4, 3], pins: [[1, 2], corner_10, first_column]}").cloths[0].pins;
  std::vector<std::pair<int, int>> got;
  for (const PinSpec& pin : pins) got.emplace_back(pin.column, pin.row);
  EXPECT_THAT(got, testing::ElementsAre(std::pair(1, 2), std::pair(3, 0), std::pair(0, 0),
                                        std::pair(0, 1), std::pair(0, 2)));
}

TEST(Scene, RandomOffsetForAllAxesOrEach) {
  EXPECT_EQ(parse("cloth: {random_offset: 0.1}").cloths[0].randomOffset, Vec3::Constant(0.1));
  EXPECT_EQ(parse("cloth: {random_offset: [0.1, 0, 0]}").cloths[0].randomOffset,
            Vec3(0.1, 0.0, 0.0));
}

TEST(Scene, TearRatiosByKindAndInfinity) {
  EXPECT_EQ(parse("cloth: {}\ntearing: {ratio: {shear: 1.5}}").tearing.ratio,
            (TearRatios{kNever, 1.5, kNever}));
  EXPECT_EQ(parse("cloth: {}\ntearing: {ratio: .inf}").tearing.ratio[2], kNever);
}

TEST(Scene, NotchIsOnePathOrSeveral) {
  const auto notches = [](const std::string& notch) {
    return parse("cloth: {}\nphases: [{name: a, notch: " + notch + "}]").phases[0].notches;
  };
  EXPECT_EQ(notches("[[0, 0], [0.5, 0.5], [1, 1]]").size(), 1u);
  EXPECT_EQ(notches("[[0, 0], [0.5, 0.5], [1, 1]]")[0].size(), 3u);
  EXPECT_EQ(notches("[[[0, 0], [0, 1]], [[1, 0], [1, 1]]]").size(), 2u);
}

TEST(Scene, SurgeryHasDefaults) {
  const Scene scene = parse("cloth: {}");
  EXPECT_EQ(scene.surgery.snap, 0.2);
  EXPECT_FALSE(scene.surgery.minEdge.has_value());
  EXPECT_EQ(scene.surgery.maxParticles, 1048576);
  EXPECT_EQ(scene.surgery.dropBelow, 0.0);
  EXPECT_FALSE(scene.surgery.clearStrip);
  EXPECT_FALSE(scene.surgery.refineCuts.has_value());
  EXPECT_EQ(scene.tearing.tipSpeed, TearingSettings().tipSpeed);
  EXPECT_FALSE(scene.tearing.refineTip.has_value());
}

TEST(Scene, ReadsSurgery) {
  const SurgerySettings surgery = parse(R"(
cloth:
  surgery: {snap: 0.1, min_edge: 0.001, max_particles: 5000, drop_below: 1e-4, clear_strip: true,
            refine_cuts: {radius: 0.05, generations: 0, min_edge: 0.002}}
)",
                                        {"cloth.particles=[50, 100]"})
                                      .surgery;
  EXPECT_EQ(surgery.snap, 0.1);
  EXPECT_EQ(surgery.minEdge, 0.001);
  EXPECT_EQ(surgery.maxParticles, 5000);  // as many as the grid has: nothing can be added
  EXPECT_EQ(surgery.dropBelow, 1e-4);
  EXPECT_TRUE(surgery.clearStrip);
  EXPECT_EQ(surgery.refineCuts->radius, 0.05);
  EXPECT_EQ(surgery.refineCuts->generations, 0);
  EXPECT_EQ(surgery.refineCuts->minEdge, 0.002);
}

TEST(Scene, LargestGridsMayHaveTheParticlesTheyStartWith) {
  EXPECT_EQ(parse("cloth: {particles: [1024, 1074]}").surgery.maxParticles, 1024 * 1074);
}

TEST(Scene, ReadsHowTearsRun) {
  const TearingSettings tearing =
      parse("cloth: {}\ntearing: {tip_speed: 0.5, refine_tip: {radius: 0.1}}").tearing;
  EXPECT_EQ(tearing.tipSpeed, 0.5);
  EXPECT_EQ(tearing.refineTip->radius, 0.1);
  EXPECT_EQ(tearing.refineTip->generations, 3);
  EXPECT_EQ(tearing.refineTip->minEdge, 0.0);
}

std::vector<Stroke> strokes(const std::string& cut) {
  return parse("cloth: {}\nphases: [{name: a, cut: " + cut + "}]").phases[0].strokes;
}

TEST(Scene, StrokeAlongAPathReachesToBothSides) {
  const std::vector<Stroke> read =
      strokes("{path: [[0, 0, 1], [0.5, 0, 1]], direction: [0, 3, 0]}");
  ASSERT_EQ(read.size(), 1u);
  ASSERT_EQ(read[0].poses.size(), 2u);
  EXPECT_TRUE(read[0].poses[0].heel.isApprox(Vec3(0.0, -1.0, 1.0), 1e-12));
  EXPECT_TRUE(read[0].poses[1].tip.isApprox(Vec3(0.5, 1.0, 1.0), 1e-12));
  EXPECT_FALSE(read[0].firstLayerOnly);
  EXPECT_EQ(read[0].halfWidth, 0.0);
}

TEST(Scene, StrokesOfAMovingBladeInAList) {
  const std::vector<Stroke> read = strokes(
      "[{path: [[0, 0, 1], [1, 0, 1]], direction: [0, 1, 0], reach: 0.2, half_width: 0.01},"
      " {blades: [[[0, 0, 0], [0, 0, 1]], [[1, 0, 0], [1, 0, 2]]], first_layer: true}]");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read[0].poses[0].tip.isApprox(Vec3(0.0, 0.2, 1.0), 1e-12));
  EXPECT_EQ(read[0].halfWidth, 0.01);
  ASSERT_EQ(read[1].poses.size(), 2u);
  EXPECT_EQ(read[1].poses[1].heel, Vec3(1.0, 0.0, 0.0));
  EXPECT_EQ(read[1].poses[1].tip, Vec3(1.0, 0.0, 2.0));
  EXPECT_TRUE(read[1].firstLayerOnly);
}

TEST(Scene, RefinementsAroundPathsAndPoints) {
  const auto refinements = [](const std::string& refine) {
    return parse("cloth: {}\nphases: [{name: a, refine: " + refine + "}]").phases[0].refinements;
  };
  const auto one = refinements("{point: [0, 0, 1], radius: 0.2}");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].path, std::vector<Vec3>{Vec3(0.0, 0.0, 1.0)});
  EXPECT_EQ(one[0].refinement.radius, 0.2);
  EXPECT_EQ(one[0].refinement.generations, 3);
  const auto two = refinements(
      "[{path: [[0, 0, 1]], radius: 1},"
      " {path: [[0, 0, 1], [1, 0, 1]], radius: 0.1, generations: 12, min_edge: 0.01}]");
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].path.size(), 2u);
  EXPECT_EQ(two[1].refinement.generations, 12);
  EXPECT_EQ(two[1].refinement.minEdge, 0.01);
}

TEST(Scene, StrokesThatCannotBeCarriedOutAreRefusedByWhatIsWrongWithThem) {
  for (const char* cut :
       {"{path: [[0, 0, 1], [0, 0, 1]], direction: [0, 1, 0]}",           // goes nowhere
        "{blades: [[[0, 0, 0], [0, 0, 0]], [[1, 0, 0], [1, 0, 0]]]}",     // no blade
        "{blades: [[[0, 0, 0], [0, 0, 1]], [[0, 0, 0], [0, 0, 1]]]}"}) {  // goes nowhere
    SCOPED_TRACE(cut);
    const std::string message =
        complaint("cloth: {}\nphases: [{name: a, cut: " + std::string(cut) + "}]");
    EXPECT_THAT(message, testing::StartsWith("s.yaml:2: phases.a.cut: "));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(Scene, ConditionsAndTimeouts) {
  const PhaseSpec phase = parse(std::string(kFull) + R"(  - name: last
    until: {mean_speed: {below: 0.1, for: 2}, contact: true, clamps: [at_target, closed],
            pieces: 2, broken: 9}
    timeout: 4
    on_timeout: continue
)")
                              .phases.back();
  EXPECT_EQ(phase.until.meanSpeedBelow, 0.1);
  EXPECT_EQ(phase.until.meanSpeedFor, 2.0);
  EXPECT_TRUE(phase.until.contact);
  EXPECT_TRUE(phase.until.clampsAtTarget);
  EXPECT_TRUE(phase.until.clampsClosed);
  EXPECT_EQ(phase.until.piecesAtLeast, 2);
  EXPECT_EQ(phase.until.brokenAtLeast, 9);
  EXPECT_EQ(phase.onTimeout, OnTimeout::kContinue);
}

// ---- shipped scenes ---------------------------------------------------------------------------

TEST(ShippedScenes, AllLoad) {
  for (const char* name : {"tear_seam", "tear_seam_explicit", "hang", "drape_sphere", "table_edge",
                           "wind", "cut", "curtain_relaxed", "curtain_hover", "curtain_gusts",
                           "explicit_hang", "explicit_blows_up"}) {
    SCOPED_TRACE(name);
    Scene scene;
    ASSERT_NO_THROW(scene = loadScene(shipped(name)));
    EXPECT_EQ(scene.name, name);
    EXPECT_FALSE(scene.phases.empty());
  }
}

TEST(ShippedScenes, AllTakeAnotherMethodWithItsSubsteps) {
  for (const auto& file : std::filesystem::directory_iterator(kSceneFolder)) {
    if (file.path().extension() != ".yaml") continue;
    SCOPED_TRACE(file.path());
    Scene scene;
    ASSERT_NO_THROW(scene =
                        loadScene(file.path(), {"solver.method=verlet", "solver.substeps=1500"}));
    EXPECT_EQ(scene.solver.method, "verlet");
    EXPECT_EQ(scene.solver.parameters, (SolverParameters{{"substeps", 1500.0}}));
  }
}

/// The figures of the published demo.
void expectTheTearingRun(const Scene& scene) {
  const int n = 128;
  EXPECT_EQ(scene.cloths[0].columns, n);
  EXPECT_EQ(scene.cloths[0].rows, n);
  EXPECT_EQ(scene.cloths[0].pose.position, Vec3(0.0, 0.0, 0.9));
  EXPECT_EQ(scene.cloths[0].randomOffset, Vec3(0.05, 0.05, 0.0));
  std::vector<std::string> names;
  for (const PhaseSpec& phase : scene.phases) names.push_back(phase.name);
  EXPECT_THAT(names, testing::ElementsAre("drop", "settle", "attach", "close", "lift",
                                          "lower_and_notch", "pull_and_tear", "stop"));
  EXPECT_EQ(scene.clamps[0].patch->column, 2);
  EXPECT_EQ(scene.clamps[0].patch->row, n / 2);
  EXPECT_EQ(scene.clamps[1].patch->column, n - 3);
  EXPECT_EQ(scene.clamps[1].patch->row, n / 2);
  for (const ClampSpec& clamp : scene.clamps) {
    EXPECT_EQ(clamp.patch->radius, 3);
    EXPECT_EQ(clamp.gapOpen, 0.12);
    EXPECT_EQ(clamp.gapClosed, 0.02);
  }
  const double cell = 1.0 / (n - 1);
  const double seam = scene.tearing.seam->path.front().x();
  const int middle = n / 2;
  EXPECT_GT(seam, (middle - 1) * cell);
  EXPECT_LT(seam, middle * cell);
  EXPECT_EQ(scene.tearing.ratio[0], 3.0);
  EXPECT_EQ((*scene.phases[6].ratio)[0], 1.2);
  // The notch cuts the threads of 12 rows, 0 to 11: it ends between row 11 and row 12.
  const double notchEnd = scene.phases[5].notches.at(0).back().y();
  EXPECT_GT(notchEnd, 11.0 * cell);
  EXPECT_LT(notchEnd, 12.0 * cell);
}

TEST(ShippedScenes, TearSeamHasThePublishedFigures) {
  expectTheTearingRun(loadScene(shipped("tear_seam")));
  expectTheTearingRun(loadScene(shipped("tear_seam_explicit")));
}

TEST(ShippedScenes, ExplicitTearSeamHasThePublishedConstants) {
  const Scene scene = loadScene(shipped("tear_seam_explicit"));
  EXPECT_EQ(scene.solver.method, "symplectic_euler");
  EXPECT_NEAR(scene.solver.dt / scene.solver.parameters.at("substeps"), 0.04 / 128.0, 1e-15);
  EXPECT_EQ(scene.cloths[0].raw->constant, (std::array<double, 3>{3e4, 3e4, 0.0}));
  EXPECT_TRUE(scene.cloths[0].raw->perStretch);
  EXPECT_EQ(scene.cloths[0].raw->dashpot, 1e4 / 128.0);
  EXPECT_EQ(scene.cloths[0].particleMass, 1.0);
  EXPECT_FALSE(scene.cloths[0].springs.bend);
  EXPECT_EQ(scene.drag, 1.0);
  EXPECT_EQ(scene.obstacles[0].friction, 0.0);
  EXPECT_EQ(scene.obstacles[0].tangentialDecay, 2.0);
}

// ---- overrides --------------------------------------------------------------------------------

TEST(Overrides, ReplaceAddAndRemove) {
  const Scene scene =
      parse(kFull, {"cloth.particles=[31, 41]", "cloth.particles.1=51", "drag=0.25",
                    "phases.go.timeout=9", "phases.0.until.elapsed=2", "obstacles.ball=null",
                    "clamps.left.gap_open=0.1", "wind.velocity=[1, 0, 0]"});
  EXPECT_EQ(scene.cloths[0].columns, 31);
  EXPECT_EQ(scene.cloths[0].rows, 51);
  EXPECT_EQ(scene.drag, 0.25);
  EXPECT_EQ(scene.phases[1].timeout, 9.0);
  EXPECT_EQ(scene.phases[0].until.elapsed, 2.0);
  EXPECT_EQ(scene.obstacles.size(), 1u);
  EXPECT_EQ(scene.clamps[0].gapOpen, 0.1);
  EXPECT_EQ(scene.wind->velocity, Vec3(1.0, 0.0, 0.0));
}

TEST(Overrides, ChangeOneAliasOnly) {
  const char* const yaml =
      "cloth: {}\n"
      "obstacles: {a: &ball {type: sphere, radius: 1}, b: *ball}";
  const Scene scene = parse(yaml, {"obstacles.a.radius=2"});
  EXPECT_EQ(std::get<SphereShape>(scene.obstacles[0].shape).radius, 2.0);
  EXPECT_EQ(std::get<SphereShape>(scene.obstacles[1].shape).radius, 1.0);
}

TEST(Overrides, ErrorsTellOfClampsAndObstaclesThatOverridesHaveAdded) {
  const char* const yaml =
      "cloth: {}\n"
      "obstacles: {table: {type: plane}, ball: {type: sphere, radius: 1}}";
  EXPECT_THAT(complaint(yaml, {"obstacles.tabel.position=[0, 0, 1]"}),
              testing::EndsWith("; an override has added obstacles.tabel beside table, ball"));
  EXPECT_THAT(complaint(yaml, {"obstacles.ball.radius=-1"}),
              testing::Not(testing::HasSubstr("has added")));
  EXPECT_EQ(
      parse(yaml, {"obstacles.other.type=sphere", "obstacles.other.radius=2"}).obstacles.size(), 3U)
      << "which is allowed";
}

TEST(Overrides, AreValidatedLikeTheFile) {
  const std::string yaml = "cloth: {}";
  EXPECT_EQ(complaint(yaml, {"drag=-1"}),
            "s.yaml: drag: expected a number >= 0 (got -1, by an override)");
  EXPECT_EQ(
      complaint(yaml, {"cloth.shaer=true"}),
      "s.yaml: cloth.shaer: unknown key, did you mean 'shear'? expected one of name, obj, scale, "
      "uv_scale, size, particles, diagonals, pose, random_offset, velocity and 8 more");
  EXPECT_EQ(complaint(yaml, {"drag"}), "s.yaml: override 'drag': expected dotted.key=value");
  EXPECT_EQ(complaint(yaml, {"drag="}), "s.yaml: override 'drag=': expected dotted.key=value");
  EXPECT_EQ(complaint(yaml, {"=1"}), "s.yaml: override '=1': expected dotted.key=value");
  EXPECT_EQ(complaint(kFull, {"phases.stay.timeout=1"}),
            "s.yaml: override 'phases.stay.timeout=1': there is no 'stay', as what it is in is a "
            "list without one");
  EXPECT_EQ(complaint(kFull, {"tearing.ratio.shear=2"}),
            "s.yaml: override 'tearing.ratio.shear=2': there is no 'shear', as what it is in is a "
            "single value");
  EXPECT_THAT(complaint(yaml, {"drag=[1"}), testing::HasSubstr("not valid YAML"));
}

// ---- bad input --------------------------------------------------------------------------------

struct BadScene {
  const char* yaml;
  const char* message;
};

class BadInput : public testing::TestWithParam<BadScene> {};

TEST_P(BadInput, IsRefusedInOneLine) {
  const std::string message = complaint(GetParam().yaml);
  EXPECT_EQ(message, GetParam().message) << GetParam().yaml;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

#define CLOTH "cloth: {}\n"
#define GRID "cloth: {particles: [5, 5]}\n"
#define CLAMP GRID "clamps: {c: {patch: {particle: [1, 1]}}}\n"

INSTANTIATE_TEST_SUITE_P(
    Form, BadInput,
    testing::Values(
        BadScene{"",
                 "s.yaml: expected a map with keys from cloth, solver, gravity, wind, drag, "
                 "quasi_static, self_contact, contact, layer_friction, "
                 "obstacles and 4 more (got nothing)"},
        BadScene{"seed: 1", "s.yaml:1: cloth: missing, expected a map"},
        BadScene{
            CLOTH "clots: 1",
            "s.yaml:2: clots: unknown key, did you mean 'cloth'? expected one of cloth, "
            "solver, gravity, wind, drag, quasi_static, self_contact, contact, layer_friction, "
            "obstacles and 4 more"},
        BadScene{CLOTH "seed: 1\nseed: 2", "s.yaml:3: key 'seed' stands twice in the same map"},
        BadScene{CLOTH "---\n" CLOTH,
                 "s.yaml: expected one YAML document (got more after its end)"},
        BadScene{"? [1]\n: 2", "s.yaml:1: expected a word as key"}));

INSTANTIATE_TEST_SUITE_P(
    Values, BadInput,
    testing::Values(
        BadScene{CLOTH "drag: -1", "s.yaml:2: drag: expected a number >= 0 (got -1)"},
        BadScene{CLOTH "drag: .nan", "s.yaml:2: drag: expected a number >= 0 (got .nan)"},
        BadScene{CLOTH "drag: .inf", "s.yaml:2: drag: expected a number >= 0 (got .inf)"},
        BadScene{CLOTH "drag: 1e999", "s.yaml:2: drag: expected a number >= 0 (got '1e999')"},
        BadScene{CLOTH "drag: '1'", "s.yaml:2: drag: expected a number >= 0 (got '1')"},
        BadScene{CLOTH "drag: 1 m", "s.yaml:2: drag: expected a number >= 0 (got '1 m')"},
        BadScene{CLOTH "drag:", "s.yaml:2: drag: expected a number >= 0 (got nothing)"},
        BadScene{CLOTH "solver: {sleep: 1}",
                 "s.yaml:2: solver.sleep: expected true or false (got 1)"},
        BadScene{
            CLOTH "solver: {sleep: [1]}",
            "s.yaml:2: solver.sleep: expected a map with keys from speed, after (got a list of 1)"},
        BadScene{CLOTH "solver: {sleep: {speed: 0}}",
                 "s.yaml:2: solver.sleep.speed: expected a number > 0 (got 0)"},
        BadScene{CLOTH "solver: {sleep: {after: -1}}",
                 "s.yaml:2: solver.sleep.after: expected a number > 0 (got -1)"},
        BadScene{CLOTH "solver: {sleep: {after: .inf}}",
                 "s.yaml:2: solver.sleep.after: expected a number > 0 (got .inf)"},
        BadScene{CLOTH "solver: {sleep: {below: 1}}",
                 "s.yaml:2: solver.sleep.below: unknown key, it belongs to "
                 "`phases.<name>.until.mean_speed`; expected one of speed, after"},
        BadScene{CLOTH "seed: -1",
                 "s.yaml:2: seed: expected a whole number >= 0 and < 2^64 (got -1)"},
        BadScene{CLOTH "gravity: [0, 0]",
                 "s.yaml:2: gravity: expected a list of 3 numbers (got a list of 2)"},
        BadScene{CLOTH "gravity: [0, 0, x]", "s.yaml:2: gravity.2: expected a number (got 'x')"},
        BadScene{CLOTH "wind: 3",
                 "s.yaml:2: wind: expected a map with keys from velocity, density, "
                 "drag_coefficient (got 3)"},
        BadScene{CLOTH "contact: {start: untangle}",
                 "s.yaml:2: contact: expected self_contact: true beside it"},
        BadScene{CLOTH "self_contact: true\ncontact: {start: open}",
                 "s.yaml:3: contact.start: expected one of refuse, untangle (got 'open')"},
        BadScene{CLOTH "self_contact: true\ncontact: {begin: untangle}",
                 "s.yaml:3: contact.begin: unknown key, expected one of start"},
        BadScene{CLOTH "solver: {dt: 0}",
                 "s.yaml:2: solver.dt: expected a number > 0 and <= 1 (got 0)"}));

INSTANTIATE_TEST_SUITE_P(
    Cloth, BadInput,
    testing::Values(
        BadScene{"cloth:\n  fabric:\n    areal_density: -1",
                 "s.yaml:3: cloth.fabric.areal_density: expected a number > 0 (got -1)"},
        BadScene{"cloth: {fabric: chainmail}",
                 "s.yaml:1: cloth.fabric: expected one of cotton, denim, interlock, jersey, linen, "
                 "polyester, silk, towel, wool (got 'chainmail')"},
        BadScene{"cloth: {diagonals: both}",
                 "s.yaml:1: cloth.diagonals: expected one of one_way, alternating (got 'both')"},
        BadScene{"cloth: {size: [0, 1]}",
                 "s.yaml:1: cloth.size.0: expected a number >= 0.001 and <= 1000 (got 0)"},
        BadScene{"cloth: {particles: [1, 9]}",
                 "s.yaml:1: cloth.particles.0: expected a whole number from 2 to 2048 (got 1)"},
        BadScene{"cloth: {particles: [9, 1000000000000]}",
                 "s.yaml:1: cloth.particles.1: expected a whole number from 2 to 2048 (got "
                 "1000000000000)"},
        BadScene{"cloth: {particles: [9, 3.5]}",
                 "s.yaml:1: cloth.particles.1: expected a whole number from 2 to 2048 (got 3.5)"},
        BadScene{"cloth: {particles: [2000, 2000]}",
                 "s.yaml:1: cloth.particles: expected at most 1100000 particles in all (got "
                 "4000000)"},
        BadScene{"cloth: {particle_mass: 0}",
                 "s.yaml:1: cloth.particle_mass: expected a number > 0 (got 0)"},
        BadScene{"cloth: {shear: 3}", "s.yaml:1: cloth.shear: expected true or false (got 3)"},
        BadScene{"cloth: {bending: plates}",
                 "s.yaml:1: cloth.bending: expected one of none, springs, plate (got 'plates')"},
        BadScene{"cloth: {raw_springs: {shear: 1}}",
                 "s.yaml:1: cloth.raw_springs.structural: missing, expected a number > 0"},
        BadScene{"cloth: {particles: [5, 5], pins: [[5, 0]]}",
                 "s.yaml:1: cloth.pins.0.0: expected a whole number from 0 to 4 (got 5)"},
        BadScene{"cloth: {pose: {orientation: [0, 0, 0, 2]}}",
                 "s.yaml:1: cloth.pose.orientation: expected a unit quaternion [x, y, z, w] (got "
                 "one of norm 2)"},
        BadScene{"cloth: {pose: {orientation: [0, 0, 0, 1], rpy: [0, 0, 0]}}",
                 "s.yaml:1: cloth.pose.orientation: expected either rpy or orientation (got "
                 "both)"}));

INSTANTIATE_TEST_SUITE_P(
    World, BadInput,
    testing::Values(
        BadScene{CLOTH "obstacles: {a: {radius: 1}}",
                 "s.yaml:2: obstacles.a.type: missing, expected one of plane, sphere, capsule, "
                 "board, box, bounds, cylinder, mesh"},
        BadScene{CLOTH "obstacles: {a: {type: cube}}",
                 "s.yaml:2: obstacles.a.type: expected one of plane, sphere, capsule, board, box, "
                 "bounds, cylinder, mesh (got "
                 "'cube')"},
        BadScene{CLOTH "obstacles: {a: {type: sphere, radius: -1}}",
                 "s.yaml:2: obstacles.a.radius: expected a number > 0 (got -1)"},
        BadScene{
            CLOTH "obstacles: {a: {type: sphere, radus: 1}}",
            "s.yaml:2: obstacles.a.radus: unknown key, did you mean 'radius'? expected one "
            "of type, radius, position, rpy, orientation, velocity, angular_velocity, friction, "
            "tangential_decay"},
        BadScene{
            CLOTH "obstacles: {a: {type: plane, drag: 1}}",
            "s.yaml:2: obstacles.a.drag: unknown key, it belongs to the top level; expected one "
            "of type, position, rpy, orientation, velocity, angular_velocity, friction, "
            "tangential_decay"},
        BadScene{CLOTH "obstacles: {a: {type: plane, radius: 1}}",
                 "s.yaml:2: obstacles.a.radius: unknown key, expected one of type, position, rpy, "
                 "orientation, velocity, angular_velocity, friction, tangential_decay"},
        BadScene{CLOTH "obstacles: {a: {type: board, size: [1, 1, 0]}}",
                 "s.yaml:2: obstacles.a.size.2: expected a number > 0 (got 0)"},
        BadScene{CLOTH "clamps: {c: {}}",
                 "s.yaml:2: clamps.c.pose: missing, expected a map, as the clamp has no patch"},
        BadScene{CLOTH "clamps: {1st: {pose: {}}}",
                 "s.yaml:2: clamps.1st: expected a name of letters, digits and _ that begins "
                 "with a letter"},
        BadScene{CLOTH "clamps: {all: {pose: {}}}",
                 "s.yaml:2: clamps.all: expected another name: 'all' stands for all clamps"},
        BadScene{GRID "clamps: {c: {patch: {particle: [1, 5]}}}",
                 "s.yaml:2: clamps.c.patch.particle.1: expected a whole number from 0 to 4 (got "
                 "5)"},
        BadScene{CLOTH "clamps: {c: {pose: {}, gap_open: 0.01}}",
                 "s.yaml:2: clamps.c: expected gap_closed < gap_open (got 0.02 and 0.01)"},
        BadScene{CLOTH "tearing: {ratio: 1}",
                 "s.yaml:2: tearing.ratio: expected a number > 1 or .inf (got 1)"},
        BadScene{CLOTH "tearing: {seam: {path: [[0, 0]]}}",
                 "s.yaml:2: tearing.seam.path: expected a list of at least 2 points [u, v] (got a "
                 "list of 1)"},
        BadScene{CLOTH "tearing: {seam: {path: [[0, 0], [0, 0]]}}",
                 "s.yaml:2: tearing.seam.path.1: expected a point other than the one before it"},
        BadScene{CLOTH "tearing: {seam: {path: [[0, 0], [0, 1.1]]}}",
                 "s.yaml:2: tearing.seam.path.1: expected a point [u, v] of the cloth, u from 0 to "
                 "1 and v from 0 to 1 (got [0, 1.1])"}));

INSTANTIATE_TEST_SUITE_P(
    Phases, BadInput,
    testing::Values(
        BadScene{CLOTH "phases: [{timeout: 1}]",
                 "s.yaml:2: phases.0.name: missing, expected a name"},
        BadScene{CLOTH "phases: [{name: a}, {name: a}]",
                 "s.yaml:2: phases.a: expected a name that no other phase has"},
        BadScene{CLAMP "phases: [{name: a, clamps: {d: {grasp: true}}}]",
                 "s.yaml:3: phases.a.clamps.d: there is no clamp of this name (the scene has c, "
                 "all)"},
        BadScene{CLOTH "obstacles: {ball: {type: plane}}\n"
                       "phases: [{name: a, obstacles: {bal: {velocity: [0, 0, 0]}}}]",
                 "s.yaml:3: phases.a.obstacles.bal: there is no obstacle of this name, did you "
                 "mean 'ball'? (the scene has ball)"},
        BadScene{CLOTH "clamps: {c: {pose: {}}}\n"
                       "phases: [{name: a, clamps: {c: {attach: true}}}]",
                 "s.yaml:3: phases.a.clamps.c: expected no attach, as clamp 'c' has no patch"},
        BadScene{CLAMP "phases: [{name: a, clamps: {c: {move_by: [0, 0, 0], move_to: [0, 0, "
                       "0]}}}]",
                 "s.yaml:3: phases.a.clamps.c: expected either move_by or move_to (got both)"},
        BadScene{CLOTH "phases: [{name: a, until: {clamps: closed}}]",
                 "s.yaml:2: phases.a.until.clamps: there are no clamps in the scene to wait for"},
        BadScene{CLAMP "phases: [{name: a, until: {clamps: shut}}]",
                 "s.yaml:3: phases.a.until.clamps: expected one of at_target, closed (got "
                 "'shut')"},
        BadScene{CLOTH "phases: [{name: a, until: {mean_speed: {for: 1}}}]",
                 "s.yaml:2: phases.a.until.mean_speed.below: missing, expected a number > 0"},
        BadScene{CLOTH "phases: [{name: a, timeout: 1, on_timeout: stop}]",
                 "s.yaml:2: phases.a.on_timeout: expected one of continue, fail (got 'stop')"},
        BadScene{CLOTH "phases: [{name: a, on_timeout: fail}]",
                 "s.yaml:2: phases.a.on_timeout: expected a timeout beside it"},
        BadScene{CLOTH "phases: [{name: a, notch: [[0, 0], [0, 9]]}]",
                 "s.yaml:2: phases.a.notch.1: expected a point [u, v] of the cloth, u from 0 to 1 "
                 "and v from 0 to 1 (got [0, 9])"},
        BadScene{CLOTH "phases: [{name: a, notch: 3}]",
                 "s.yaml:2: phases.a.notch: expected a list of points [u, v], or a list of such "
                 "lists (got 3)"}));

#define CUT CLOTH "phases: [{name: a, cut: "
#define REFINE CLOTH "phases: [{name: a, refine: "

INSTANTIATE_TEST_SUITE_P(
    Surgery, BadInput,
    testing::Values(
        BadScene{"cloth: {surgery: {snap: 0.5}}",
                 "s.yaml:1: cloth.surgery.snap: expected a number >= 0.05 and <= 0.45 (got 0.5)"},
        BadScene{"cloth: {surgery: {min_edge: 0}}",
                 "s.yaml:1: cloth.surgery.min_edge: expected a number > 0 (got 0)"},
        BadScene{"cloth: {particles: [5, 5], surgery: {max_particles: 24}}",
                 "s.yaml:1: cloth.surgery.max_particles: expected a whole number from 25 to "
                 "100000000 (got 24)"},
        BadScene{"cloth: {surgery: {drop_below: -1}}",
                 "s.yaml:1: cloth.surgery.drop_below: expected a number >= 0 (got -1)"},
        BadScene{"cloth: {surgery: {clear_strip: 1}}",
                 "s.yaml:1: cloth.surgery.clear_strip: expected true or false (got 1)"},
        BadScene{"cloth: {surgery: {snpa: 0.2}}",
                 "s.yaml:1: cloth.surgery.snpa: unknown key, did you mean 'snap'? expected one of "
                 "snap, min_edge, max_particles, drop_below, clear_strip, refine_cuts"},
        BadScene{"cloth: {surgery: {refine_cuts: {}}}",
                 "s.yaml:1: cloth.surgery.refine_cuts.radius: missing, expected a number > 0"},
        BadScene{"cloth: {surgery: {refine_cuts: {radius: 1, generations: 13}}}",
                 "s.yaml:1: cloth.surgery.refine_cuts.generations: expected a whole number from 0 "
                 "to 12 (got 13)"},
        BadScene{CLOTH "tearing: {tip_speed: 0}",
                 "s.yaml:2: tearing.tip_speed: expected a number > 0 (got 0)"},
        BadScene{CLOTH "tearing: {refine_tip: {radius: 1, min_edge: -1}}",
                 "s.yaml:2: tearing.refine_tip.min_edge: expected a number >= 0 (got -1)"}));

INSTANTIATE_TEST_SUITE_P(
    Strokes, BadInput,
    testing::Values(
        BadScene{CUT "3}]", "s.yaml:2: phases.a.cut: expected a map, or a list of maps (got 3)"},
        BadScene{CUT "[]}]",
                 "s.yaml:2: phases.a.cut: expected a map, or a list of maps (got a list of 0)"},
        BadScene{CUT "[{reach: 1}]}]",
                 "s.yaml:2: phases.a.cut.0: expected either path or blades (got none)"},
        BadScene{CUT "{path: [], blades: []}}]",
                 "s.yaml:2: phases.a.cut: expected either path or blades (got both)"},
        BadScene{CUT "{path: [[0, 0, 1]], direction: [0, 1, 0]}}]",
                 "s.yaml:2: phases.a.cut.path: expected a list of at least 2 points [x, y, z] (got "
                 "a list of 1)"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0]], direction: [0, 1, 0]}}]",
                 "s.yaml:2: phases.a.cut.path.1: expected a list of 3 numbers (got a list of 2)"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0, .nan]], direction: [0, 1, 0]}}]",
                 "s.yaml:2: phases.a.cut.path.1.2: expected a number (got .nan)"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0, 1]]}}]",
                 "s.yaml:2: phases.a.cut.direction: missing, expected [x, y, z]"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0, 1]], direction: [0, 0, 0]}}]",
                 "s.yaml:2: phases.a.cut.direction: expected a direction other than zero"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0, 1]], direction: [0, 1, 0], reach: 0}}]",
                 "s.yaml:2: phases.a.cut.reach: expected a number > 0 (got 0)"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0, 1]], direction: [0, 1, 0], half_width: -1}}]",
                 "s.yaml:2: phases.a.cut.half_width: expected a number >= 0 (got -1)"},
        BadScene{CUT "{path: [[0, 0, 1], [1, 0, 1]], direction: [0, 1, 0], depth: 1}}]",
                 "s.yaml:2: phases.a.cut.depth: unknown key, expected one of path, direction, "
                 "reach, blades, first_layer, half_width"},
        BadScene{CUT "{blades: [[[0, 0, 0], [0, 0, 1]]]}}]",
                 "s.yaml:2: phases.a.cut.blades: expected a list of at least 2 blades, [heel, tip] "
                 "each (got a list of 1)"},
        BadScene{CUT "{blades: [[[0, 0, 0]], [[1, 0, 0]]]}}]",
                 "s.yaml:2: phases.a.cut.blades.0: expected the ends of a blade, [[x, y, z], [x, "
                 "y, z]] (got a list of 1)"},
        BadScene{CUT "{blades: [[[0, 0, 0], [0, 0, 1]], [[1, 0, 0], [1, 0, 1]]], reach: 1}}]",
                 "s.yaml:2: phases.a.cut.reach: expected no reach beside blades"},
        BadScene{REFINE "{radius: 1}}]",
                 "s.yaml:2: phases.a.refine: expected either path or point (got none)"},
        BadScene{REFINE "{path: [], radius: 1}}]",
                 "s.yaml:2: phases.a.refine.path: expected a list of at least 1 point [x, y, z] "
                 "(got a list of 0)"},
        BadScene{REFINE "{point: [0, 0, 1]}}]",
                 "s.yaml:2: phases.a.refine.radius: missing, expected a number > 0"},
        BadScene{REFINE "{point: [0, 0, 1], radius: 1, generations: 2.5}}]",
                 "s.yaml:2: phases.a.refine.generations: expected a whole number from 0 to 12 (got "
                 "2.5)"}));

#undef CUT
#undef REFINE
#undef CLOTH
#undef GRID
#undef CLAMP

TEST(Scene, BadSyntaxSaysWhere) {
  EXPECT_THAT(complaint("drag: 1\ncloth: ["), testing::StartsWith("s.yaml:2: not valid YAML: "));
  // yaml-cpp never comes to an end with these if asked for all documents.
  EXPECT_NE(complaint(", a"), "");
  EXPECT_NE(complaint("cloth: {}\n]\ndrag: 1"), "");
}

TEST(Scene, ErrorIsTheDefaultUnlessAMethodOrSubstepsAreNamed) {
  for (const char* solver : {"{dt: 0.01}", "{error: 0.01}", "{budget: 60}", "{sleep: false}"}) {
    const SolverSpec read = parse(std::string("cloth: {}\nsolver: ") + solver).solver;
    EXPECT_EQ(read.method, "line_xpbd") << solver;
    EXPECT_EQ(read.parameters.at("error"), 0.01) << solver;
  }
  const SolverSpec fixed = parse("cloth: {}\nsolver: {substeps: 7}").solver;
  EXPECT_EQ(fixed.method, "line_xpbd");
  EXPECT_EQ(fixed.parameters.at("error"), 0.0);
  EXPECT_EQ(fixed.parameters.at("substeps"), 7.0);
  const SolverSpec named = parse("cloth: {}\nsolver: {method: line_xpbd}").solver;
  EXPECT_EQ(named.parameters.at("error"), 0.0);
  EXPECT_EQ(parse("cloth: {}\nsolver: {method: xpbd}").solver.method, "xpbd");
}

TEST(Scene, AnOverrideOfTheMethodDropsTheParametersOfOthers) {
  const std::string pbd = "cloth: {}\nsolver: {method: pbd, iterations: 9, substeps: 3, dt: 0.01}";
  const Scene scene = parse(pbd, {"solver.method=verlet"});
  EXPECT_EQ(scene.solver.parameters, (SolverParameters{{"substeps", 3.0}}));
  EXPECT_EQ(scene.solver.dt, 0.01);
  EXPECT_EQ(parse(scene.text).solver.parameters, scene.solver.parameters) << "as it is recorded";
  EXPECT_EQ(parse(pbd, {"solver.method=pbd"}).solver.parameters.at("iterations"), 9.0);
  EXPECT_THAT(complaint(pbd, {"solver.method=verlet", "solver.iterations=2"}),
              testing::HasSubstr("solver.iterations: unknown key"));
  EXPECT_THAT(complaint(pbd + "\n", {"solver.method=leapfrog"}),
              testing::HasSubstr("solver.method: expected one of"));
}

TEST(Scene, UnknownMethodNamesTheKnown) {
  std::string known;
  for (const SolverInfo& info : solverRegistry()) known += info.name + ", ";
  known += "auto";
  EXPECT_EQ(complaint("cloth: {}\nsolver: {method: leapfrog, dt: 0.1}"),
            "s.yaml:2: solver.method: expected one of " + known + " (got 'leapfrog')");
}

TEST(Scene, UnknownSolverParameterNamesTheKnown) {
  EXPECT_THAT(complaint("cloth: {}\nsolver: {method: xpbd, substps: 3}"),
              testing::StartsWith("s.yaml:2: solver.substps: unknown key, did you mean 'substeps'? "
                                  "expected one of method, dt, "));
  EXPECT_THAT(complaint("cloth: {}\nsolver: {method: xpbd, substeps: 0}"),
              testing::StartsWith("s.yaml:2: solver.substeps: expected a whole number from 1 to "));
}

TEST(Scene, NestingThatNeverEndsIsRefused) {
  std::string deep = "cloth: ";
  for (int k = 0; k < 100; ++k) deep += "[";
  for (int k = 0; k < 100; ++k) deep += "]";
  EXPECT_THAT(complaint(deep), testing::HasSubstr("nested too deeply"));
  EXPECT_THAT(complaint("cloth: &a [*a]"), testing::StartsWith("s.yaml:1: "));
}

TEST(Scene, FilesThatCannotBeRead) {
  const auto message = [](const std::string& path) -> std::string {
    try {
      loadScene(path);
      return "";
    } catch (const SceneError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(message("/nowhere/x.yaml"),
            "/nowhere/x.yaml: cannot be read (No such file or directory)");
  EXPECT_THAT(message("/"), testing::StartsWith("/: "));
}

TEST(Scene, NamesOfFilesWithLineBreaksAreToldOnOneLine) {
  const auto message = [](const std::string& yaml) -> std::string {
    try {
      parseScene(yaml, "/nowhere/x.yaml");
      return "";
    } catch (const SceneError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(message("cloth: {obj: \"k\\not.obj\"}"),
            "/nowhere/k ot.obj: cannot be read (No such file or directory)");
  EXPECT_EQ(message("cloth: {particles: [3, 3]}\n"
                    "obstacles: {m: {type: mesh, file: \"k\\not.stl\"}}"),
            "/nowhere/k ot.stl: cannot be read (No such file or directory)");
}

// ---- documentation ----------------------------------------------------------------------------

/// Keys of the tables of docs/scene.md, by the heading that they stand under.
std::map<std::string, std::set<std::string>> documentedKeys() {
  std::ifstream file(std::string(CLOTH_SIM_SOURCE_DIR) + "/docs/scene.md");
  std::map<std::string, std::set<std::string>> result;
  std::string heading;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("## ", 0) == 0) heading = line.substr(3);
    if (line.rfind("| `", 0) == 0) result[heading].insert(line.substr(3, line.find('`', 3) - 3));
  }
  return result;
}

TEST(SceneDocumentation, ListsEveryKeyAndNoOther) {
  const auto documented = documentedKeys();
  const std::vector<KeyTable> known = sceneKeys();
  EXPECT_EQ(documented.size(), known.size());
  for (const KeyTable& table : known) {
    SCOPED_TRACE(table.heading);
    ASSERT_EQ(documented.count(table.heading), 1u);
    EXPECT_EQ(documented.at(table.heading),
              std::set<std::string>(table.names.begin(), table.names.end()));
  }
}

TEST(SceneDocumentation, NamesEveryTypeOfObstacle) {
  std::ifstream file(std::string(CLOTH_SIM_SOURCE_DIR) + "/docs/scene.md");
  std::string row;
  while (std::getline(file, row) && row.rfind("| `type` |", 0) != 0) {
  }
  for (const Shape& shape : allShapes()) {
    for (const std::string& name : typeNames(shape)) {
      EXPECT_THAT(row, testing::HasSubstr("`" + name + "`"));
    }
  }
}

}  // namespace
}  // namespace cloth_sim
