#include "vector_operations.h"

#include <algorithm>
#include <array>

#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

CLOTH_SIM_VECTOR_CLONES
void sumAxis(std::size_t n, const double* b, double s, const double* c, double* a) {
  for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + s * c[k];
}

CLOTH_SIM_VECTOR_CLONES
void differenceAxis(std::size_t n, const double* b, const double* c, double s, double* a) {
  for (std::size_t k = 0; k < n; ++k) a[k] = s * (b[k] - c[k]);
}

CLOTH_SIM_VECTOR_CLONES
void extrapolateAxis(std::size_t n, const double* b, const double* c, double s, double* a) {
  for (std::size_t k = 0; k < n; ++k) a[k] = s * (b[k] - c[k]) + b[k];
}

/// Eight partial sums, so that it can be vectorised without changing the order.
CLOTH_SIM_VECTOR_CLONES
double dotAxis(std::size_t n, const double* a, const double* b) {
  constexpr std::size_t kLanes = 8;
  std::array<double, kLanes> part{};
  std::size_t k = 0;
  for (; k + kLanes <= n; k += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) part[lane] += a[k + lane] * b[k + lane];
  }
  double sum = 0.0;
  for (; k < n; ++k) sum += a[k] * b[k];
  for (double value : part) sum += value;
  return sum;
}

/// Sets `a`, part by part, by `set(count, coordinates of b, those of c, those of a)` for each axis.
template <typename Set>
void setAxes(const VectorArray& b, const VectorArray& c, VectorArray& a, const Set& set) {
  a.resize(b.x.size());
  forParts(b.x.size(), [&](std::size_t first, std::size_t count) {
    forAxes([&](const auto& q, const auto& r,
                auto& p) { set(count, q.data() + first, r.data() + first, p.data() + first); },
            b, c, a);
  });
}

}  // namespace

void setZero(std::size_t n, VectorArray& a) {
  a.resize(n);
  forParts(n, [&](std::size_t first, std::size_t count) {
    forAxes([&](ScalarArray& axis) { std::fill_n(axis.data() + first, count, 0.0); }, a);
  });
}

void copy(const VectorArray& b, VectorArray& a) {
  a.resize(b.x.size());
  forParts(b.x.size(), [&](std::size_t first, std::size_t count) {
    forAxes([&](const auto& from,
                auto& to) { std::copy_n(from.data() + first, count, to.data() + first); },
            b, a);
  });
}

void setSum(const VectorArray& b, double s, const VectorArray& c, VectorArray& a) {
  setAxes(b, c, a, [s](auto n, auto* q, auto* r, auto* p) { sumAxis(n, q, s, r, p); });
}

void setDifference(const VectorArray& b, const VectorArray& c, double s, VectorArray& a) {
  setAxes(b, c, a, [s](auto n, auto* q, auto* r, auto* p) { differenceAxis(n, q, r, s, p); });
}

void setExtrapolation(const VectorArray& b, const VectorArray& c, double s, VectorArray& a) {
  setAxes(b, c, a, [s](auto n, auto* q, auto* r, auto* p) { extrapolateAxis(n, q, r, s, p); });
}

void addScaled(double s, const VectorArray& b, VectorArray& a) { setSum(a, s, b, a); }

double dot(const VectorArray& a, const VectorArray& b) {
  const std::size_t n = a.x.size();
  return dotAxis(n, a.x.data(), b.x.data()) + dotAxis(n, a.y.data(), b.y.data()) +
         dotAxis(n, a.z.data(), b.z.data());
}

}  // namespace cloth_sim
