/// \file Several cloths in one scene: how they are read, where they lie, and that each keeps what
/// is its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/sim/summary.h"
#include "constraints/particles.h"
#include "constraints/spring_schedule.h"
#include "unit/core_support.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* const kSheet = R"(
  - name: sheet
    size: [0.4, 0.3]
    particles: [9, 7]
    pose: {position: [0, 0, 0.5]}
    fabric: silk
)";
const char* const kStrip = R"(
  - name: strip
    size: [0.25, 0.5]
    particles: [6, 11]
    pose: {position: [2, 0, 0.5]}
    velocity: [0, 0, 0.1]
    fabric: denim
    pins: [last_row, [0, 2]]
)";

Scene parse(const std::string& rest, const std::vector<std::string>& overrides = {}) {
  return parseScene(rest, "test.yaml", overrides);
}

Scene pair(const std::string& rest = "", const std::vector<std::string>& overrides = {}) {
  return parse(std::string("cloth:") + kSheet + kStrip + rest, overrides);
}

/// One of them by itself, as the only item of the list.
Scene alone(const char* cloth) { return parse(std::string("cloth:") + cloth); }

std::string errorOf(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return testing_support::sceneErrorOf([&] { parse(yaml, overrides); });
}

double massOf(const Model& model, std::size_t cloth) {
  double mass = 0.0;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    if (model.clothOf(v) == cloth) mass += model.mass[v];
  }
  return mass;
}

double areaOf(const Model& model, std::size_t cloth) {
  double area = 0.0;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    if (model.clothOf(model.mesh.face(f)[0]) == cloth) area += model.mesh.restArea(f);
  }
  return area;
}

// ---- the file

TEST(Cloths, AreReadFromAList) {
  const Scene scene = pair();
  ASSERT_EQ(scene.cloths.size(), 2U);
  EXPECT_EQ(scene.cloths[0].name, "sheet");
  EXPECT_EQ(scene.cloths[0].fabric.name, "silk");
  EXPECT_EQ(scene.cloths[1].name, "strip");
  EXPECT_EQ(scene.cloths[1].rows, 11);
  EXPECT_EQ(scene.cloths[1].pins.size(), 7U);
  EXPECT_EQ(scene.cloths[1].velocity, Vec3(0.0, 0.0, 0.1));
}

TEST(Cloths, OneNeedsNoListAndNoName) {
  EXPECT_EQ(parse("cloth: {particles: [3, 4]}").cloths[0].name, "cloth");
  EXPECT_EQ(parse("cloth: {name: towel}").cloths[0].name, "towel");
  EXPECT_EQ(parse("cloth: [{particles: [3, 4]}]").cloths.size(), 1U);
}

TEST(Cloths, HaveOneSurgery) {
  EXPECT_EQ(pair("    surgery: {snap: 0.1}").surgery.snap, 0.1);
  EXPECT_EQ(parse("cloth: [{name: a, particles: [1024, 512]}, {name: b, particles: [1024, 513]}]")
                .surgery.maxParticles,
            1024 * 1025)
      << "there is room for all of them";
}

TEST(Cloths, TouchEachOtherUnlessTheSceneSaysOtherwise) {
  EXPECT_TRUE(pair().selfContact);
  EXPECT_TRUE(pair("contact: {start: untangle}").selfContact);
  EXPECT_FALSE(pair("self_contact: false").selfContact);
  EXPECT_FALSE(alone(kSheet).selfContact) << "a single cloth has to be asked for";
  EXPECT_EQ(Simulation(pair()).warnings().size(), 0U);
  EXPECT_EQ(Simulation(pair("self_contact: false")).warnings().size(), 0U);
}

/// The warnings of a scene in which cloths do not touch each other though nobody said so.
std::vector<std::string> warningsOf(const Scene& scene) {
  EXPECT_FALSE(scene.selfContact);
  std::vector<std::string> texts;
  for (const ResultWarning& warning : Simulation(scene).warnings()) texts.push_back(warning.text);
  return texts;
}

