/// \file The polynomial of bending impulses is the impulse for slow modes, and stays in bounds.

#include "linalg/impulse_polynomial.h"  // private: no method shows a single mode

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth_sim {
namespace {

/// P(a) of a single mode, by the recurrence.
double valueOf(const ImpulsePolynomial& polynomial, double a) {
  double before = 0.0;
  double z = polynomial.first();
  for (int j = 1; j < polynomial.degree(); ++j) {
    const ImpulsePolynomial::Step step = polynomial.step(j);
    const double next = step.residual * (1.0 - a * z) + step.current * z - step.before * before;
    before = std::exchange(z, next);
  }
  return a * z;
}

TEST(ImpulsePolynomial, OfTheFirstDegreeIsTheImpulse) {
  for (const double a : {0.0, 0.3, 1.1}) EXPECT_NEAR(valueOf(ImpulsePolynomial(1), a), a, 1e-14);
}

TEST(ImpulsePolynomial, StaysInBoundsUpToItsLimit) {
  for (const int degree : {2, 3, 5, 12, 48}) {
    const ImpulsePolynomial polynomial(degree);
    EXPECT_GT(polynomial.limit(), 0.65 * degree * degree);
    double most = 0.0;
    for (int k = 0; k <= 2000; ++k) {
      const double value = valueOf(polynomial, 5e-4 * k * polynomial.limit());
      EXPECT_GE(value, -1e-12) << degree << ' ' << k;
      most = std::max(most, value);
    }
    EXPECT_NEAR(most, 1.1, 1e-6) << degree;
    EXPECT_GT(std::abs(1.0 - valueOf(polynomial, 1.05 * polynomial.limit())), 0.15) << degree;
  }
}

TEST(ImpulsePolynomial, IsTheImpulseForSlowModes) {
  // Softer by 0.34 a, where an implicit step would be softer by a.
  for (const int degree : {3, 12, 48}) {
    const ImpulsePolynomial polynomial(degree);
    EXPECT_NEAR(valueOf(polynomial, 1e-6) / 1e-6, 1.0, 1e-5) << degree;
    for (const double a : {0.05, 0.1, 0.2}) {
      const double softness = 1.0 - valueOf(polynomial, a) / a;
      EXPECT_GT(softness, 0.1 * a) << degree;
      EXPECT_LT(softness, 0.35 * a) << degree;
    }
  }
}

}  // namespace
}  // namespace cloth_sim
