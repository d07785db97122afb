#include "plate_projection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth/bending_row_sums.h"
#include "linalg/vector_operations.h"

namespace cloth_sim {
namespace {

/// Highest degree of the polynomial, whose cost is in proportion to it: on grids, and where single
/// elements are stiffer, as beside cuts.
constexpr int kMostDegree = 48;
constexpr int kMostDegreeForFew = 12;
/// Stiffness over the median of all elements up to which an element is no such single one.
constexpr double kFew = 2.0;

/// The shortest of the times 1/1200 s * 2^k, k an integer, that is no shorter than h [s]. What
/// depends on that seldom changes as h does, and follows from h alone, not from those before.
double powerOfTwoFrom(double h) {
  constexpr double kOne = 1.0 / 1200.0;
  constexpr double kRounding = 1e-9;
  int exponent = 0;
  std::frexp((1.0 - kRounding) * h / kOne, &exponent);
  return std::ldexp(kOne, exponent);
}

/// Returns the largest of the circles of Gershgorin at the vertices of each element, those of
/// M^-1/2 K M^-1/2, which has the eigenvalues of M^-1 K: light particles at corners do not widen
/// these. K is the stiffness matrix of bending, M the masses.
/// \return by element [1/s^2].
std::vector<double> largestCircles(const Model& model) {
  std::vector<double> scale;
  for (const double mass : model.mass.values()) scale.push_back(1.0 / std::sqrt(mass));
  const std::vector<double> circles = bendingRowSums(model, scale);
  std::vector<double> largest;
  for (const PlateElement& element : model.bending.elements()) {
    double circle = 0.0;
    for (int k = 0; k < element.count; ++k) {
      const VertexId v = element.vertex[static_cast<std::size_t>(k)];
      circle = std::max(circle, circles[static_cast<std::size_t>(v)]);
    }
    largest.push_back(circle);
  }
  return largest;
}

/// The polynomial of the lowest degree that is stable for an impulse, see `impulseOf`. A part a of
/// the momentum of a mode that is given at the predicted position changes (x, h v) by a matrix with
/// the determinant 1 - a and the trace 2 - 2 a, whose eigenvalues are below one for a < 4/3;
/// polynomials stay below 1.1.
ImpulsePolynomial polynomialFor(double impulse) {
  int degree = 1;
  while (degree < kMostDegree && impulse > ImpulsePolynomial(degree).limit()) ++degree;
  return ImpulsePolynomial(degree);
}

}  // namespace

void PlateProjection::build(const Substep& now) {
  hasBending_ = !now.model.bending.empty();
  if (!hasBending_) return;
  friction_.build(now.model, now.particles);
  splitStep_ = 0.0;
}

void PlateProjection::setStep(Substep& now, double lag) {
  if (empty()) return;
  step_ = {now.h, now.model.bendRetardation()};
  const double divided = powerOfTwoFrom(now.h);
  if (!isSplitFor(divided)) split(now, divided);
  splitStep_ = divided;
  const ScalarArray& w = now.particles.inverseMass;
  polynomial_ = polynomialFor(impulseOf(softest_, now.h));
  step_.retardation += lagWithin(polynomial_.limit(), now.h, lag);
  if (polynomial_.degree() > 1) {
    smooth_.resize(w.size());
    before_.resize(w.size());
  }
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
  const std::vector<double> circles = largestCircles(now.model);
  const double most = friction_.empty() ? softLimit(circles, h) : 0.0;
  softest_ = 0.0;
  for (const double circle : circles) {
    if (circle <= most) softest_ = std::max(softest_, circle);
  }
  soft_.build(now.model, now.particles, [&](std::size_t e) { return circles[e] <= most; });
  stiff_.build(now.model.bending, now.particles, [&](std::size_t e) { return circles[e] > most; });
}

/// Returns the circle up to which elements are soft in substeps of h [1/s^2].
double PlateProjection::softLimit(std::vector<double> circles, double h) const {
  const auto circleOf = [&](int degree) {
    return ImpulsePolynomial(degree).limit() / impulseOf(1.0, h);
  };
  const auto middle = circles.begin() + static_cast<std::ptrdiff_t>(circles.size() / 2);
  std::nth_element(circles.begin(), middle, circles.end());
  return std::clamp(kFew * *middle, circleOf(kMostDegreeForFew), circleOf(kMostDegree));
}

/// Returns the part of a lag with which the largest impulse stays below `limit` [s].
double PlateProjection::lagWithin(double limit, double h, double lag) const {
  const double left = limit - impulseOf(softest_, h);
  return softest_ * h * lag <= left ? lag : std::max(0.0, left) / (softest_ * h);
}

/// Returns the largest impulse of one substep of h [s], explicitly, of modes with this stiffness
/// over mass [1/s^2], over their momentum.
double PlateProjection::impulseOf(double circle, double h) const {
  return h * (h + step_.retardation) * circle;
}

void PlateProjection::project(const ScalarArray& inverseInertia, Substep& now) {
  if (!soft_.empty()) displace(inverseInertia, now);
  const auto onHeld = [&](std::size_t slot, const Vec3& impulse) {
    now.kinematic.addImpulseAt(slot, impulse / now.h);
  };
  stiff_.project(now.particles, inverseInertia, onHeld);
  friction_.project(step_.square(), inverseInertia, now.particles, onHeld);
}

/// Gives the impulses of the soft elements.
void PlateProjection::displace(const ScalarArray& inverseInertia, Substep& now) {
  Particles& p = now.particles;
  const VectorArray* at = &p.x;
  if (step_.retardation > 0.0) {
    setExtrapolation(p.x, p.start, step_.retardation / step_.h, now.scratch);
    at = &now.scratch;
  }
  if (polynomial_.degree() > 1) at = &smooth(inverseInertia, *at);
  for (const std::int32_t held : now.kinematic.slots()) {
    const auto slot = static_cast<std::size_t>(held);
    now.kinematic.addImpulseAt(slot, -step_.h * soft_.rowProduct(slot, *at));
  }
  soft_.displace(step_.square(), inverseInertia, *at, p.x, now.force);
  std::swap(p.x, now.force);
}

/// Returns the positions whose explicit impulse is that of the polynomial at the positions `at`.
const VectorArray& PlateProjection::smooth(const ScalarArray& inverseInertia,
                                           const VectorArray& at) {
  const double square = step_.h * (step_.h + step_.retardation);
  setZero(before_.x.size(), before_);
  setDifference(at, before_, polynomial_.first(), smooth_);
  for (int j = 1; j < polynomial_.degree(); ++j) {
    soft_.recur(square, inverseInertia, smooth_, at, polynomial_.step(j), before_);
    std::swap(smooth_, before_);
  }
  return smooth_;
}

}  // namespace cloth_sim