TEST(Cloths, ThatCannotTouchEachOtherAreWarnedOf) {
  const std::string through = "cloths pass through each other: ";
  EXPECT_THAT(warningsOf(pair("solver: {method: projective}")),
              testing::Contains(through +
                                "projective cannot hold layers of cloth apart: its global solve "
                                "does not know of them; take another method, such as line_xpbd, or "
                                "self_contact: false"));
  EXPECT_THAT(
      warningsOf(pair("", {"cloth.strip.fabric={preset: denim, thickness: 0}"})),
      testing::Contains(through + "the fabric of cloth 'strip' has no thickness; layers need one"));
}

TEST(Cloths, ThatDoNotGoTogetherAreRefused) {
  const std::string a = "cloth: [{name: a, size: [1, 2]";
  EXPECT_THAT(errorOf(a + "}, {size: [1, 1]}]"),
              HasSubstr("test.yaml:1: cloth.1.name: missing, expected one"));
  EXPECT_THAT(errorOf(a + "}, {name: a}]"),
              HasSubstr("cloth.a.name: expected a name that no other cloth has"));
  EXPECT_THAT(errorOf("cloth: {name: 2nd}"), HasSubstr("cloth.name: expected a name of letters"));
  EXPECT_THAT(errorOf("cloth: []"), HasSubstr("cloth: expected a map, or a list of maps"));
  EXPECT_THAT(errorOf(a + "}, 3]"), HasSubstr("cloth.1: expected a map"));
  EXPECT_THAT(
      errorOf(a + ", surgery: {snap: 0.1}}, {name: b, surgery: {snap: 0.1}}]"),
      HasSubstr("cloth.b.surgery: expected it once for all cloths (cloth.a.surgery has it)"));
  EXPECT_THAT(errorOf(a + ", bending: plate}, {name: b, fabric: {damping: 0.01}}]"),
              HasSubstr("cloth.b: expected fabric.damping and fabric.bending_damping of 0 in sum, "
                        "as cloth 'a' has"));
  EXPECT_EQ(errorOf(a + ", bending: plate, fabric: {damping: 0.01}}, "
                        "{name: b, fabric: {damping: 0.002, bending_damping: 0.008}}]"),
            "");
  EXPECT_THAT(errorOf(a + "}, {name: b, bending: plate}]\nsolver: {method: pbd}"),
              HasSubstr("cloth.b.bending: "));
  EXPECT_THAT(errorOf(a + ", particles: [1024, 1024]}, {name: b, particles: [1024, 1024]}]"),
              HasSubstr("cloth.b: expected at most 1100000 particles in all cloths (got 2097152"));
}

TEST(Cloths, AreMeantByName) {
  const std::string patch = "clamps: {hand: {patch: {cloth: skirt, particle: [0, 0]}}}";
  EXPECT_THAT(errorOf(std::string("cloth:") + kSheet + kStrip + patch),
              HasSubstr("clamps.hand.patch.cloth: expected one of sheet, strip (got 'skirt')"));
  const auto notch = [](const std::string& what) {
    return "phases: [{name: cut, notch: " + what + "}]";
  };
  const std::string two = std::string("cloth:") + kSheet + kStrip;
  EXPECT_THAT(errorOf(two + notch("[[0, 0.45], [0.2, 0.45]]")), HasSubstr("v from 0 to 0.3"));
  EXPECT_EQ(errorOf(two + notch("{cloth: strip, path: [[0, 0.45], [0.2, 0.45]]}")), "");
  EXPECT_THAT(errorOf(two + "tearing: {seam: {cloth: strip, path: [[0, 0], [0, 0.5]], "
                            "half_width: 0.6}}"),
              HasSubstr("tearing.seam.half_width: expected a number >= 0 and <= 0.5"));
  const Scene scene =
      pair(notch("[{cloth: strip, path: [[0, 0.25], [0.1, 0.25]]}, [[0.1, 0.0], [0.1, 0.2]]]"));
  ASSERT_EQ(scene.phases[0].notches.size(), 2U);
  EXPECT_EQ(scene.phases[0].notches[0][1], Vec2(materialOffsets(scene.cloths)[1] + 0.1, 0.25));
  EXPECT_EQ(scene.phases[0].notches[1][1], Vec2(0.1, 0.2));
}

