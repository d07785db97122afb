#pragma once
/// \file Sequences of commands to cloths whose layers touch, as small values of whole numbers that
/// RapidCheck can draw and shrink, and regressions can be written down.

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "verify/intersections.h"

namespace cloth_sim::surgery_support {

/// One or two square cloths above a table, thrown at the start.
struct LayerCase {
  int particles = 13;               ///< along each side; cells of 2 cm
  int cloths = 1;                   ///< 1 or 2
  int fabric = 0;                   ///< see sceneOf
  std::array<int, 3> throwAt{};     ///< velocity of the first cloth [m/s]
  std::array<int, 3> throwOther{};  ///< velocity of the second [m/s]
  std::array<int, 4> turn{};        ///< quaternion of the first cloth's pose before normalisation
  bool tears = false;               ///< from the start
  bool drops = false;               ///< small scraps
};

/// A command to the clamp of a cloth, to the blade, to the mesh or to a pointer.
enum class Act { kWait, kGrasp, kMove, kRelease, kCut, kRefine, kPull, kTear };

struct LayerCommand {
  Act act = Act::kWait;
  int cloth = 0;              ///< of the clamp
  std::array<int, 3> to{};    ///< displacement or direction [cm]
  std::array<int, 2> from{};  ///< numbers of particles, modulo their count
  int steps = 1;              ///< after the command
};

template <std::size_t kCount>
std::ostream& operator<<(std::ostream& out, const std::array<int, kCount>& list) {
  for (std::size_t k = 0; k < kCount; ++k) out << (k == 0 ? "{" : ", ") << list[k];
  return out << "}";
}

inline std::ostream& operator<<(std::ostream& out, const LayerCase& c) {
  return out << "{" << c.particles << ", " << c.cloths << ", " << c.fabric << ", " << c.throwAt
             << ", " << c.throwOther << ", " << c.turn << ", " << (c.tears ? "true" : "false")
             << "}";
}

inline std::ostream& operator<<(std::ostream& out, const LayerCommand& c) {
  constexpr std::array<const char*, 8> kNames{"Wait", "Grasp",  "Move", "Release",
                                              "Cut",  "Refine", "Pull", "Tear"};
  return out << "{Act::k" << kNames[static_cast<std::size_t>(c.act)] << ", " << c.cloth << ", "
             << c.to << ", " << c.from << ", " << c.steps << "}";
}

/// Cloths whose layers touch, and what is commanded of them.
class LayerFixture {
 public:
  explicit LayerFixture(const LayerCase& with) : simulation_(sceneOf(with)) {}

  /// Carries out a command and takes its steps. \return what is wrong then; "" at best.
  std::string command(const LayerCommand& command) {
    carryOut(command);
    if (const std::string error = check("after the command"); !error.empty()) return error;
    for (int step = 0; step < command.steps; ++step) {
      simulation_.step();
      if (const std::string error = check("after a step"); !error.empty()) return error;
    }
    return "";
  }

  bool hasDiverged() const { return simulation_.failure().find("diverged") != std::string::npos; }

 private:
  static Scene sceneOf(const LayerCase& with) {
    const std::string side = std::to_string(0.02 * (with.particles - 1));
    const std::string count = std::to_string(with.particles);
    const std::array<const char*, 3> fabrics{"cotton", "silk", "denim"};
    const std::string fabric = fabrics[static_cast<std::size_t>(with.fabric) % fabrics.size()];
    const auto list = [](const std::array<int, 3>& v) {
      return "[" + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " +
             std::to_string(v[2]) + "]";
    };
    const Eigen::Vector4d given(with.turn[0], with.turn[1], with.turn[2], with.turn[3]);
    const Eigen::Vector4d turn = given.norm() > 0.5 ? Eigen::Vector4d(given.normalized())
                                                    : Eigen::Vector4d(0.0, 0.0, 0.0, 1.0);
    // Once for all cloths.
    std::string surgery = with.drops ? ", surgery: {drop_below: 0.002}" : "";
    const auto cloth = [&](const std::string& name, double z, const std::array<int, 3>& velocity,
                           const std::string& orientation) {
      return "  - {name: " + name + ", size: [" + side + ", " + side + "], particles: [" + count +
             ", " + count + "], fabric: " + fabric + surgery +
             ", thickness: 0.001, velocity: " + list(velocity) + ", pose: {position: [0, 0, " +
             std::to_string(z) + "]" + orientation + "}}\n";
    };
    std::string yaml = "cloth:\n";
    std::string clamps = "clamps:\n";
    const std::string orientation = ", orientation: [" + std::to_string(turn[0]) + ", " +
                                    std::to_string(turn[1]) + ", " + std::to_string(turn[2]) +
                                    ", " + std::to_string(turn[3]) + "]";
    const std::array<std::string, 2> names{"one", "other"};
    for (int k = 0; k < with.cloths; ++k) {
      const std::string& name = names[static_cast<std::size_t>(k)];
      if (k > 0) surgery.clear();
      yaml += k == 0 ? cloth(name, 0.26, with.throwAt, orientation)
                     : cloth(name, 0.5, with.throwOther, "");
      clamps += "  hand_" + name + ": {patch: {cloth: " + name +
                ", particle: [3, 3], radius: 1}, " +
                "closing_speed: 2, max_speed: 20, max_acceleration: 2000}\n";
    }
    yaml += clamps;
    yaml += R"(
self_contact: true
drag: 0.5
solver: {method: line_xpbd, error: 0.01, sleep: false}
obstacles: {table: {type: board, size: [4, 4, 0.1], position: [0, 0, -0.05]}}
tearing: {ratio: {structural: 1.2}, enabled: )";
    yaml += with.tears ? "true}\n" : "false}\n";
    return parseScene(yaml, "sequence");
  }

