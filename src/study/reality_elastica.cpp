#include "reality_elastica.h"

#include <cmath>

#include "reality_cloth.h"

namespace cloth_sim {
namespace {

/// Slope, curvature and place on a strip.
struct StripPoint {
  double theta = 0.0, curvature = 0.0, x = 0.0, y = 0.0;

  StripPoint plus(double t, const StripPoint& p) const {
    return {theta + t * p.theta, curvature + t * p.curvature, x + t * p.x, y + t * p.y};
  }
};

/// A step of the classical Runge-Kutta method. The vertical force is `force` - s.
StripPoint advanceStrip(const StripPoint& p, double s, double h, double force) {
  const auto rate = [force](double at, const StripPoint& q) {
    return StripPoint{q.curvature, (force - at) * std::cos(q.theta), std::cos(q.theta),
                      std::sin(q.theta)};
  };
  const StripPoint a = rate(s, p);
  const StripPoint b = rate(s + 0.5 * h, p.plus(0.5 * h, a));
  const StripPoint c = rate(s + 0.5 * h, p.plus(0.5 * h, b));
  const StripPoint d = rate(s + h, p.plus(h, c));
  return p.plus(h / 6.0, a).plus(h / 3.0, b).plus(h / 3.0, c).plus(h / 6.0, d);
}

/// Bisects for the root of an increasing function.
template <typename Function>
double rootOf(const Function& f, double low, double high) {
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The tip of a strip that begins level with a curvature and bears its whole weight there.
StripPoint tipOf(double overhang, double curvature) {
  constexpr int kSteps = 2000;
  StripPoint p;
  p.curvature = curvature;
  const double h = overhang / kSteps;
  for (int k = 0; k < kSteps; ++k) p = advanceStrip(p, k * h, h, overhang);
  return p;
}

constexpr double kFoldStep = 1e-4;  ///< of the integration along a fold, over l

/// Follows a strip that leaves the table with a force that turns it over.
/// \return whether its slope is back at pi before it is back at the height of the table.
bool turnsBack(double force, SoftFold& fold) {
  StripPoint p;
  bool isOver = false;
  for (double s = 0.0; s < 20.0; s += kFoldStep) {
    p = advanceStrip(p, s, kFoldStep, force);
    if (p.y > fold.height) fold.height = p.y;
    if (!isOver) {
      isOver = p.theta > M_PI;
    } else if (p.theta < M_PI) {
      return true;
    } else if (p.y < 0.0) {
      return false;
    }
  }
  return false;
}

}  // namespace

double elastoGravityLength(double bending, double density) {
  return std::cbrt(bending / (density * kRealityGravity));
}

double cantileverChord(double overhang) {
  // theta falls from the clamp on, and the tip is free: its curvature is zero.
  const auto tipCurvature = [overhang](double guess) { return tipOf(overhang, guess).curvature; };
  const double most =
      overhang * overhang;  // half of it is the curvature of a strip that stays level
  const StripPoint tip = tipOf(overhang, rootOf(tipCurvature, -most, 0.0));
  return std::atan2(-tip.y, tip.x);
}

double cantileverOverhang(double chord) {
  return rootOf([chord](double overhang) { return cantileverChord(overhang) - chord; }, 0.1, 4.0);
}

SoftFold findSoftFold() {
  double low = 2.5, high = 6.0;  // falls below the table; turns back above it
  SoftFold fold;
  for (int k = 0; k < 60; ++k) {
    const double force = 0.5 * (low + high);
    fold = {};
    fold.reaction = force;
    (turnsBack(force, fold) ? high : low) = force;
  }
  return fold;
}

}  // namespace cloth_sim