TEST(Cloths, AreOverriddenByNameOrNumber) {
  const Scene scene = pair("", {"cloth.strip.particles=[4, 5]", "cloth.strip.pins=null",
                                "cloth.0.fabric=interlock", "cloth.sheet.size=[1, 1]"});
  EXPECT_EQ(scene.cloths[1].columns, 4);
  EXPECT_TRUE(scene.cloths[1].pins.empty());
  EXPECT_EQ(scene.cloths[0].width, 1.0);
  EXPECT_EQ(scene.cloths[0].fabric.name, "interlock");
  EXPECT_EQ(pair("", {"cloth.sheet=null"}).cloths.size(), 1U);
  EXPECT_THAT(errorOf(std::string("cloth:") + kSheet + kStrip, {"cloth.size=[1, 1]"}),
              HasSubstr("there is no 'size', as what it is in is a list without one"));
}

// ---- the model

TEST(Cloths, LieBesideEachOtherInTheMaterialPlane) {
  std::vector<ClothSpec> cloths(3);
  cloths[0].width = 0.4;
  cloths[1].height = 2.5;  // the longest side: gaps of 5 m at least
  cloths[2].width = 0.1;
  EXPECT_THAT(materialOffsets(cloths), ElementsAre(0.0, 6.0, 12.0));
  cloths.resize(2);
  cloths[0].width = cloths[1].height = cloths[0].height = cloths[1].width = 0.2;
  EXPECT_THAT(materialOffsets(cloths), ElementsAre(0.0, 2.0));
}

TEST(Cloths, ArePiecesOfOneModel) {
  const Model model = buildModel(pair().cloths);
  ASSERT_EQ(model.cloths.size(), 2U);
  EXPECT_EQ(model.cloths[1].firstVertex, 63);
  EXPECT_EQ(model.cloths[1].vertices, 66);
  EXPECT_EQ(model.particleCount(), 63 + 66);
  EXPECT_EQ(connectedComponents(model.mesh).count, 2);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    EXPECT_EQ(model.clothOf(v), v < 63 ? 0U : 1U) << v;
  }
  for (const Spring& spring : model.springs.slots()) {
    EXPECT_EQ(model.clothOf(spring.a), model.clothOf(spring.b));
  }
}

TEST(Cloths, HaveTheSpringsAndMassesThatTheyHaveAlone) {
  const Model both = buildModel(pair().cloths);
  const Model strip = buildModel(alone(kStrip).cloths);
  const Model sheet = buildModel(alone(kSheet).cloths);
  const std::int32_t before = sheet.springs.count();
  ASSERT_EQ(both.springs.count(), before + strip.springs.count());
  for (std::int32_t k = 0; k < strip.springs.count(); ++k) {
    const Spring& one = strip.springs[k];
    const Spring& same = both.springs[before + k];
    EXPECT_EQ(same.a, one.a + 63);
    EXPECT_EQ(same.b, one.b + 63);
    EXPECT_EQ(same.kind, one.kind);
    // The offset in the plane costs digits: 3 m over edges of 5 cm, some 60 times the rounding.
    EXPECT_NEAR(same.restLength / one.restLength, 1.0, 1e-13);
    EXPECT_NEAR(same.stiffness / one.stiffness, 1.0, 1e-12);
  }
  for (VertexId v = 0; v < strip.particleCount(); ++v) {
    EXPECT_NEAR(both.mass[63 + v] / strip.mass[v], 1.0, 1e-12);
  }
  for (VertexId v = 0; v < sheet.particleCount(); ++v) EXPECT_EQ(both.mass[v], sheet.mass[v]);
}

