#include "simplify.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace cloth_sim {
namespace {

/// Largest move of a pin or patch, over the wider spacing.
constexpr double kMostShift = 0.25;
/// Least number of particles per side.
constexpr int kFewest = 4;

using Pins = std::set<std::pair<int, int>>;  ///< column, row

/// Maps particles of a grid to a coarser one.
class Coarsening {
 public:
  Coarsening(const ClothSpec& cloth, double factor)
      : cloth_(cloth),
        columns_(intervals(cloth.columns, factor) + 1),
        rows_(intervals(cloth.rows, factor) + 1) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }

  /// Moves a place to the nearest particle. \return false if it is not near.
  bool carry(int& column, int& row) const {
    const double u = place(cloth_.columns, columns_, column);
    const double v = place(cloth_.rows, rows_, row);
    column = static_cast<int>(std::lround(u));
    row = static_cast<int>(std::lround(v));
    return std::max(std::abs(u - column), std::abs(v - row)) <= kMostShift;
  }

  /// Tells whether all particles around a place are pinned, so that the place is at rest, too.
  bool isBetween(const PinSpec& at, const Pins& pins) const {
    const double u = place(cloth_.columns, columns_, at.column);
    const double v = place(cloth_.rows, rows_, at.row);
    for (const double column : {std::floor(u), std::ceil(u)}) {
      for (const double row : {std::floor(v), std::ceil(v)}) {
        if (pins.count({static_cast<int>(column), static_cast<int>(row)}) == 0) return false;
      }
    }
    return true;
  }

 private:
  static int intervals(int particles, double factor) {
    return std::max(1, static_cast<int>(std::lround((particles - 1) / factor)));
  }

  static double place(int from, int to, int index) {
    return static_cast<double>(index) * (to - 1) / (from - 1);
  }

  const ClothSpec& cloth_;
  int columns_;
  int rows_;
};

std::string pair(int a, int b) { return "[" + std::to_string(a) + ", " + std::to_string(b) + "]"; }

/// A border of the cloth, as scenes name it.
struct Border {
  const char* name;
  bool (*has)(const PinSpec& pin, int columns, int rows);
};
const Border kBorders[] = {
    {"first_row", [](const PinSpec& pin, int, int) { return pin.row == 0; }},
    {"last_row", [](const PinSpec& pin, int, int rows) { return pin.row == rows - 1; }},
    {"first_column", [](const PinSpec& pin, int, int) { return pin.column == 0; }},
    {"last_column", [](const PinSpec& pin, int columns, int) { return pin.column == columns - 1; }},
};

/// Removes a border from the pins `rest`, if all of it is pinned.
bool takeBorder(const Border& border, int columns, int rows, const Pins& all, Pins& rest) {
  std::vector<std::pair<int, int>> of;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (border.has({column, row}, columns, rows)) of.emplace_back(column, row);
    }
  }
  const auto pinned = [&](const auto& pin) { return all.count(pin) != 0; };
  if (!std::all_of(of.begin(), of.end(), pinned)) return false;
  for (const auto& pin : of) rest.erase(pin);
  return true;
}

/// Returns the pins as text of a scene, with whole borders by name.
std::string pinsText(const Pins& pins, int columns, int rows) {
  std::vector<std::string> items;
  Pins rest = pins;
  for (const Border& border : kBorders) {
    if (takeBorder(border, columns, rows, pins, rest)) items.emplace_back(border.name);
  }
  for (const auto& [column, row] : rest) items.push_back(pair(column, row));
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return "[" + text + "]";
}

/// Tells why a scene cannot be made coarser; "" if it can.
std::string obstacleTo(const Scene& scene) {
  if (scene.cloths.size() > 1) return "the scene has several cloths";
  if (scene.cloths[0].raw) return "cloth.raw_springs are constants of springs, not of a fabric";
  if (scene.cloths[0].particleMass) return "cloth.particle_mass is of each particle";
  for (const PhaseSpec& phase : scene.phases) {
    if (phase.until.brokenAtLeast) return "phases." + phase.name + ".until.broken counts springs";
  }
  return "";
}

/// Moves pins to a coarser grid. \throws std::invalid_argument naming a pin without a place.
Pins coarserPins(const std::vector<PinSpec>& from, const Coarsening& to) {
  Pins pins;
  std::vector<PinSpec> others;
  for (const PinSpec& pin : from) {
    PinSpec moved = pin;
    if (to.carry(moved.column, moved.row)) {
      pins.emplace(moved.column, moved.row);
    } else {
      others.push_back(pin);
    }
  }
  for (const PinSpec& pin : others) {
    if (!to.isBetween(pin, pins)) {
      throw std::invalid_argument("no particle is near the pin " + pair(pin.column, pin.row));
    }
  }
  return pins;
}

