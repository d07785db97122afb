#include "stroke_predicates.h"

#include <array>
#include <cmath>

namespace cloth_sim {
namespace {

/// Relative error bound of the floating-point filter. Shewchuk's bound for an orientation is
/// (7 + 56 e) e times the sum of the magnitudes of its terms, with e = 2^-53: 7.8e-16.
constexpr double kFilter = 1e-15;

/// An unevaluated sum of two doubles, the result of an error-free transformation.
struct Pair {
  double high = 0.0;
  double low = 0.0;
};

/// Returns a + b exactly (Knuth's TwoSum).
Pair exactSum(double a, double b) {
  const double sum = a + b;
  const double partOfB = sum - a;
  return {sum, (a - (sum - partOfB)) + (b - partOfB)};
}

/// Returns a b exactly (TwoProduct with a fused multiply-add).
Pair exactProduct(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

using Pair3 = std::array<Pair, 3>;

Pair3 exactDifference(const Vec3& a, const Vec3& b) {
  return {exactSum(a.x(), -b.x()), exactSum(a.y(), -b.y()), exactSum(a.z(), -b.z())};
}

/// A sum of products of pairs, without rounding errors.
class ExactSum {
 public:
  void addProduct(double sign, const Pair& a, const Pair& b) {
    for (double x : {sign * a.high, sign * a.low}) {
      for (double y : {b.high, b.low}) add(exactProduct(x, y));
    }
  }

  void addProduct(double sign, const Pair& a, const Pair& b, const Pair& c) {
    for (double x : {sign * a.high, sign * a.low}) {
      for (double y : {b.high, b.low}) {
        if (x == 0.0 || y == 0.0) continue;
        const Pair xy = exactProduct(x, y);
        for (double z : {c.high, c.low}) {
          add(exactProduct(xy.high, z));
          add(exactProduct(xy.low, z));
        }
      }
    }
  }

  /// Returns the sum, by repeated error-free passes over the terms (Ogita, Rump and Oishi 2005)
  /// until the remainder is below the last digits of the sum. Replaces the terms by the remainder.
  double total() {
    double sum = 0.0;
    for (int pass = 0; pass < kMaxPasses; ++pass) {
      const std::size_t count = count_;
      double rest = 0.0;
      sum = 0.0;
      count_ = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const Pair next = exactSum(sum, terms_[k]);
        sum = next.high;
        rest += std::abs(next.low);
        push(next.low);
      }
      if (rest <= kFilter * std::abs(sum)) break;
      push(sum);
    }
    return sum;
  }

 private:
  /// Each pass gains 53 bits, so only sums that are not finite need this many.
  static constexpr int kMaxPasses = 100;

  void push(double term) {
    if (term != 0.0) terms_[count_++] = term;
  }
  void add(const Pair& product) {
    push(product.low);
    push(product.high);
  }

  std::array<double, 192> terms_;  // six products of three differences: 6 x 2^3 x 2^2
  std::size_t count_ = 0;
};

int signOf(double value) { return (value > 0.0) - (value < 0.0); }

/// Returns the exact sign of det(b - a, c - a, d - a).
int orientationSign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const Vec3 w = d - a;
  const double yz = u.y() * v.z();
  const double zy = u.z() * v.y();
  const double zx = u.z() * v.x();
  const double xz = u.x() * v.z();
  const double xy = u.x() * v.y();
  const double yx = u.y() * v.x();
  const double det = (yz - zy) * w.x() + (zx - xz) * w.y() + (xy - yx) * w.z();
  const double magnitude = (std::abs(yz) + std::abs(zy)) * std::abs(w.x()) +
                           (std::abs(zx) + std::abs(xz)) * std::abs(w.y()) +
                           (std::abs(xy) + std::abs(yx)) * std::abs(w.z());
  if (std::abs(det) > kFilter * magnitude) return signOf(det);
  return signOf(exactOrientation(a, b, c, d));
}

/// Returns the sign of the first non-zero component of (b - a) x (d - c): the sign of an
/// orientation to which the infinitesimal displacement (e, e^2, e^3) contributes.
int crossSign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Pair3 u = exactDifference(b, a);
  const Pair3 v = exactDifference(d, c);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3;
    const std::size_t j = (k + 2) % 3;
    ExactSum component;
    component.addProduct(1.0, u[i], v[j]);
    component.addProduct(-1.0, u[j], v[i]);
    const int sign = signOf(component.total());
    if (sign != 0) return sign;
  }
  return 0;
}

}  // namespace

double exactOrientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Pair3 u = exactDifference(b, a);
  const Pair3 v = exactDifference(c, a);
  const Pair3 w = exactDifference(d, a);
  ExactSum det;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3;
    const std::size_t j = (k + 2) % 3;
    det.addProduct(1.0, u[i], v[j], w[k]);
    det.addProduct(-1.0, u[j], v[i], w[k]);
  }
  return det.total();
}

int sideOfPlane(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& v) {
  const int side = orientationSign(p, q, r, v);
  return side != 0 ? side : crossSign(p, q, p, r);
}

int sideOfLine(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const int side = orientationSign(p, q, a, b);
  return side != 0 ? side : crossSign(a, b, p, q);
}

int sideOfFace(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const int side = orientationSign(a, b, c, p);
  return side != 0 ? side : -crossSign(a, b, a, c);
}

bool spanPlane(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 u = q - p;
  const Vec3 v = r - p;
  if (u.cross(v).squaredNorm() > kFilter * u.squaredNorm() * v.squaredNorm()) return true;
  return crossSign(p, q, p, r) != 0;
}

}  // namespace cloth_sim