TEST(Cloths, MayDifferInWhatSpringsTheyHave) {
  const Model model = buildModel(
      pair("", {"cloth.sheet.bending=plate", "cloth.strip.raw_springs={structural: 7, shear: 3}",
                "cloth.strip.particle_mass=0.001"})
          .cloths);
  int elements = 0;
  for (const PlateElement& element : model.bending.elements()) {
    if (element.count == 0) continue;
    ++elements;
    EXPECT_EQ(model.clothOf(element.vertex[0]), 0U);
  }
  EXPECT_GT(elements, 0);
  for (const Spring& spring : model.springs.slots()) {
    EXPECT_NE(spring.kind, SpringKind::kBend);
    if (model.clothOf(spring.a) == 0) continue;
    EXPECT_DOUBLE_EQ(spring.stiffness, spring.kind == SpringKind::kShear ? 3.0 : 7.0);
  }
  EXPECT_NEAR(massOf(model, 1), 66 * 0.001, 1e-12);
  EXPECT_NEAR(massOf(model, 0), 0.083 * 0.4 * 0.3, 1e-12);
}

TEST(Cloths, ArePinnedAndHeldEachByItsOwnParticles) {
  const Scene scene = pair("clamps: {hand: {patch: {cloth: strip, particle: [2, 0], radius: 1}}}");
  const Model model = buildModel(scene.cloths);
  const State state = initialState(scene.cloths, model, 1);
  const std::vector<KinematicTarget> pins = pinTargets(scene.cloths, model, state);
  ASSERT_EQ(pins.size(), 7U);
  EXPECT_EQ(pins[0].vertex, 63 + 2 * 6);
  EXPECT_EQ(pins[1].vertex, 63 + 60);
  EXPECT_LT((pins[1].position - Vec3(2.0 - 0.125, 0.25, 0.5)).norm(), 1e-14);
  EXPECT_THAT(patchParticles(model, *scene.clamps[0].patch), ElementsAre(64, 65, 66, 70, 71, 72));
  EXPECT_NEAR((scene.clamps[0].pose.position - Vec3(2.0 - 0.025, -0.25, 0.62)).norm(), 0.0, 1e-12);
}

TEST(Cloths, DrawTheirRandomOffsetsOneAfterTheOther) {
  const auto offsetOf = [](const std::vector<std::string>& overrides, VertexId v) {
    const Scene moved = pair("seed: 3", overrides);
    const Scene still = pair("seed: 3");
    const Model model = buildModel(moved.cloths);
    return Vec3(initialState(moved.cloths, model, moved.seed).x[v] -
                initialState(still.cloths, model, still.seed).x[v]);
  };
  const Vec3 sheet = offsetOf({"cloth.sheet.random_offset=0.1"}, 0);
  const Vec3 strip = offsetOf({"cloth.strip.random_offset=0.1"}, 63);
  EXPECT_GT(sheet.norm(), 0.01);
  EXPECT_GT(strip.norm(), 0.01);
  EXPECT_GT((sheet - strip).norm(), 0.01);
}

// ---- solvers

int springsInContiguousSpans(const std::vector<ClothSpec>& cloths) {
  const Model model = buildModel(cloths);
  Particles particles;
  particles.layOut(model);
  SpringSchedule schedule;
  schedule.build(model, particles.slotOf);
  int springs = 0;
  for (const SpringSchedule::Span& span : schedule.spans())
    springs += span.isContiguous ? span.count : 0;
  return springs;
}

TEST(Cloths, AreSweptWithoutGathersEachAsAlone) {
  Scene scene = pair("", {"cloth.sheet.particles=[48, 40]", "cloth.strip.particles=[40, 64]"});
  const int first = springsInContiguousSpans({scene.cloths[0]});
  const int second = springsInContiguousSpans({scene.cloths[1]});
  ASSERT_GT(first, 48 * 40);
  ASSERT_GT(second, 40 * 64);
  // The colours of the two cloths together end elsewhere, and with them some contiguous spans.
  EXPECT_GE(springsInContiguousSpans(scene.cloths), 0.98 * (first + second));
}