/// Returns the overrides of a coarser scene. \throws std::invalid_argument with the obstacle.
std::vector<std::string> coarserOverrides(const Scene& scene, const Coarsening& to) {
  std::vector<std::string> overrides{"cloth.particles=" + pair(to.columns(), to.rows())};
  const Pins pins = coarserPins(scene.cloths[0].pins, to);
  if (!pins.empty()) {
    overrides.push_back("cloth.pins=" + pinsText(pins, to.columns(), to.rows()));
  }
  const double factor = (scene.cloths[0].columns - 1.0) / (to.columns() - 1.0);
  for (const ClampSpec& clamp : scene.clamps) {
    if (!clamp.patch) continue;
    ClampPatch patch = *clamp.patch;
    if (!to.carry(patch.column, patch.row)) {
      throw std::invalid_argument("no particle is near the middle of the patch of clamp " +
                                  clamp.name);
    }
    overrides.push_back("clamps." + clamp.name +
                        ".patch={particle: " + pair(patch.column, patch.row) +
                        ", radius: " + std::to_string(std::lround(patch.radius / factor)) + "}");
  }
  return overrides;
}

/// A part of a scene that can be left out. A new kind is one row.
struct Omission {
  const char* what;
  bool (*isPresent)(const Scene& scene);
  const char* override;
};
const Omission kOmissions[] = {
    {"without the bending energy", [](const Scene& s) { return s.cloths[0].plate; },
     "cloth.bending=none"},
    {"bend springs instead of the bending energy", [](const Scene& s) { return s.cloths[0].plate; },
     "cloth.bending=springs"},
    {"without bend springs", [](const Scene& s) { return s.cloths[0].springs.bend; },
     "cloth.bending=none"},
    {"without shear springs", [](const Scene& s) { return s.cloths[0].springs.shear; },
     "cloth.shear=false"},
    {"without refinement along cuts",
     [](const Scene& s) { return s.surgery.refineCuts.has_value(); },
     "cloth.surgery.refine_cuts=null"},
    {"without refinement of the tip",
     [](const Scene& s) { return s.tearing.refineTip.has_value(); }, "tearing.refine_tip=null"},
    {"without wind", [](const Scene& s) { return s.wind.has_value(); }, "wind=null"},
    {"without damping of the fabric",
     [](const Scene& s) { return !s.cloths[0].raw && s.cloths[0].fabric.damping > 0.0; },
     "cloth.fabric.damping=0"},
    {"without dashpots",
     [](const Scene& s) { return s.cloths[0].raw && s.cloths[0].raw->dashpot > 0.0; },
     "cloth.raw_springs.dashpot=0"},
    {"without drag", [](const Scene& s) { return s.drag > 0.0; }, "drag=null"},
};

}  // namespace

Grid gridOf(const Scene& scene) {
  const ClothSpec& cloth = scene.cloths[0];
  return {cloth.columns, cloth.rows, cloth.width, cloth.height};
}

Simplification coarser(const Scene& scene, double factor) {
  const Coarsening to(scene.cloths[0], factor);
  Simplification result;
  result.what = std::to_string(to.columns()) + " x " + std::to_string(to.rows()) + " particles";
  result.obstacle = obstacleTo(scene);
  if (std::min(to.columns(), to.rows()) < kFewest) result.obstacle = "that is no cloth";
  if (!result.obstacle.empty()) return result;
  try {
    result.overrides = coarserOverrides(scene, to);
  } catch (const std::invalid_argument& why) {
    result.obstacle = why.what();
  }
  return result;
}

std::vector<Simplification> simplificationsOf(const Scene& scene) {
  std::vector<Simplification> result{coarser(scene, 4.0), coarser(scene, 2.0),
                                     coarser(scene, 4.0 / 3.0)};
  for (const Omission& omission : kOmissions) {
    const bool ofOneCloth = std::string(omission.override).rfind("cloth.", 0) == 0;
    if (ofOneCloth && scene.cloths.size() > 1) continue;
    if (omission.isPresent(scene)) result.push_back({omission.what, {omission.override}, ""});
  }
  return result;
}

Trajectory onGrid(const Trajectory& trajectory, const Grid& from, const Grid& to) {
  Trajectory result;
  for (const std::vector<Vec3>& x : trajectory.positions) {
    if (x.size() != static_cast<std::size_t>(from.columns) * from.rows) return {};
    std::vector<Vec3> fine;
    for (int row = 0; row < to.rows; ++row) {
      const double v = static_cast<double>(row) * (from.rows - 1) / (to.rows - 1);
      const int j = std::min(static_cast<int>(v), from.rows - 2);
      for (int column = 0; column < to.columns; ++column) {
        const double u = static_cast<double>(column) * (from.columns - 1) / (to.columns - 1);
        const int i = std::min(static_cast<int>(u), from.columns - 2);
        const auto at = [&](int p, int q) { return x[from.vertex(i + p, j + q)]; };
        const double a = u - i, b = v - j;
        fine.push_back((1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) +
                       b * ((1 - a) * at(0, 1) + a * at(1, 1)));
      }
    }
    result.positions.push_back(std::move(fine));
  }
  result.times = trajectory.times;
  return result;
}

}  // namespace cloth_sim
