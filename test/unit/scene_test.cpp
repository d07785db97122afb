/// \file Scenes: what they read, overrides, and the keys that docs/scene.md lists.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <set>

#include "cloth_sim/scene/load.h"
#include "scene/section.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kNever = std::numeric_limits<double>::infinity();

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
