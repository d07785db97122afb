#include "plate_projection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth/bending_row_sums.h"
#include "linalg/vector_operations.h"

namespace cloth_sim {
namespace {

/// The part of the limit of stability up to which all impulses are given at once. An impulse
/// a = n h^2 k / m of a mode with the stiffness k and the mass m, in every n-th substep and at the
/// predicted position, changes (x, n h v) by a matrix with the determinant 1 - a and the trace
/// 2 - a (n + 1), whose eigenvalues are below one for a < 4 / (n + 2).
constexpr double kStablePart = 0.8;

/// The shortest of the times 1/1200 s * 2^k, k an integer, that is no shorter than h [s]. What
/// depends on that seldom changes as h does, and follows from h alone, not from those before.
double powerOfTwoFrom(double h) {
  constexpr double kOne = 1.0 / 1200.0;
  constexpr double kRounding = 1e-9;
  int exponent = 0;
  std::frexp((1.0 - kRounding) * h / kOne, &exponent);
  return std::ldexp(kOne, exponent);
}

/// Returns the circles of Gershgorin of M^-1/2 K M^-1/2, which has the eigenvalues of M^-1 K: light
/// particles at corners do not widen these. K is the stiffness matrix of bending, M the masses.
/// \return by vertex [1/s^2].
std::vector<double> circlesOf(const Model& model) {
  std::vector<double> scale;
  for (const double mass : model.mass.values()) scale.push_back(1.0 / std::sqrt(mass));
  return bendingRowSums(model, scale);
}

/// Largest stiffness over inertia of an element, times the square of the time between its impulses,
/// at which that may be more than a substep. The fastest mode of a grid has eleven times the
/// stiffness of an element, so its phase moves by 1.6 radians in that time; impulses are stable
/// below 2.
constexpr double kSoft = 0.25;

}  // namespace

void PlateProjection::build(const Substep& now) {
  hasBending_ = !now.model.bending.empty();
  if (!hasBending_) return;
  friction_.build(now.model, now.particles);
  splitStep_ = 0.0;
}

void PlateProjection::setStep(Substep& now, int longest) {
  if (empty()) return;
  step_ = {now.h, now.model.bendRetardation(), 1};
  const double divided = powerOfTwoFrom(now.h);
  const bool isNewSplit = !isSplitFor(divided);
  if (isNewSplit) split(now, divided);
  splitStep_ = divided;
  const ScalarArray& w = now.particles.inverseMass;
  if (isNewSplit || now.isNewLayout) stiffest_ = stiff_.stiffest(w) + friction_.stiffest(w);
  if (areStable(longest)) step_.interval = longest;
  stiff_.setStep(step_, w);
  friction_.findHeld(w);
  now.force.resize(w.size());
}

/// Tells whether the elements are divided as they would be for a substep of h.
bool PlateProjection::isSplitFor(double h) const {
  if (splitStep_ == 0.0) return false;
  return h == splitStep_ || (h < splitStep_ ? stiff_.empty() : soft_.empty());
}

/// Divides the elements into soft and stiff ones: those that are soft in a substep of h are so in
/// shorter ones.
void PlateProjection::split(const Substep& now, double h) {
  const std::vector<PlateElement>& elements = now.model.bending.elements();
  const std::vector<double> circles = circlesOf(now.model);
  std::vector<std::uint8_t> isSoft(elements.size(), 0);
  softest_ = 0.0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    double largest = 0.0;
    for (int k = 0; k < elements[e].count; ++k) {
      const VertexId v = elements[e].vertex[static_cast<std::size_t>(k)];
      largest = std::max(largest, circles[static_cast<std::size_t>(v)]);
    }
    if (!friction_.empty() || !isStable(largest, 1, h)) continue;
    softest_ = std::max(softest_, largest);
    isSoft[e] = 1;
  }
  soft_.build(now.model, now.particles, [&](std::size_t e) { return isSoft[e] != 0; });
  stiff_.build(now.model.bending, now.particles, [&](std::size_t e) { return isSoft[e] == 0; });
}

/// \param h  length of a substep [s].
bool PlateProjection::isStable(double circle, int interval, double h) const {
  const double impulse = interval * h * (h + step_.retardation) * circle;
  return impulse <= kStablePart * 4.0 / (interval + 2.0);
}

bool PlateProjection::areStable(int interval) const {
  const double period = interval * step_.h;
  return isStable(softest_, interval, step_.h) && period * period * stiffest_ <= kSoft;
}

void PlateProjection::project(const ScalarArray& inverseInertia, Substep& now) const {
  if (!soft_.empty()) displace(inverseInertia, now);
  const auto onHeld = [&](std::size_t slot, const Vec3& impulse) {
    now.kinematic.addImpulseAt(slot, impulse / now.h);
  };
  stiff_.project(now.particles, inverseInertia, onHeld);
  friction_.project(step_.square(), inverseInertia, now.particles, onHeld);
}

/// Gives the impulses of the soft elements.
void PlateProjection::displace(const ScalarArray& inverseInertia, Substep& now) const {
  Particles& p = now.particles;
  const VectorArray* at = &p.x;
  if (step_.retardation > 0.0) {
    setDifference(p.x, p.start, step_.retardation / step_.h, now.scratch);
    addScaled(1.0, p.x, now.scratch);
    at = &now.scratch;
  }
  for (const std::int32_t held : now.kinematic.slots()) {
    const auto slot = static_cast<std::size_t>(held);
    now.kinematic.addImpulseAt(slot, -step_.interval * step_.h * soft_.rowProduct(slot, *at));
  }
  soft_.displace(step_.square(), inverseInertia, *at, p.x, now.force);
  std::swap(p.x, now.force);
}

}  // namespace cloth_sim