// ---- contact

TEST(Cloths, MeetObstaclesWithTheirOwnThicknessAndFriction) {
  // On a floor, with gravity that pulls sideways at tan = 0.3 times as hard as down.
  const Scene scene = parse(R"(
cloth:
  - {name: thin, size: [0.2, 0.2], particles: [5, 5], fabric: {thickness: 0.001, friction: 0.1},
     pose: {position: [0, 0, 0.0005]}}
  - {name: thick, size: [0.2, 0.2], particles: [5, 5], fabric: {thickness: 0.01, friction: 0.5},
     pose: {position: [0, 1, 0.005]}}
gravity: [2.943, 0, -9.81]
solver: {dt: 0.01, substeps: 10}
obstacles: {floor: {type: plane}, named: {type: plane, position: [0, 0, -1], friction: 0.7}}
)");
  Simulation simulation(scene);
  for (int k = 0; k < 50; ++k) simulation.step();
  ASSERT_EQ(simulation.contacts().candidates.size(), 2U) << "of one floor, by cloth";
  const State& state = simulation.state();
  const double t = simulation.time();
  for (VertexId v = 0; v < 25; ++v) {
    EXPECT_NEAR(state.x[v].z(), 0.0005, 1e-9);
    EXPECT_NEAR(state.v[v].x(), (0.3 - 0.1) * 9.81 * t, 0.01 * (0.3 - 0.1) * 9.81 * t);
    EXPECT_NEAR(state.x[25 + v].z(), 0.005, 1e-9);
    EXPECT_EQ(state.v[25 + v].x(), 0.0) << "static friction holds it";
  }
  EXPECT_EQ(simulation.colliders().all()[0].margin(), 0.005);
}

TEST(Contacts, AreDividedByCloth) {
  Obstacle ground;
  ground.shape = PlaneShape{};
  const Collider collider(ground, std::vector<ContactProperties>{{0.0, 0.1}, {0.0, 0.2}});
  Contacts contacts;
  contacts.add(&collider).vertices = {0, 2, 5, 7};
  contacts.add(&collider).vertices = {6};
  contacts.splitByCloth(2, [](VertexId v) { return v < 5 ? std::size_t{0} : std::size_t{1}; });
  ASSERT_EQ(contacts.candidates.size(), 3U);
  EXPECT_THAT(contacts.candidates[0].vertices, ElementsAre(0, 2));
  EXPECT_EQ(contacts.candidates[0].cloth, 0U);
  EXPECT_THAT(contacts.candidates[1].vertices, ElementsAre(5, 7));
  EXPECT_EQ(contacts.candidates[1].cloth, 1U);
  EXPECT_THAT(contacts.candidates[2].vertices, ElementsAre(6));
  EXPECT_EQ(contacts.candidates[2].cloth, 1U);
}

// ---- surgery

