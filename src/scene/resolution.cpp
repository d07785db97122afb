#include "cloth_sim/scene/resolution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cloth_sim {
namespace {

/// Returns the number of particles along a side whose cells are `factor` times as many.
int scaledCount(int count, double factor) {
  return std::max(kFewestOnSide, static_cast<int>(std::lround((count - 1) * factor)) + 1);
}

/// Returns the particle of a side of `to` particles that is nearest to a particle of `from`.
int nearestIndex(int index, int from, int to) {
  return static_cast<int>(std::lround(index * (to - 1.0) / (from - 1.0)));
}

/// Particles of a grid, marked or not.
class GridMarks {
 public:
  explicit GridMarks(const ClothSpec& cloth)
      : columns_(cloth.columns),
        isMarked_(static_cast<std::size_t>(cloth.columns) * static_cast<std::size_t>(cloth.rows)) {}

  std::vector<bool>::reference at(int column, int row) {
    return isMarked_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                     static_cast<std::size_t>(column)];
  }

 private:
  int columns_;
  std::vector<bool> isMarked_;
};

/// The particles of a side, one or two, between which a particle of another side is.
struct Between {
  int first = 0;
  int last = 0;

  Between(int index, int from, int to) {
    const std::int64_t cells = static_cast<std::int64_t>(index) * (to - 1);
    first = static_cast<int>(cells / (from - 1));
    last = first + (cells % (from - 1) != 0 ? 1 : 0);
  }
};

/// Returns the pins of a cloth on a grid of other counts: the particles nearest to them, and those
/// that lie between pinned ones only.
std::vector<PinSpec> movedPins(const ClothSpec& from, const ClothSpec& to) {
  GridMarks before(from);
  GridMarks after(to);
  for (const PinSpec& pin : from.pins) {
    before.at(pin.column, pin.row) = true;
    after.at(nearestIndex(pin.column, from.columns, to.columns),
             nearestIndex(pin.row, from.rows, to.rows)) = true;
  }
  std::vector<PinSpec> pins;
  for (int row = 0; row < to.rows; ++row) {
    const Between v(row, to.rows, from.rows);
    for (int column = 0; column < to.columns; ++column) {
      const Between u(column, to.columns, from.columns);
      const bool isBetween = before.at(u.first, v.first) && before.at(u.last, v.first) &&
                             before.at(u.first, v.last) && before.at(u.last, v.last);
      if (isBetween || after.at(column, row)) pins.push_back({column, row, kNone});
    }
  }
  return pins;
}

/// Moves the patch of a clamp to the same place of a grid of other counts, as wide as it was.
void movePatch(const ClothSpec& from, const ClothSpec& to, ClampPatch& patch) {
  const double factor = (to.columns - 1.0) / (from.columns - 1.0);
  patch.column = nearestIndex(patch.column, from.columns, to.columns);
  patch.row = nearestIndex(patch.row, from.rows, to.rows);
  patch.radius = static_cast<int>(std::lround(patch.radius * factor));
}

/// Gives all cloths their new counts.
void scaleGrids(double factor, Scene& scene) {
  std::int64_t particles = 0;
  for (ClothSpec& cloth : scene.cloths) {
    if (cloth.mesh) {
      throw std::invalid_argument("cloth '" + cloth.name +
                                  "' is from a file, which gives its particles");
    }
    const ClothSpec before = cloth;
    cloth.columns = scaledCount(cloth.columns, factor);
    cloth.rows = scaledCount(cloth.rows, factor);
    particles += static_cast<std::int64_t>(cloth.columns) * cloth.rows;
    if (std::max(cloth.columns, cloth.rows) > kMostOnSide || particles > kMostInGrids) {
      throw std::invalid_argument("cloth '" + cloth.name + "' would have " +
                                  std::to_string(cloth.columns) + " x " +
                                  std::to_string(cloth.rows) + " particles (expected at most " +
                                  std::to_string(kMostOnSide) + " on a side, and " +
                                  std::to_string(kMostInGrids) + " in all)");
    }
    if (!cloth.pins.empty()) cloth.pins = movedPins(before, cloth);
  }
  scene.surgery.maxParticles =
      std::max(scene.surgery.maxParticles, static_cast<std::int32_t>(particles));
}

}  // namespace

Scene withColumns(const Scene& scene, int columns) {
  const std::shared_ptr<const Scene> original =
      scene.original ? scene.original : std::make_shared<const Scene>(scene);
  if (columns == 0) return *original;
  if (columns < kFewestOnSide || columns > kMostOnSide) {
    throw std::invalid_argument("columns: expected " + std::to_string(kFewestOnSide) + " to " +
                                std::to_string(kMostOnSide) +
                                ", or 0 for those of the scene (got " + std::to_string(columns) +
                                ")");
  }
  Scene scaled = *original;
  scaled.original = original;
  scaleGrids((columns - 1.0) / (original->cloths.front().columns - 1.0), scaled);
  for (ClampSpec& clamp : scaled.clamps) {
    if (!clamp.patch) continue;
    const std::size_t cloth = clamp.patch->cloth;
    movePatch(original->cloths[cloth], scaled.cloths[cloth], *clamp.patch);
  }
  return scaled;
}

std::string gridsText(const Scene& scene) {
  std::string all;
  for (const ClothSpec& cloth : scene.cloths) {
    all += (all.empty() ? "" : ", ") + std::to_string(cloth.columns) + " x " +
           std::to_string(cloth.rows);
  }
  return all;
}

}  // namespace cloth_sim
