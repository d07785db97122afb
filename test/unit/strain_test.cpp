/// \file The definition of strain: springs, vertices, faces and the whole cloth.

#include "cloth_sim/cloth/strain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

using Pairs = std::set<std::pair<VertexId, VertexId>>;

Pairs pairsOf(const std::vector<StrainLine>& lines) {
  Pairs pairs;
  for (const StrainLine& line : lines) pairs.insert(std::minmax(line.a, line.b));
  EXPECT_EQ(pairs.size(), lines.size()) << "each pair once";
  return pairs;
}

Pairs springsOf(const Model& model) {
  Pairs pairs;
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists() || spring.kind == SpringKind::kBend) continue;
    pairs.insert(std::minmax(spring.a, spring.b));
  }
  return pairs;
}

Simulation simulationOf(const std::string& text) { return Simulation(parseScene(text, "test")); }

void expectOneDefinition(const Simulation& simulation) {
  const TriangleMesh& mesh = simulation.model().mesh;
  const std::vector<StrainLine> lines =
      strainLines(sortEdges(mesh.faces(), mesh.material().size()), mesh.material());
  EXPECT_EQ(pairsOf(lines), springsOf(simulation.model()));
  std::vector<float> strains;
  vertexStrains(lines, simulation.state().x.values(), strains);
  ASSERT_EQ(strains.size(), static_cast<std::size_t>(mesh.vertexCount()));
  EXPECT_NEAR(*std::max_element(strains.begin(), strains.end()),
              strainOfStretch(maxStretch(simulation.model(), simulation.state())), 1e-6);
}

TEST(Strain, IsZeroWhereASpringIsSlack) {
  EXPECT_NEAR(strainOf(1.21), 0.1, 1e-15);
  EXPECT_NEAR(strainOfStretch(1.1), 0.1, 1e-15);
  EXPECT_EQ(strainOf(0.5), 0.0);
  EXPECT_EQ(strainOfStretch(0.5), 0.0);
}

TEST(Strain, OfAVertexIsTheLargestAndOfAFaceThatOfItsCorners) {
  const std::vector<Face> faces{{0, 1, 3}, {0, 3, 2}};
  const std::vector<Vec2> material{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  const std::vector<Vec3> positions{{0, 0, 0}, {1.25, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  std::vector<float> strains;
  vertexStrains(strainLines(sortEdges(faces, material.size()), material), positions, strains);
  const float across = static_cast<float>(std::sqrt((1.5625 + 1.0) / 2.0) - 1.0);
  EXPECT_NEAR(strains[0], 0.25f, 1e-6f);
  EXPECT_NEAR(strains[1], 0.25f, 1e-6f);
  EXPECT_NEAR(strains[2], across, 1e-6f) << "of the diagonal that is no edge";
  EXPECT_NEAR(strains[3], static_cast<float>(std::sqrt(1.0625) - 1.0), 1e-6f);
  EXPECT_EQ(faceStrain(faces[1], strains), strains[0]);
}

TEST(Strain, LinesOfAMeshAreItsStructuralAndShearSprings) {
  Simulation simulation = simulationOf(R"(
cloth: {size: [0.3, 0.2], particles: [13, 9], pins: [corner_00, corner_10]}
)");
  expectOneDefinition(simulation);
  for (int k = 0; k < 5; ++k) simulation.step();
  expectOneDefinition(simulation);
  const Stroke slanted =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.07, 0.0)}, Vec3::UnitZ(), 1.0);
  ASSERT_TRUE(simulation.apply(CutAlong{slanted}).success);
  expectOneDefinition(simulation);
  for (int k = 0; k < 5; ++k) simulation.step();
  expectOneDefinition(simulation);
}

TEST(Strain, HoldsForRefinedMeshesAndForSeveralCloths) {
  Simulation simulation = simulationOf(R"(
cloth:
  - {name: one, size: [0.2, 0.2], particles: [9, 9], pins: [corner_00, corner_10]}
  - {name: two, size: [0.3, 0.1], particles: [10, 5], pose: {position: [0.0, 0.0, 0.3]},
     pins: [corner_00]}
)");
  ASSERT_TRUE(
      simulation.apply(RefineMesh{RefineNear{{Vec3(0.0, 0.0, 0.0)}, {0.05, 2, 0.0}}}).success);
  for (int k = 0; k < 5; ++k) simulation.step();
  expectOneDefinition(simulation);
}

}  // namespace
}  // namespace cloth_sim
