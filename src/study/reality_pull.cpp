#include "reality_pull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "reality_cloth.h"

namespace cloth_sim {
namespace {

constexpr double kStrainOfFit = 1.0 / 6.0;  ///< at which the second set of stiffnesses holds

/// Green strain in the axes of the file, whose second axis is the warp of the preset.
struct GreenStrain {
  double weft = 0.0, warp = 0.0, shear = 0.0;  ///< components 00, 11, 01
};

/// The stiffness at a strain: between the two sets by the largest stretch, between the directions
/// by its angle, never negative, and twice the numbers of the file (dde.cpp of the authors' code).
StretchFit::Tensor stiffnessAt(const StretchFit& fit, const GreenStrain& g) {
  const double mean = 0.5 * (g.weft + g.warp), half = 0.5 * (g.weft - g.warp);
  const double largest = mean + std::hypot(half, g.shear);
  const double part = std::clamp((std::sqrt(1.0 + 2.0 * largest) - 1.0) / kStrainOfFit, 0.0, 1.0);
  const double angle = 0.5 * std::abs(std::atan2(g.shear, half));
  const double place = std::clamp(angle / M_PI * 8.0, 0.0, 4.0);
  const auto k = static_cast<std::size_t>(std::min(3.0, std::floor(place)));
  const double next = place - static_cast<double>(k);
  StretchFit::Tensor result;
  for (std::size_t c = 0; c < result.size(); ++c) {
    const double strained = (1.0 - next) * fit.strained[k][c] + next * fit.strained[k + 1][c];
    result[c] = 2.0 * std::max(0.0, (1.0 - part) * fit.unstrained[c] + part * strained);
  }
  return result;
}

/// Stress along a pull and the strain in the axes of the threads that belongs to it, if the
/// stiffness is `c` and the strain along the pull is `along`.
double stressOf(const StretchFit::Tensor& c, PullKind kind, double along, GreenStrain& g) {
  const double det = c[0] * c[2] - c[1] * c[1];
  switch (kind) {
    case PullKind::kWarp:
      g = {-c[1] / c[0] * along, along, 0.0};
      return det / c[0] * along;
    case PullKind::kWeft:
      g = {along, -c[1] / c[2] * along, 0.0};
      return det / c[2] * along;
    case PullKind::kBiaxial:
      g = {along, along, 0.0};
      return (c[2] + c[1]) * along;
    case PullKind::kBias: {
      // A tension s at 45 degrees is the stress s / 2 in every component.
      const double weft = 0.5 * (c[2] - c[1]) / det, warp = 0.5 * (c[0] - c[1]) / det;
      const double s = along / (0.5 * (weft + warp) + 1.0 / c[3]);
      g = {s * weft, s * warp, along - 0.5 * s * (weft + warp)};
      return s;
    }
  }
  return 0.0;
}

/// A strip along x whose threads lie at 45 degrees: whole cells of the threads, so that its sides
/// are zigzags.
/// \param along, across  length, and half of the width, in halves of the diagonal of a cell
std::shared_ptr<ClothMesh> biasStrip(int along, int across, double spacing) {
  // Particle (i, j) is at x = (i + j) d, y = (j - i) d, with d half of the diagonal of a cell.
  const double d = spacing * std::sqrt(0.5);
  auto mesh = std::make_shared<ClothMesh>();
  std::map<std::pair<int, int>, VertexId> numbers;
  const auto number = [&](int i, int j) {
    const auto [at, isNew] =
        numbers.emplace(std::make_pair(i, j), static_cast<VertexId>(mesh->positions.size()));
    if (isNew) {
      mesh->positions.emplace_back((i + j) * d, (j - i) * d, 0.0);
      mesh->material.emplace_back((i + across) * spacing, (j + across) * spacing);
    }
    return at->second;
  };
  const auto isIn = [&](int i, int j) {
    return i + j >= 0 && i + j <= along && std::abs(j - i) <= across;
  };
  for (int i = -across; i <= along; ++i) {
    for (int j = -across; j <= along; ++j) {
      if (!isIn(i, j) || !isIn(i + 1, j + 1) || !isIn(i + 1, j) || !isIn(i, j + 1)) continue;
      const VertexId a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1),
                     e = number(i, j + 1);
      mesh->faces.push_back({a, b, c});
      mesh->faces.push_back({a, c, e});
    }
  }
  double low = 1e9;
  for (const Vec2& at : mesh->material) low = std::min({low, at.x(), at.y()});
  for (Vec2& at : mesh->material) at -= Vec2(low, low);
  return mesh;
}

/// The patch of a pull along x, with the warp along the pull unless it is a pull of the weft.
ClothSpec patchOf(const std::string& preset, PullKind kind, double spacing) {
  Fabric fabric = fabricPreset(preset);
  fabric.damping = 0.0;
  if (kind == PullKind::kWeft) std::swap(fabric.tensileWarp, fabric.tensileWeft);
  const int across = 8, along = kind == PullKind::kBiaxial ? across : 4 * across;
  ClothSpec spec = stripOf(fabric, along, across + 1, spacing);
  if (kind != PullKind::kBias) return spec;
  spec.mesh = biasStrip(4 * along, across, spacing * std::sqrt(0.5));
  double width = 0.0, height = 0.0;
  for (const Vec2& at : spec.mesh->material) {
    width = std::max(width, at.x());
    height = std::max(height, at.y());
  }
  spec.width = width;
  spec.height = height;
  return spec;
}

/// Smallest and largest coordinates of a cloth.
struct PatchBounds {
  Vec2 low = Vec2::Constant(1e9), high = Vec2::Constant(-1e9);

