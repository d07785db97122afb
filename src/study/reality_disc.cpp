#include "reality_disc.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// The vertices of a ring of the disc.
struct DiscRing {
  VertexId first = 0;
  int count = 1;
  double begin = 0.0;  ///< angle of the first vertex [rad]

  double angle(int k) const { return begin + 2.0 * M_PI * k / count; }
  VertexId vertex(int k) const { return first + k % count; }
};

/// Radii from the middle to the border; one of them is `inner`.
std::vector<double> discRadii(double radius, double inner, double h) {
  const double apart = 0.5 * std::sqrt(3.0) * h;
  const int within = std::max(1, static_cast<int>(std::lround(inner / apart)));
  const int beyond = std::max(1, static_cast<int>(std::lround((radius - inner) / apart)));
  std::vector<double> radii;
  for (int k = 0; k <= within; ++k) radii.push_back(inner * k / within);
  for (int k = 1; k <= beyond; ++k) radii.push_back(inner + (radius - inner) * k / beyond);
  return radii;
}

/// Fills the space between two rings with triangles, always at the ring that is behind.
void zipRings(const DiscRing& in, const DiscRing& out, std::vector<Face>& faces) {
  int a = 0, b = 0;
  // The outer ring begins at the vertex next to the first one of the inner ring.
  const double turns = (in.angle(0) - out.begin) / (2.0 * M_PI) * out.count;
  const int shift = static_cast<int>(std::ceil(turns));
  const auto outer = [&](int k) { return out.vertex(((k + shift) % out.count) + out.count); };
  const double lead = out.angle(shift) - in.angle(0);
  while (a < in.count || b < out.count) {
    const double nextIn = in.angle(a + 1) - in.angle(0);
    const double nextOut = out.angle(b + 1) - out.begin + lead;
    const bool takeOuter = in.count == 1 || a == in.count || (b < out.count && nextOut < nextIn);
    if (takeOuter) {
      faces.push_back({in.vertex(a), outer(b), outer(b + 1)});
      ++b;
    } else {
      faces.push_back({in.vertex(a), outer(b), in.vertex(a + 1)});
      ++a;
    }
    if (in.count == 1 && b == out.count) break;
  }
}

/// Tells whether a point is in a triangle, whichever way round its corners are.
bool shades(const std::array<Vec2, 3>& p, const Vec2& at) {
  int left = 0, right = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec2 e = p[(k + 1) % 3] - p[k], r = at - p[k];
    const double turn = e.x() * r.y() - e.y() * r.x();
    left += turn >= 0.0 ? 1 : 0;
    right += turn <= 0.0 ? 1 : 0;
  }
  return left == 3 || right == 3;
}

}  // namespace

ClothMesh makeDisc(double radius, double inner, double h, double turn) {
  const double golden = M_PI * (3.0 - std::sqrt(5.0));  // no two rings begin at the same angle
  ClothMesh mesh;
  DiscRing before;
  int ring = 0;
  for (const double r : discRadii(radius, inner, h)) {
    const int count = r == 0.0 ? 1 : std::max(5, static_cast<int>(std::lround(2.0 * M_PI * r / h)));
    DiscRing now{static_cast<VertexId>(mesh.material.size()), count,
                 std::fmod((ring + turn) * golden, 2.0 * M_PI)};
    for (int k = 0; k < count; ++k) {
      const Vec2 at = r * Vec2(std::cos(now.angle(k)), std::sin(now.angle(k)));
      mesh.material.push_back(at + Vec2(radius, radius));
      mesh.positions.emplace_back(at.x(), at.y(), 0.0);
    }
    if (ring > 0) zipRings(before, now, mesh.faces);
    before = now;
    ++ring;
  }
  return mesh;
}

double shadowArea(const std::vector<Face>& faces, const std::vector<Vec3>& positions, double half,
                  int cells) {
  const double cell = 2.0 * half / cells;
  std::vector<char> dark(static_cast<std::size_t>(cells) * cells, 0);
  const auto index = [&](double x) {
    return std::clamp(static_cast<int>(std::floor((x + half) / cell)), 0, cells - 1);
  };
  for (const Face& face : faces) {
    std::array<Vec2, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = positions[face[k]].head<2>();
    const Vec2 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
    const Vec2 high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
    for (int row = index(low.y()); row <= index(high.y()); ++row) {
      for (int column = index(low.x()); column <= index(high.x()); ++column) {
        const Vec2 at(cell * (column + 0.5) - half, cell * (row + 0.5) - half);
        if (shades(p, at)) dark[static_cast<std::size_t>(row) * cells + column] = 1;
      }
    }
  }
  return static_cast<double>(std::count(dark.begin(), dark.end(), 1)) * cell * cell;
}

}  // namespace cloth_sim