  const Vec3& particle(int number) const {
    const auto& x = simulation_.state().x.values();
    return x[static_cast<std::size_t>(std::abs(number)) % x.size()];
  }

  void carryOut(const LayerCommand& command) {
    const auto& clamps = simulation_.clamps();
    const Clamp& clamp = clamps[static_cast<std::size_t>(command.cloth) % clamps.size()];
    const std::string hand = clamp.spec().name;
    const Vec3 by = 0.01 * Vec3(command.to[0], command.to[1], command.to[2]);
    switch (command.act) {
      case Act::kWait:
        return;
      case Act::kGrasp:
        simulation_.apply(SetClampTarget{hand, Pose{patchOf(clamp), clamp.pose().orientation}});
        simulation_.apply(SetGrasp{hand, true});
        return;
      case Act::kMove:
        simulation_.apply(
            SetClampTarget{hand, Pose{clamp.pose().position + by, clamp.pose().orientation}});
        return;
      case Act::kRelease:
        simulation_.apply(SetGrasp{hand, false});
        return;
      case Act::kCut: {
        const Vec3 direction = by.norm() > 0.0 ? by : Vec3(0.0, 0.0, 1.0);
        const Vec3 first = particle(command.from[0]);
        const Vec3 last = 2.0 * particle(command.from[1]) - first;
        simulation_.apply(CutAlong{strokeAlong({first, last}, direction, 0.3)});
        return;
      }
      case Act::kRefine:
        simulation_.apply(
            RefineMesh{{{particle(command.from[0])}, {0.03, 1 + command.from[1] % 2, 0.004}}});
        return;
      case Act::kPull: {
        const Vec3 direction = by.norm() > 0.0 ? by : Vec3(0.0, 0.0, -1.0);
        const Ray ray{particle(command.from[0]) - 10.0 * direction, direction};
        simulation_.apply(PullParticle{command.from[1] % 4 != 0, ray});
        return;
      }
      case Act::kTear: {
        TearRatios ratio = infiniteRatios();
        ratio[0] = 1.0 + 0.01 * (1 + command.from[0] % 30);
        simulation_.apply(SetTearing{command.from[1] % 4 != 0, ratio});
        return;
      }
    }
  }

  /// The middle of what a clamp would hold.
  Vec3 patchOf(const Clamp& clamp) const {
    const ClampPatch& patch = *clamp.spec().patch;
    const ClothPart& part = simulation_.model().cloths[patch.cloth];
    return simulation_.state().x[part.firstVertex + part.grid->vertex(patch.column, patch.row)];
  }

  std::string check(const std::string& when) const {
    const std::string where = " " + when + ", at step " + std::to_string(simulation_.stepCount());
    // Motion at 20 m/s may make the method diverge (docs/layers.md, Limits); it has to say so.
    if (simulation_.failed() && !hasDiverged()) return simulation_.failure() + where;
    for (const VertexData<Vec3>* values : {&simulation_.state().x, &simulation_.state().v}) {
      for (const Vec3& value : *values) {
        if (!value.allFinite()) return "a number that is not finite" + where;
      }
    }
    const int intersections = countIntersections(simulation_.model(), simulation_.state());
    if (intersections > 0) return std::to_string(intersections) + " intersections" + where;
    return "";
  }

  Simulation simulation_;
};

/// Runs a sequence, until the method diverges if it does. \return what is wrong; "" at best.
inline std::string commandAll(const LayerCase& with, const std::vector<LayerCommand>& commands) {
  LayerFixture fixture(with);
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const std::string error = fixture.command(commands[k]);
    if (!error.empty()) return "command " + std::to_string(k) + ": " + error;
    if (fixture.hasDiverged()) break;
  }
  return "";
}

}  // namespace cloth_sim::surgery_support
