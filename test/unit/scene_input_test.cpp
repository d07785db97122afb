/// \file Scenes that are refused, each in one line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

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
  const auto message = [](const std::string& path) {
    return sceneErrorOf([&] { loadScene(path); });
  };
  EXPECT_EQ(message("/nowhere/x.yaml"),
            "/nowhere/x.yaml: cannot be read (No such file or directory)");
  EXPECT_THAT(message("/"), testing::StartsWith("/: "));
}

TEST(Scene, NamesOfFilesWithLineBreaksAreToldOnOneLine) {
  const auto message = [](const std::string& yaml) {
    return sceneErrorOf([&] { parseScene(yaml, "/nowhere/x.yaml"); });
  };
  EXPECT_EQ(message("cloth: {obj: \"k\\not.obj\"}"),
            "/nowhere/k ot.obj: cannot be read (No such file or directory)");
  EXPECT_EQ(message("cloth: {particles: [3, 3]}\n"
                    "obstacles: {m: {type: mesh, file: \"k\\not.stl\"}}"),
            "/nowhere/k ot.stl: cannot be read (No such file or directory)");
}

}  // namespace
}  // namespace cloth_sim
