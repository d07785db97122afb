#include "figures.h"

#include <algorithm>
#include <ctime>

namespace cloth_sim::bench {
namespace {

std::size_t at(int row, int column, int n) { return static_cast<std::size_t>(row * n + column); }

}  // namespace

double columnStretch(const Grid3& x, int n, double side) {
  double worst = 0.0;
  for (int column = 0; column < n; ++column) {
    double length = 0.0;
    for (int row = 0; row + 1 < n; ++row) {
      length += (x[at(row + 1, column, n)] - x[at(row, column, n)]).norm();
    }
    worst = std::max(worst, length / side - 1.0);
  }
  return worst;
}

double worstEdge(const Grid3& x, int n, double side) {
  const double rest = side / (n - 1);
  double worst = 0.0;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const Vec3& p = x[at(row, column, n)];
      if (column + 1 < n) worst = std::max(worst, (x[at(row, column + 1, n)] - p).norm());
      if (row + 1 < n) worst = std::max(worst, (x[at(row + 1, column, n)] - p).norm());
    }
  }
  return worst / rest;
}

double fastest(const Grid3& v) {
  double most = 0.0;
  for (const Vec3& p : v) most = std::max(most, p.norm());
  return most;
}

int countInside(const Grid3& x, const Vec3& centre, double radius, double depth) {
  return static_cast<int>(std::count_if(
      x.begin(), x.end(), [&](const Vec3& p) { return (p - centre).norm() < radius - depth; }));
}

int countBelow(const Grid3& x, double height) {
  return static_cast<int>(
      std::count_if(x.begin(), x.end(), [&](const Vec3& p) { return p.z() < height; }));
}

double cpuTime() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace cloth_sim::bench
