#pragma once
/// \file The arrangement of several cloths in the material plane.

#include <utility>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Strips of the material plane, divided along u, one for each cloth of a model. So the material
/// coordinates of a vertex tell its cloth, also for vertices that edits created.
class MaterialStrips {
 public:
  /// Makes a single strip, the whole plane.
  MaterialStrips() = default;
  /// \param bounds  values of u between the strips [m], ascending.
  explicit MaterialStrips(std::vector<double> bounds) : bounds_(std::move(bounds)) {}

  std::size_t count() const { return bounds_.size() + 1; }
  /// Returns the index of the strip in which a point lies.
  std::size_t at(const Vec2& material) const {
    std::size_t strip = 0;
    while (strip < bounds_.size() && material.x() >= bounds_[strip]) ++strip;
    return strip;
  }

 private:
  std::vector<double> bounds_;
};

}  // namespace cloth_sim