  explicit PatchBounds(const std::vector<Vec3>& positions) {
    for (const Vec3& x : positions) {
      low = low.cwiseMin(x.head<2>());
      high = high.cwiseMax(x.head<2>());
    }
  }
  Vec2 size() const { return high - low; }
  /// \param depth  of the grips [m]
  bool isEnd(const Vec3& x, double depth) const {
    return x.x() < low.x() + depth || x.x() > high.x() - depth;
  }
  bool isSide(const Vec3& x) const { return x.y() < low.y() + 1e-6 || x.y() > high.y() - 1e-6; }
};

double restAreaOf(const Model& model) {
  double area = 0.0;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) area += model.mesh.restArea(f);
  return area;
}

}  // namespace

const char* toString(PullKind kind) {
  switch (kind) {
    case PullKind::kWarp:
      return "warp";
    case PullKind::kWeft:
      return "weft";
    case PullKind::kBias:
      return "bias";
    case PullKind::kBiaxial:
      return "biaxial";
  }
  return "";
}

const std::vector<StretchFit>& stretchFits() {
  static const std::vector<StretchFit> all = {{"interlock",
                                               "gray-interlock",
                                               {16.593832, -14.695990, 34.477123, 36.860302},
                                               {{{46.364765, 53.694656, 261.013855, -29.691301},
                                                 {49.285110, 87.596100, 206.373993, 22.768457},
                                                 {123.989220, 105.181770, 365.966217, 44.217571},
                                                 {139.686325, 73.592560, 413.553162, -174.43853},
                                                 {127.443810, 85.848587, 405.872833, 32.238411}}}},
                                              {"denim",
                                               "11oz-black-denim",
                                               {205.352005, 10.234077, 1013.88629, 53.387184},
                                               {{{232.027634, 40.646339, 1052.84289, 64.980499},
                                                 {224.592209, 40.384563, 1054.43444, 67.184807},
                                                 {225.951050, 62.095657, 1059.59741, 83.992020},
                                                 {226.039566, 40.502792, 1058.27771, 75.118423},
                                                 {225.767487, 40.917892, 1051.55712, 71.810631}}}},
                                              {"polyester",
                                               "white-dots-on-blk",
                                               {2002.08618, 0.345588, 2027.48559, 19.189022},
                                               {{{2107.22753, 36.371597, 2171.73339, 16.904713},
                                                 {2107.29882, 57.936157, 2153.30712, 24.392872},
                                                 {2107.73291, 28.389059, 2132.72607, 101.462021},
                                                 {2106.93750, 70.149529, 2121.87353, 38.054455},
                                                 {2107.30786, 61.216290, 2150.47680, 37.668823}}}}};
  return all;
}

double fittedPull(const StretchFit& fit, PullKind kind, double strain) {
  const double along = strain + 0.5 * strain * strain;
  GreenStrain g{along, 0.0, 0.0};
  if (kind == PullKind::kWarp) g = {0.0, along, 0.0};
  if (kind == PullKind::kBias) g = {0.5 * along, 0.5 * along, 0.5 * along};
  double stress = 0.0;
  for (int k = 0; k < 200; ++k) {
    GreenStrain next;
    stress = stressOf(stiffnessAt(fit, g), kind, along, next);
    g = {0.5 * (g.weft + next.weft), 0.5 * (g.warp + next.warp), 0.5 * (g.shear + next.shear)};
  }
  return (1.0 + strain) * stress;
}

double simulatedPull(const std::string& preset, PullKind kind, double strain) {
  constexpr double kSpacing = 5e-3;  // [m]
  HeldCloth cloth(patchOf(preset, kind, kSpacing));
  cloth.controls.gravity = Vec3::Zero();
  cloth.controls.drag = 20.0;
  const std::vector<Vec3> flat = cloth.state.x.values();
  const PatchBounds bounds(flat);
  const bool isBiaxial = kind == PullKind::kBiaxial;
  const double depth = kind == PullKind::kBias ? 0.8 * kSpacing : 1e-6;
  const double middle = 0.5 * (bounds.low.x() + bounds.high.x());
  for (VertexId v = 0; v < cloth.model().particleCount(); ++v) {
    Vec3& x = cloth.state.x[v];
    const bool isHeld = bounds.isEnd(x, depth) || (isBiaxial && bounds.isSide(x));
    if (isHeld && !isBiaxial) {  // grips are rigid
      x.x() += std::copysign(0.5 * strain * (bounds.size().x() - 2.0 * depth), x.x() - middle);
    } else {
      x.x() += strain * (x.x() - middle);
    }
    if (isBiaxial) x.y() *= 1.0 + strain;
    if (isHeld) cloth.hold(v);
  }
  if (!cloth.settle(1e-3, 5.0)) return std::numeric_limits<double>::quiet_NaN();
  double force = 0.0;
  for (std::size_t k = 0; k < cloth.controls.kinematic.size(); ++k) {
    if (flat[cloth.controls.kinematic[k].vertex].x() > middle) {
      force -= cloth.report().reactions[k].x();
    }
  }
  // The mean width: sides may be zigzags.
  return force * bounds.size().x() / restAreaOf(cloth.model());
}

}  // namespace cloth_sim
