#include "reality_drape.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "reality_cloth.h"
#include "reality_disc.h"

namespace cloth_sim {
namespace {

constexpr double kDrapeRadius = 0.15;    ///< of the cloth [m]
constexpr double kDrapeSupport = 0.09;   ///< radius of the discs [m]
constexpr double kDrapeTensile = 200.0;  ///< [N/m]: weights strain it by less than 1e-3
constexpr double kDrapeDrag = 3.0;       ///< [1/s]
constexpr double kDrapeWave = 3e-3;      ///< height of the folds at the start [m]

/// Radius up to which the particles are held: half a ring beyond the edge [m].
double heldRadius(const DrapeMesh& mesh) {
  return kDrapeSupport + 0.25 * std::sqrt(3.0) * mesh.side;
}

ClothSpec discOf(const DrapeFabric& fabric, const DrapeMesh& mesh, double shear) {
  ClothSpec spec;
  spec.mesh =
      std::make_shared<ClothMesh>(makeDisc(kDrapeRadius, heldRadius(mesh), mesh.side, mesh.turn));
  spec.width = spec.height = 2.0 * kDrapeRadius;
  spec.fabric = plainFabric(fabric.density, fabric.bending, kDrapeTensile, shear);
  spec.fabric.bendingHysteresis = fabric.hysteresis;
  spec.springs = {true, false};
  spec.plate = true;
  return spec;
}

/// Energy per area of a small even shear angle over angle^2 / 2 [N/m].
double evenShearStiffness(ClothSpec spec) {
  constexpr double kAngle = 1e-5;
  spec.plate = false;
  HeldCloth cloth(spec);
  for (VertexId v = 0; v < cloth.model().particleCount(); ++v) {
    Vec3& x = cloth.state.x[v];
    x += 0.5 * kAngle * Vec3(x.y(), x.x(), 0.0);
  }
  double area = 0.0;
  const TriangleMesh& mesh = cloth.model().mesh;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) area += mesh.restArea(f);
  return 2.0 * energies(cloth.model(), cloth.state, Vec3::Zero()).elastic /
         (area * kAngle * kAngle);
}

/// The shear stiffness to give to the fabric so that the disc has the one that is asked for [N/m].
double calibratedShear(const DrapeFabric& fabric, const DrapeMesh& mesh) {
  const double none = evenShearStiffness(discOf(fabric, mesh, 0.0));
  const double some = evenShearStiffness(discOf(fabric, mesh, fabric.shear));
  return std::max(0.0, fabric.shear * (fabric.shear - none) / (some - none));
}

double energyOf(const HeldCloth& cloth) {
  const Energies e = energies(cloth.model(), cloth.state, cloth.controls.gravity);
  return e.elastic + e.gravity;
}

/// The rim from above, by angle.
std::vector<Vec2> rimOf(const ClothMesh& mesh, const HeldCloth& cloth) {
  std::vector<std::pair<double, Vec2>> sorted;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec2 flat = mesh.positions[v].head<2>();
    if (flat.norm() < kDrapeRadius - 1e-9) continue;
    sorted.emplace_back(std::atan2(flat.y(), flat.x()),
                        Vec2(cloth.state.x[static_cast<VertexId>(v)].head<2>()));
  }
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vec2> rim;
  for (const auto& [angle, at] : sorted) rim.push_back(at);
  return rim;
}

/// Holds the inner disc and puts a wave on the rest.
void release(HeldCloth& cloth, double held, int start) {
  for (VertexId v = 0; v < cloth.model().particleCount(); ++v) {
    Vec3& x = cloth.state.x[v];
    const double r = x.head<2>().norm();
    if (r < held + 1e-9) {
      cloth.hold(v);
    } else {
      const double out = (r - held) / (kDrapeRadius - held);
      // A little of another wave, so that it may choose.
      const double angle = std::atan2(x.y(), x.x());
      x.z() = kDrapeWave * out * (std::cos(start * angle) + 0.1 * std::cos(angle + 1.0));
    }
  }
}

}  // namespace

Drape simulateDrape(const DrapeFabric& fabric, const DrapeMesh& mesh, int start) {
  const ClothSpec spec = discOf(fabric, mesh, calibratedShear(fabric, mesh));
  HeldMethod method;
  method.parameters["iterations"] = 3.0;
  HeldCloth cloth(spec, method);
  cloth.controls.drag = kDrapeDrag;
  const double flat = energyOf(cloth);
  const std::vector<Face>& faces = spec.mesh->faces;
  const double all = shadowArea(faces, cloth.state.x.values(), 1.1 * kDrapeRadius, 800);
  release(cloth, heldRadius(mesh), start);
  Drape drape;
  drape.start = start;
  drape.isAtRest = cloth.settle(5e-4, 5.0);
  const double support = M_PI * kDrapeSupport * kDrapeSupport;
  const double shadow = shadowArea(faces, cloth.state.x.values(), 1.1 * kDrapeRadius, 800);
  drape.coefficient = 100.0 * (shadow - support) / (all - support);
  drape.rim = rimOf(*spec.mesh, cloth);
  drape.folds = countFolds(drape.rim);
  drape.energy = energyOf(cloth) - flat;
  return drape;
}

int countFolds(const std::vector<Vec2>& rim) {
  constexpr double kStandsOut = 1e-3;  // [m]
  const auto radius = [&rim](std::size_t k) { return rim[k % rim.size()].norm(); };
  // From the lowest place on, a fold counts when the rim has fallen far enough from its top.
  std::size_t first = 0;
  for (std::size_t k = 1; k < rim.size(); ++k) {
    if (radius(k) < radius(first)) first = k;
  }
  int folds = 0;
  bool rises = true;
  double extreme = radius(first);
  for (std::size_t k = first; k <= first + rim.size(); ++k) {
    const double r = radius(k);
    if (rises ? r > extreme : r < extreme) extreme = r;
    if (rises ? extreme - r <= kStandsOut : r - extreme <= kStandsOut) continue;
    if (rises) ++folds;
    rises = !rises;
    extreme = r;
  }
  return folds;
}

}  // namespace cloth_sim
