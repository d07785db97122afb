#pragma once
/// \file The projection of one spring, as the textbook has it: documentation of the vectorised
/// kernel (spring_projection.cpp), which does the same operations in the same order, and its
/// oracle.

#include <cmath>
#include <limits>

#include "particles.h"
#include "spring_parameters.h"

namespace cloth_sim {

/// Extended position-based dynamics (Macklin, Mueller & Chentanez 2016), one iteration a substep.
///
/// A spring of rest length l0, stiffness k and dashpot c between particles a and b is a constraint
///     C(x) = |x_b - x_a| - l0 = 0   with the compliance  alpha = 1 / (k h^2)  [1/kg]
///                                   and the damping ratio gamma = c / (k h)    [-]
/// in a substep of length h. With the unit direction n from a to b, the inverse masses w and the
/// displacement d - d_start of b against a since the start of the substep,
///     lambda = (C + gamma n . (d - d_start)) / ((1 + gamma) (w_a + w_b) + alpha),
///     x_a += w_a lambda n,   x_b -= w_b lambda n
/// (equations 18 and 26), which conserves momentum. The denominator depends on masses, spring and h
/// only, so the weights
///     W_a = w_a / ((1 + gamma) (w_a + w_b) + alpha),   W_b likewise,
/// are found once, and the projection is x_a += W_a (C + ...) n, x_b -= W_b (C + ...) n.
struct ProjectionWeights {
  double a = 0.0;      ///< W_a [-]
  double b = 0.0;      ///< W_b [-]
  double gamma = 0.0;  ///< [-]
};

/// \param wa, wb  inverse masses [1/kg].
/// \param h       length of the substep [s].
/// A spring without stiffness, one that is gone, has weights of zero.
inline ProjectionWeights projectionWeights(const SpringParameters& spring, double wa, double wb,
                                           double h) {
  if (spring.stiffness <= 0.0) return {};
  const double alpha = 1.0 / (spring.stiffness * h * h);
  const double gamma = spring.damping / (spring.stiffness * h);
  const double denominator = (1.0 + gamma) * (wa + wb) + alpha;
  return {wa / denominator, wb / denominator, gamma};
}

/// Projects one spring: moves its ends.
/// \tparam kDamped  whether dashpots act; without them `p.start` is not read.
/// \return (C + gamma n . (d - d_start)) n [m]: times W_a, what end a moves by.
template <bool kDamped>
Vec3 projectSpring(std::size_t a, std::size_t b, double restLength,
                   const ProjectionWeights& weights, Particles& p) {
  const Vec3 d = p.x.at(b) - p.x.at(a);
  const double squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z() + kTinySquare;
  const double length = std::sqrt(squared);
  double error = length - restLength;  // C + gamma n . (d - d_start)
  if constexpr (kDamped) {
    const Vec3 start = p.start.at(b) - p.start.at(a);
    const double along = d.x() * start.x() + d.y() * start.y() + d.z() * start.z();
    error += weights.gamma * ((squared - along) / length);
  }
  const double lambda = error / length;  // over the length: d is not a unit vector
  p.x.set(a, p.x.at(a) + weights.a * lambda * d);
  p.x.set(b, p.x.at(b) - weights.b * lambda * d);
  return lambda * d;
}

}  // namespace cloth_sim
