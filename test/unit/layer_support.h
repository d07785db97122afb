#pragma once
/// \file Points, sheets and intersections that the tests of layer contact share.

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
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

/// A square cloth of cotton.
inline ClothSpec cottonSheet(int particles) {
  ClothSpec cloth;
  cloth.columns = cloth.rows = particles;
  cloth.fabric = fabricPreset("cotton");
  return cloth;
}

/// Places of two cloths laid flat, the second one `height` above the first [m].
inline std::vector<Vec3> laidFlat(const Model& model, double height) {
  std::array<std::optional<Vec2>, 2> corner;
  std::vector<Vec3> x;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const std::size_t cloth = model.clothOf(v);
    if (!corner[cloth]) corner[cloth] = model.mesh.material(v);
    const Vec2 at = model.mesh.material(v) - *corner[cloth];
    x.emplace_back(at.x(), at.y(), static_cast<double>(cloth) * height);
  }
  return x;
}

/// Particles of a cloth in slots that run backwards, so that a slot is not its vertex.
struct Backwards {
  std::vector<double> x, y, z, startX, startY, startZ, mass;
  std::vector<std::int32_t> slotOf;

  /// Particles at rest. \param empty  number of slots in front that have no vertex.
  explicit Backwards(const std::vector<Vec3>& at, std::size_t empty = 0)
      : Backwards(at, at, empty) {}
  /// Particles that have moved in a substep.
  Backwards(const std::vector<Vec3>& from, const std::vector<Vec3>& to, std::size_t empty = 0)
      : x(empty + to.size()), y(x), z(x), startX(x), startY(x), startZ(x), mass(x.size(), 1.0) {
    for (std::size_t v = 0; v < to.size(); ++v) {
      const std::size_t k = x.size() - 1 - v;
      slotOf.push_back(static_cast<std::int32_t>(k));
      x[k] = to[v].x();
      y[k] = to[v].y();
      z[k] = to[v].z();
      startX[k] = from[v].x();
      startY[k] = from[v].y();
      startZ[k] = from[v].z();
    }
  }
  ParticleView view() {
    return {x.data(),      y.data(),      z.data(),    startX.data(),
            startY.data(), startZ.data(), mass.data(), slotOf.data()};
  }
};

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
