#pragma once
/// \file Where several cloths lie in the material plane.

#include <utility>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// The material plane, cut into strips along u: each cloth of a model has one for itself, so a
/// point of the plane says which cloth it is of, also where edits made it.
class MaterialStrips {
 public:
  /// One strip.
  MaterialStrips() = default;
  /// \param bounds  u between the strips [m], ascending.
  explicit MaterialStrips(std::vector<double> bounds) : bounds_(std::move(bounds)) {}

  std::size_t count() const { return bounds_.size() + 1; }
  /// The number of the strip that a point lies in.
  std::size_t at(const Vec2& material) const {
    std::size_t strip = 0;
    while (strip < bounds_.size() && material.x() >= bounds_[strip]) ++strip;
    return strip;
  }

 private:
  std::vector<double> bounds_;
};

}  // namespace cloth_sim
