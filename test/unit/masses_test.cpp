/// \file Masses of particles, also after edits of the mesh.

#include <gtest/gtest.h>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

Model modelOn(TriangleMesh mesh) {
  Model model;
  model.mesh = std::move(mesh);
  return model;
}

TEST(Masses, AreAThirdOfEveryFaceToEachCorner) {
  const Grid grid{4, 4, 0.3, 0.3};
  Model model = modelOn(makeGridMesh(grid));
  lumpMasses(0.2, model);
  const double face = 0.2 * 0.5 * grid.spacingU() * grid.spacingV();  // density times area [kg]
  EXPECT_NEAR(face, 0.2 * 0.5 * 0.1 * 0.1, 1e-14 * face);
  EXPECT_NEAR(model.mass[grid.vertex(1, 1)], 6 * face / 3, 1e-18);
  EXPECT_NEAR(model.mass[grid.vertex(1, 0)], 3 * face / 3, 1e-18);
  EXPECT_NEAR(model.mass[grid.vertex(0, 0)], 2 * face / 3, 1e-18);
  EXPECT_NEAR(model.mass[grid.vertex(3, 0)], 1 * face / 3, 1e-18);
  for (double density : model.arealDensity) EXPECT_EQ(density, 0.2);
}

TEST(Masses, OfParticlesAreTheSameForAll) {
  Model model = modelOn(makeGridMesh({3, 3, 2.0, 2.0}));
  setParticleMasses(0.5, 0, model);
  for (double mass : model.mass) EXPECT_EQ(mass, 0.5);
  EXPECT_DOUBLE_EQ(model.arealDensity[4], 0.5 / (6 * 0.5 / 3));  // six faces around the middle
  EXPECT_DOUBLE_EQ(model.arealDensity[2], 0.5 / (1 * 0.5 / 3));
}

TEST(Masses, FollowSplitsByTheAreaOnEachSideAndKeepTheTotal) {
  Generator random(5);
  for (int sequence = 0; sequence < 20; ++sequence) {
    Model model = modelOn(makeGridMesh({6, 6, 0.5, 0.5}));
    lumpMasses(0.3, model);
    const double before = totalMass(model);
    for (int edit = 0; edit < 10; ++edit) {
      MeshEditor editor(model.mesh);
      for (int k = 0; k < 3; ++k) {
        const Opening opening = randomOpening(model.mesh, random);
        editor.splitVertex(opening.vertex, opening.detach);
      }
      applyMassChanges(editor.finish(), model);
    }
    EXPECT_NEAR(totalMass(model), before, 1e-13 * before);
    // Masses that were by area stay by area.
    Model expected = modelOn(model.mesh);
    lumpMasses(0.3, expected);
    for (VertexId v = 0; v < model.mesh.vertexCount(); ++v) {
      EXPECT_NEAR(model.mass[v], expected.mass[v], 1e-12 * expected.mass[v]);
    }
  }
}

TEST(Masses, OfEqualParticlesAreSharedToo) {
  Model model = modelOn(makeGridMesh({3, 3, 1.0, 1.0}));
  setParticleMasses(1.0, 0, model);
  MeshEditor editor(model.mesh);
  ASSERT_TRUE(editor.splitVertex(4, {model.mesh.facesAround(4)[0]}));
  applyMassChanges(editor.finish(), model);
  EXPECT_NEAR(model.mass[9], 1.0 / 6.0, 1e-15);  // one of six equal faces
  EXPECT_NEAR(model.mass[4], 5.0 / 6.0, 1e-15);
  EXPECT_NEAR(model.mass[8], 1.0, 1e-15) << "its own faces did not change";
}

enum class MassMode { kFabric, kParticles };

class AnyEdit : public testing::TestWithParam<MassMode> {};

TEST_P(AnyEdit, KeepsTheTotalMass) {
  Generator random(6);
  for (int sequence = 0; sequence < 10; ++sequence) {
    Model model = modelOn(irregularMesh({6, 5, 0.5, 0.4}, 0.2, random));
    if (GetParam() == MassMode::kFabric) {
      lumpMasses(0.3, model);
    } else {
      setParticleMasses(1e-3, 0, model);
    }
    const double before = totalMass(model);
    MeshEditor editor(model.mesh);
    RandomEditor edits(editor, random);
    for (int edit = 0; edit < 100; ++edit) {
      for (int k = whole(random, 1, 3); k > 0; --k) edits.any();
      applyMassChanges(editor.finish(), model);
      ASSERT_EQ(model.mass.size(), static_cast<std::size_t>(model.particleCount()));
    }
    EXPECT_NEAR(totalMass(model), before, 1e-13 * before);
    for (double mass : model.mass) EXPECT_GT(mass, 0.0);
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      const double lumped = model.arealDensity[v] * areaAround(model.mesh, v) / 3.0;
      EXPECT_NEAR(model.mass[v], lumped, 1e-12 * lumped);
      if (GetParam() == MassMode::kFabric) {
        EXPECT_NEAR(model.arealDensity[v], 0.3, 0.3e-12);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Masses, AnyEdit, testing::Values(MassMode::kFabric, MassMode::kParticles),
                         [](const auto& test) {
                           return std::string(test.param == MassMode::kFabric ? "Fabric"
                                                                              : "Particles");
                         });

TEST(Masses, OfPiecesGoWithThem) {
  // Opened along the middle column of 3 x 3: two halves of the same area.
  Model model = modelOn(makeGridMesh({3, 3, 1.0, 1.0}));
  lumpMasses(0.3, model);
  MeshEditor editor(model.mesh);
  ASSERT_TRUE(editor.splitVertex(4, {3, 6, 7}));
  applyMassChanges(editor.finish(), model);
  ASSERT_EQ(connectedComponents(model.mesh).count, 2);
  editor.removeComponents({0, 1, 4, 5});
  applyMassChanges(editor.finish(), model);
  EXPECT_NEAR(totalMass(model), 0.15, 1e-15);
  Model expected = modelOn(model.mesh);
  lumpMasses(0.3, expected);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    EXPECT_NEAR(model.mass[v], expected.mass[v], 1e-15);
  }
}

}  // namespace
}  // namespace cloth_sim
