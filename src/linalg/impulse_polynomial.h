#pragma once
/// \file A polynomial of a stiffness that stays in bounds where the stiffness itself does not.

#include <cmath>

namespace cloth_sim {

/// P(a) of an impulse, where a = h^2 k / m is the impulse of a mode of stiffness k and mass m over
/// its momentum if it is given at once, explicitly, in a substep of h.
///
/// P(a) = 1 - T_s(w0 - w1 a) / T_s(w0) with the Chebyshev polynomial T_s of the degree s, and w0,
/// w1 such that T_s(w0) = 10 and P'(0) = 1. So P rises as a does while a is small, and stays within
/// [0.9, 1.1] from there up to about 0.67 s^2 (as stabilised Runge-Kutta methods, van der Houwen &
/// Sommeijer 1980). P = a for s = 1.
///
/// P(A) y with a matrix A is A z_s, by the recurrence z_0 = 0, z_1 = first() y,
/// z_{j+1} = r (y - A z_j) + c z_j - b z_{j-1}.
class ImpulsePolynomial {
 public:
  /// Coefficients of a step of the recurrence.
  struct Step {
    double residual;  ///< r
    double current;   ///< c
    double before;    ///< b
  };

  explicit ImpulsePolynomial(int degree)
      : degree_(degree),
        angle_(std::acosh(kEnd) / degree),
        w0_(std::cosh(angle_)),
        w1_(kEnd * std::sinh(angle_) / (degree * std::sqrt(kEnd * kEnd - 1.0))) {}

  int degree() const { return degree_; }
  /// The largest a up to which P is in [0, 1.1].
  double limit() const { return (1.0 + w0_) / w1_; }
  double first() const { return w1_ / w0_; }
  /// The step from z_j to z_{j+1}. \param j  >= 1.
  Step step(int j) const {
    const double next = std::cosh((j + 1) * angle_);  // T_{j+1}(w0)
    const double ratio = std::cosh(j * angle_) / next;
    return {2.0 * w1_ * ratio, 2.0 * w0_ * ratio, std::cosh((j - 1) * angle_) / next};
  }

 private:
  static constexpr double kEnd = 10.0;  ///< T_s(w0): 1 over the largest |1 - P|

  int degree_;
  double angle_;  ///< w0 is its hyperbolic cosine
  double w0_;
  double w1_;
};

}  // namespace cloth_sim