TEST(Cloths, ANotchCutsTheClothThatItNames) {
  Simulation simulation(pair(R"(
gravity: [0, 0, 0]
phases: [{name: cut, notch: {cloth: strip, path: [[-0.01, 0.23], [0.26, 0.27]]}}]
)"));
  const Model& model = simulation.model();
  const double sheet = massOf(model, 0);
  const double strip = massOf(model, 1);
  const double area = areaOf(model, 1);
  simulation.step();
  EXPECT_EQ(simulation.pieces(), 3);
  EXPECT_GT(model.particleCount(), 63 + 66);
  for (VertexId v = 63 + 66; v < model.particleCount(); ++v) EXPECT_EQ(model.clothOf(v), 1U);
  for (const FailureEvent& event : simulation.failures()) {
    EXPECT_GT(event.material.x(), model.cloths[1].materialOffset - 0.01);
  }
  EXPECT_EQ(massOf(model, 0), sheet);
  EXPECT_NEAR(massOf(model, 1) / strip, 1.0, 1e-12);
  EXPECT_NEAR(areaOf(model, 1) / area, 1.0, 1e-12);
}

TEST(Cloths, AStrokeThroughBothKeepsTheMassOfEach) {
  Simulation simulation(pair("gravity: [0, 0, 0]", {"cloth.sheet.particle_mass=0.01"}));
  const Model& model = simulation.model();
  const std::vector<double> before{massOf(model, 0), massOf(model, 1)};
  const Stroke across = strokeAlong({{-1, 0.013, 0.5}, {3, 0.031, 0.5}}, Vec3::UnitZ(), 0.2);
  ASSERT_TRUE(simulation.apply(CutAlong{across}).success);
  EXPECT_EQ(simulation.pieces(), 4);
  for (const std::size_t cloth : {0, 1}) {
    EXPECT_NEAR(massOf(model, cloth) / before[cloth], 1.0, 1e-12);
  }
}

TEST(Cloths, OnlyTheOneWithTheSeamMayTear) {
  const Scene scene =
      pair("tearing: {ratio: 1.2, seam: {cloth: strip, path: [[0.0, 0.225], [0.25, 0.225]]}}");
  const Model model = buildModel(scene.cloths);
  Tearing tearing(scene.tearing, model);
  State state = initialState(scene.cloths, model, 1);
  for (Vec3& x : state.x) x *= 1.5;  // every spring of both is overloaded
  const CutPlan plan = tearing.plan(model, state, 0.01);
  EXPECT_FALSE(plan.paths.empty());
  EXPECT_FALSE(plan.overloaded.empty());
  for (const std::int32_t slot : plan.overloaded) {
    EXPECT_EQ(model.clothOf(model.springs[slot].a), 1U);
  }
}

TEST(Cloths, LooseScrapsAreDroppedButNoCloth) {
  // The strip as a whole is smaller than what is dropped.
  Simulation simulation(pair(R"(
gravity: [0, 0, 0]
phases: [{name: cut, notch: [[-0.01, 0.03], [0.41, 0.03]]}]
)",
                             {"cloth.strip.size=[0.05, 0.1]", "cloth.strip.pins=null",
                              "cloth.sheet.surgery={drop_below: 0.02}"}));
  simulation.step();
  EXPECT_EQ(simulation.dropped().count, 1);
  EXPECT_NEAR(simulation.dropped().restArea, 0.4 * 0.03, 1e-9);
  EXPECT_EQ(simulation.pieces(), 2);
  EXPECT_NEAR(areaOf(simulation.model(), 1), 0.005, 1e-12);
}

// ---- what is told

TEST(Cloths, AreInSnapshotAndSummary) {
  Simulation simulation(pair());
  const auto shot = simulation.snapshot();
  ASSERT_EQ(shot->topology->cloths.size(), 2U);
  EXPECT_EQ(shot->topology->cloths[1].name, "strip");
  EXPECT_EQ(shot->topology->cloths[1].firstParticle, 63);
  EXPECT_EQ(shot->topology->cloths[1].particles, 66);
  EXPECT_EQ(shot->topology->cloths[1].materialOffset,
            materialOffsets(simulation.scene().cloths)[1]);
  const auto summary = nlohmann::json::parse(summaryJson(simulation, startRecord(simulation), 1.0));
  ASSERT_EQ(summary["cloths"].size(), 2U);
  EXPECT_EQ(summary["cloths"][0]["name"], "sheet");
  EXPECT_EQ(summary["cloths"][1]["first_particle"], 63);
  EXPECT_NEAR(summary["cloths"][1]["mass_kg"].get<double>(), 0.324 * 0.25 * 0.5, 1e-9);
}

}  // namespace
}  // namespace cloth_sim
