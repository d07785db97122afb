#include "cloth_sim/cloth/stable_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "bending_row_sums.h"

namespace cloth_sim {
namespace {

/// Power iterations. More gain little beyond the margin.
constexpr int kIterations = 60;
/// Factor on omega^2 for the part that the iterations have not found yet.
constexpr double kMargin = 1.1;

/// A vector per particle, (particleCount,).
using Field = std::vector<Vec3>;

double largestRetardation(const Model& model) {
  double largest = model.bending.empty() ? 0.0 : model.bendRetardation();
  for (const Spring& spring : model.springs.slots()) {
    if (spring.exists() && spring.stiffness > 0.0) {
      largest = std::max(largest, spring.damping / spring.stiffness);
    }
  }
  return largest;
}

/// Adds K v of the springs, linearised at x. The geometric stiffness of compressed springs is
/// negative and would reduce omega, so it is left out.
void multiplySprings(const Model& model, const VertexData<Vec3>& x, const Field& v, Field& out) {
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    const Vec3 d = x[spring.b] - x[spring.a];
    const double length = d.norm();
    if (length == 0.0) continue;
    const Vec3 n = d / length;
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    const Vec3 difference = v[a] - v[b];
    const double along = n.dot(difference);
    const double tension = std::max(0.0, 1.0 - spring.restLength / length);
    const Vec3 f = spring.stiffness * (along * n + tension * (difference - along * n));
    out[a] += f;
    out[b] -= f;
  }
}

/// Adds K v of the bending elements, whose stiffness is constant.
void multiplyBending(const Model& model, const Field& v, Field& out) {
  for (const PlateElement& element : model.bending.elements()) {
    Vec3 curvature = Vec3::Zero();
    for (int k = 0; k < element.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      curvature += element.weight[i] * v[static_cast<std::size_t>(element.vertex[i])];
    }
    for (int k = 0; k < element.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      out[static_cast<std::size_t>(element.vertex[i])] +=
          element.stiffness * element.weight[i] * curvature;
    }
  }
}

/// Computes out = K v.
void multiply(const Model& model, const VertexData<Vec3>& x, const Field& v, Field& out) {
  std::fill(out.begin(), out.end(), Vec3::Zero());
  multiplySprings(model, x, v, out);
  multiplyBending(model, v, out);
}

/// Returns the mass norm of a field: the square root of sum m |v|^2.
double massNorm(const Model& model, const Field& v) {
  double sum = 0.0;
  for (VertexId k = 0; k < model.particleCount(); ++k) {
    sum += model.mass[k] * v[static_cast<std::size_t>(k)].squaredNorm();
  }
  return std::sqrt(sum);
}

/// Returns the start of the power iteration: random, and the same bits on every platform.
Field startField(std::size_t size) {
  std::mt19937_64 generator(1);
  Field field(size);
  for (Vec3& v : field) {
    for (int axis = 0; axis < 3; ++axis) {
      v[axis] = static_cast<double>(generator() >> 11) * 0x1.0p-53 - 0.5;
    }
  }
  return field;
}

}  // namespace

FastestMode boundFastestMode(const Model& model) {
  std::vector<double> stiffness(static_cast<std::size_t>(model.particleCount()), 0.0);
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists() || spring.stiffness <= 0.0) continue;
    stiffness[static_cast<std::size_t>(spring.a)] += spring.stiffness;
    stiffness[static_cast<std::size_t>(spring.b)] += spring.stiffness;
  }
  const std::vector<double> bending =
      bendingRowSums(model, std::vector<double>(stiffness.size(), 1.0));
  double squared = 0.0;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const auto k = static_cast<std::size_t>(v);
    squared = std::max(squared, (2.0 * stiffness[k] + bending[k]) / model.mass[v]);
  }
  return {squared, largestRetardation(model)};
}

FastestMode estimateFastestMode(const Model& model, const State& state) {
  const FastestMode bound = boundFastestMode(model);
  Field v = startField(static_cast<std::size_t>(model.particleCount()));
  Field image(v.size());
  double squared = 0.0;
  for (int k = 0; k < kIterations; ++k) {
    const double scale = massNorm(model, v);
    if (scale == 0.0) break;
    for (Vec3& p : v) p /= scale;
    multiply(model, state.x, v, image);
    for (VertexId i = 0; i < model.particleCount(); ++i) {
      image[static_cast<std::size_t>(i)] /= model.mass[i];
    }
    v.swap(image);
    squared = massNorm(model, v);
  }
  return {std::min(bound.squared, kMargin * squared), bound.retardation};
}

double stableStep(const FastestMode& mode) {
  if (mode.squared == 0.0) return std::numeric_limits<double>::infinity();
  const double tau = mode.retardation;
  return std::sqrt(tau * tau + 4.0 / mode.squared) - tau;
}

double stableStep(const Model& model) { return stableStep(boundFastestMode(model)); }

double stableForwardStep(const FastestMode& mode) {
  if (mode.squared == 0.0) return std::numeric_limits<double>::infinity();
  const double omega = std::sqrt(mode.squared);
  const double zeta = 0.5 * mode.retardation * omega;
  if (zeta <= 1.0) return mode.retardation;
  return 2.0 / (omega * (zeta + std::sqrt(zeta * zeta - 1.0)));
}

}  // namespace cloth_sim
