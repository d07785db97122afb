#pragma once
/// \file Points, sheets and intersections that the tests of layer contact share.

#include <cmath>
#include <random>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/scene/build.h"
#include "verify/intersections.h"

namespace cloth_sim {

/// Reproducible points in a cube of two units around the origin.
class RandomPoints {
 public:
  explicit RandomPoints(unsigned seed) : generator_(seed) {}
  double number() { return uniform_(generator_); }
  Vec3 point() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }

 private:
  std::mt19937 generator_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

/// \return whether two triangles intersect, by exact predicates.
inline bool meet(const Face& a, const Face& b, const std::vector<Vec3>& x) {
  return pierces(a, b, x) || pierces(b, a, x);
}

/// A square sheet whose rows are bent along a circle of `radius` [m], by more than one turn if the
/// radius is small.
inline State rolled(const Model& model, double radius, double drift) {
  State state;
  state.x = VertexData<Vec3>(static_cast<std::size_t>(model.particleCount()), Vec3::Zero());
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const Vec2 at = model.mesh.material(v);
    const double angle = at.x() / radius;
    const double r = radius + drift * angle;
    state.x[v] = Vec3(r * std::sin(angle), at.y() + 0.1 * at.x() * at.y(), r * std::cos(angle));
  }
  return state;
}

}  // namespace cloth_sim
