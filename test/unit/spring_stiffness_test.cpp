/// \file Stiffness of the springs of a cloth together, also after bisections.

#include <gtest/gtest.h>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// Returns the elastic energy per rest area of cloth under the affine deformation `f` [J/m^2].
double energyDensity(const Model& model, const Eigen::Matrix2d& f) {
  State state = flatState(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    state.x[v].head<2>() = f * model.mesh.material(v);
  }
  return energies(model, state, Vec3::Zero()).elastic / model.mesh.totalRestArea();
}

/// Returns 2 W / e^2, W the energy per area under a strain `e` along `axis`, with the other axis
/// free to contract. W is quadratic in the lateral strain up to relative terms of O(e), so three
/// values give its minimum. The mean over +e and -e removes the cubic term of W and leaves a
/// relative error of O(e^2).
double uniaxialStiffness(const Model& model, int axis) {
  const double e = 1e-4;
  double sum = 0.0;
  for (const double strain : {e, -e}) {
    const auto density = [&](double lateral) {
      Eigen::Matrix2d f = Eigen::Matrix2d::Identity();
      f(axis, axis) += strain;
      f(1 - axis, 1 - axis) += lateral;
      return energyDensity(model, f);
    };
    const double low = density(-e), middle = density(0.0), high = density(e);
    const double free = 0.5 * e * (low - high) / (low - 2.0 * middle + high);
    sum += 2.0 * density(free) / (strain * strain);
  }
  return 0.5 * sum;
}

Model membraneOf(const Fabric& fabric, int columns, int rows) {
  ClothSpec spec = clothOf(columns, rows, 0.02, fabric);
  spec.springs.bend = false;
  return buildModel(spec);
}

class PresetStiffness : public testing::TestWithParam<std::string> {};

// With e = 1e-4 the error of the method above is a few e^2 = 1e-8; border springs count by the area
// that they stand for, so a patch of any size is as stiff as the fabric.
constexpr double kStiffnessTolerance = 1e-7;

TEST_P(PresetStiffness, OfAPatchAlongBothThreadsIsTheFabrics) {
  const Fabric fabric = fabricPreset(GetParam());
  for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(5, 5), std::pair(9, 4)}) {
    const Model model = membraneOf(fabric, columns, rows);
    EXPECT_NEAR(uniaxialStiffness(model, 0) / fabric.tensileWarp, 1.0, kStiffnessTolerance);
    EXPECT_NEAR(uniaxialStiffness(model, 1) / fabric.tensileWeft, 1.0, kStiffnessTolerance);
  }
}

TEST_P(PresetStiffness, OfAPatchInShearIsTheFabrics) {
  // A simple shear g stretches one thread by g^2/2 as well, which adds K g^2 / (4 G): below 1e-8
  // for K/G < 400 and g = 1e-5. The mean over both signs removes the term of O(g).
  const Fabric fabric = fabricPreset(GetParam());
  const Model model = membraneOf(fabric, 6, 5);
  const double g = 1e-5;
  double sum = 0.0;
  for (const double angle : {g, -g}) {
    Eigen::Matrix2d f = Eigen::Matrix2d::Identity();
    f(0, 1) = angle;
    sum += 2.0 * energyDensity(model, f) / (g * g);
  }
  EXPECT_NEAR(0.5 * sum / fabric.shear, 1.0, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(All, PresetStiffness, testing::ValuesIn(fabricPresetNames()),
                         [](const auto& test) { return test.param; });

TEST(SpringStiffness, BendSpringsAddNoTension) {
  // The tension of bend springs is taken from the structural ones. The bend springs of a row
  // of n stand for n - 2 of its n - 1 spacings, so a patch lacks C_b / (n - 1), where C_b =
  // 4 l^2 * 16 B / (l^4 theta^2), theta = 50 l (docs/model.md). Without shear the energy is exactly
  // quadratic, so only rounding remains: 1e-16 / e of a length, relative to e.
  Fabric fabric = fabricPreset("silk");
  fabric.shear = 0.0;
  const double l = 0.02;
  const double fold = 50.0 * l;
  const double bend = 64.0 * fabric.bending / (l * l * fold * fold);
  ASSERT_LT(bend, 0.5 * fabric.tensileWeft) << "else the cap is tested";
  for (const int n : {4, 8, 16}) {
    const Model model = buildModel(clothOf(n, n, l, fabric));
    EXPECT_NEAR(uniaxialStiffness(model, 0), fabric.tensileWarp - bend / (n - 1), 1e-4);
    EXPECT_NEAR(uniaxialStiffness(model, 1), fabric.tensileWeft - bend / (n - 1), 1e-4);
  }
}

TEST(SpringStiffness, DoesNotDependOnTheMeshWidth) {
  const Fabric fabric = fabricPreset("cotton");
  for (const double spacing : {0.1, 0.01, 0.001}) {
    ClothSpec spec = clothOf(5, 5, spacing, fabric);
    spec.springs.bend = false;
    EXPECT_NEAR(uniaxialStiffness(buildModel(spec), 0) / fabric.tensileWarp, 1.0,
                kStiffnessTolerance);
  }
}

// ---- after bisections ---------------------------------------------------------------------------

/// A cloth of square cells, all of whose faces were bisected several times.
Model bisectedPatch(bool bend, int generations) {
  Scene scene;
  scene.cloths[0] = clothOf(9, 9, 0.02, fabricPreset("cotton"));
  scene.cloths[0].springs.bend = bend;
  Simulation simulation(scene);
  RefineMesh everywhere;
  everywhere.request.path = {Vec3::Zero()};
  everywhere.request.refinement = {1.0, generations, 0.0};
  EXPECT_TRUE(simulation.apply(everywhere).success);
  EXPECT_GE(simulation.model().mesh.faceCount(), (2 * 8 * 8) << generations);
  return simulation.model();
}

/// Strains of a patch along warp, along weft, in both, and in shear.
std::vector<Eigen::Matrix2d> patchStrains() {
  const double e = 1e-4;
  std::vector<Eigen::Matrix2d> all(4, Eigen::Matrix2d::Identity());
  all[0](0, 0) += e;
  all[1](1, 1) += e;
  all[2] *= 1.0 + e;
  all[3](0, 1) = all[3](1, 0) = 0.5 * e;
  return all;
}

/// Expects the energy of a strained patch to be that of the whole faces after 1 to 6 bisections.
/// \param tolerance  relative [-].
void expectEnergyKept(bool bend, double tolerance) {
  const Model whole = bisectedPatch(bend, 0);
  for (int generations = 1; generations <= 6; ++generations) {
    const Model parts = bisectedPatch(bend, generations);
    for (const Eigen::Matrix2d& f : patchStrains()) {
      const double ratio = energyDensity(parts, f) / energyDensity(whole, f);
      EXPECT_NEAR(ratio, 1.0, tolerance) << generations << " bisections, strain\n" << f;
    }
  }
}

TEST(SpringStiffness, OfAMembraneIsKeptByBisections) { expectEnergyKept(false, 1e-6); }

/// Bend springs of a border are missing, and so is what they would add in tension; the finer the
/// springs, the more this is.
TEST(SpringStiffness, WithBendSpringsIsKeptByBisections) { expectEnergyKept(true, 0.01); }

}  // namespace
}  // namespace cloth_sim
