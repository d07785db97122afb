#include "reality_tear.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

constexpr double kSquareSide = 0.24;  // of the square cloth of a trouser tear [m]
constexpr double kLength = 0.2;       // of the strip [m]
constexpr double kWidth = 0.05;       // of the strip [m]
constexpr double kCutEnd = -0.02;  // of the cut between the legs, from the middle of the strip [m]
constexpr double kOvershoot = 0.004;  // of cuts beyond the corners of the strip [m]
constexpr double kHeld = 0.0075;      // middle of the clamps from the end of the legs [m]
constexpr double kStripWidth = 0.8;   // of a notched strip [m]
constexpr double kStripLength = 1.6;  // [m]

std::string text(const char* format, double a, double b) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

std::string number(double value) { return text("%.9g", value, 0.0); }

std::string fabricOf(double energy) {
  return "fabric: {preset: cotton, tensile_warp: 4500, tensile_weft: 4500, shear: 1500, "
         "tear_energy: " +
         number(energy) + "}\n  bending: plate\n";
}

/// Points of a strip that lies at an angle in the cloth.
class Strip {
 public:
  explicit Strip(double degrees)
      : angle_(degrees * M_PI / 180.0), cos_(std::cos(angle_)), sin_(std::sin(angle_)) {}

  double angle() const { return angle_; }
  Vec2 world(double along, double across) const {
    return {cos_ * along - sin_ * across, sin_ * along + cos_ * across};
  }
  /// Returns a cut from one point of the strip to another.
  std::string cut(const Vec2& from, const Vec2& to) const {
    return "{path: [" + material(from) + ", " + material(to) + "]}";
  }

 private:
  std::string material(const Vec2& p) const {
    const Vec2 at = world(p.x(), p.y()) + Vec2::Constant(0.5 * kSquareSide);
    return text("[%.9f, %.9f]", at.x(), at.y());
  }

  double angle_, cos_, sin_;
};

std::string clampOf(const std::string& name, const Strip& strip, double across) {
  const Vec2 at = strip.world(-0.5 * kLength + kHeld, across);
  return "  " + name + ":\n    pose: {position: " + text("[%.9f, %.9f, 0]", at.x(), at.y()) +
         ", rpy: [0, 0, " + number(strip.angle()) + "]}\n    plate_size: [0.012, " +
         number(0.5 * kWidth - 0.002) + "]\n    gap_open: 0.02\n    gap_closed: 0.002\n";
}

std::string outlineOf(const Strip& strip) {
  const double x = 0.5 * kLength;
  const double y = 0.5 * kWidth;
  const double o = kOvershoot;
  return "[" + strip.cut({-x - o, -y}, {x + o, -y}) + ", " + strip.cut({-x - o, y}, {x + o, y}) +
         ", " + strip.cut({-x, -y - o}, {-x, y + o}) + ", " + strip.cut({x, -y - o}, {x, y + o}) +
         "]";
}

}  // namespace

std::string sceneOf(const TrouserTear& tear) {
  const Strip strip(tear.angle);
  const std::string size = std::to_string(tear.particles);
  const Vec2 bend = strip.world(0.5 * kLength - 0.026, 0.0);
  const std::string across = text("%.9f, %.9f", bend.x(), bend.y());
  return "cloth:\n  size: [0.24, 0.24]\n  particles: [" + size + ", " + size + "]\n  " +
         fabricOf(tear.energy) + "solver: {" + tear.solver +
         "}\ngravity: [0, 0, 0]\ndrag: 20\nclamps:\n" + clampOf("up", strip, -0.25 * kWidth) +
         clampOf("down", strip, 0.25 * kWidth) +
         "tearing: {enabled: false}\nphases:\n  - name: outline\n    notch: " + outlineOf(strip) +
         "\n    timeout: 0.02\n    on_timeout: continue\n  - name: grasp\n    notch: " +
         strip.cut({-0.5 * kLength - 0.002, 0.0}, {kCutEnd, 0.0}) +
         "\n    clamps: {all: {grasp: true}}\n    until: {clamps: closed}\n    timeout: 1\n"
         "  - name: bend\n    clamps:\n      up: {move_by: [" +
         across + ", 0.068], speed: 0.5}\n      down: {move_by: [" + across +
         ", -0.068], speed: 0.5}\n    until: {clamps: at_target}\n    timeout: 2\n"
         "  - name: pull\n    tearing: {enabled: true}\n    clamps:\n"
         "      up: {move_by: [0, 0, 0.07], speed: 0.03}\n"
         "      down: {move_by: [0, 0, -0.07], speed: 0.03}\n    until: {clamps: at_target}\n"
         "    timeout: 4\n";
}

std::string sceneOf(const NotchedStrip& strip) {
  const int along = 2 * (strip.particles - 1) + 1;
  const auto clamp = [](const std::string& name, double x) {
    return "  " + name + ": {pose: {position: [" + number(x) +
           ", 0, 0]}, plate_size: [0.021, 0.9], gap_open: 0.02, gap_closed: 0.002}\n";
  };
  return "cloth:\n  size: [1.6, 0.8]\n  particles: [" + std::to_string(along) + ", " +
         std::to_string(strip.particles) + "]\n  " + fabricOf(strip.energy) + "solver: {" +
         strip.solver + "}\ngravity: [0, 0, 0]\ndrag: 20\nclamps:\n" +
         clamp("left", -0.5 * kStripLength) + clamp("right", 0.5 * kStripLength) +
         "tearing: {enabled: false}\nphases:\n  - name: grasp\n    notch: [[0.8001, 0], [0.8001, " +
         number(strip.notch) +
         "]]\n    clamps: {all: {grasp: true}}\n    until: {clamps: closed}\n    timeout: 1\n"
         "  - name: pull\n    tearing: {enabled: true}\n    clamps:\n"
         "      left: {move_by: [-0.1, 0, 0], speed: 0.02}\n"
         "      right: {move_by: [0.1, 0, 0], speed: 0.02}\n    until: {pieces: 2}\n"
         "    timeout: 8\n";
}

ForceTrace traceTear(const std::string& scene, int pieces) {
  Simulation simulation(parseScene(scene, "tear.yaml"));
  ForceTrace trace;
  int vertices = 0;
  double highest = 0.0;
  while (simulation.script().status() != ScriptStatus::kDone && !simulation.failed()) {
    simulation.step();
    const PhaseSpec* phase = simulation.script().current();
    if (phase == nullptr || phase->name != "pull") continue;
    if (trace.time.empty()) vertices = simulation.model().particleCount();
    double force = 0.0;
    for (const Clamp& clamp : simulation.clamps()) force += 0.5 * clamp.wrench().force.norm();
    trace.time.push_back(simulation.time());
    trace.force.push_back(force);
    highest = std::max(highest, force);
    if (simulation.model().particleCount() == vertices) continue;
    vertices = simulation.model().particleCount();
    trace.peaks.push_back(highest);
    highest = 0.0;
    if (simulation.pieces() >= pieces) return trace;
  }
  if (simulation.failed()) throw std::runtime_error(simulation.failure());
  return trace;
}

TearForce trouserForce(const TrouserTear& tear) {
  const std::vector<double> all = traceTear(sceneOf(tear), 3).peaks;
  if (all.size() < 2) throw std::runtime_error("the tear advanced less than twice");
  const std::vector<double> peaks(all.begin() + 1, all.end());
  const auto count = static_cast<double>(peaks.size());
  TearForce force;
  force.advances = static_cast<int>(peaks.size());
  for (double peak : peaks) force.mean += peak / count;
  double squares = 0.0;
  for (double peak : peaks) squares += (peak - force.mean) * (peak - force.mean);
  force.scatter = std::sqrt(squares / count);
  return force;
}

double strengthOf(const NotchedStrip& strip) {
  const std::vector<double> force = traceTear(sceneOf(strip), 2).force;
  return *std::max_element(force.begin(), force.end());
}

}  // namespace cloth_sim
