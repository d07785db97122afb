/// \file The search for pairs of faces in cloth that has come apart.

#include "contact/face_pair_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "layer_support.h"

namespace cloth_sim {
namespace {

/// A cloth of 0.4 m that is cut from side to side, beside its middle or into many strips.
Simulation cutCloth(const std::vector<double>& cuts) {
  std::string phases;
  for (const double u : cuts) {
    const std::string at = std::to_string(u);
    phases += "  - {name: cut" + at + ", notch: [[" + at + ", -0.01], [" + at +
              ", 0.41]], timeout: 0.001}\n";
  }
  Simulation simulation(parseScene(
      "cloth: {size: [0.4, 0.4], particles: [21, 21], fabric: cotton}\ngravity: [0, 0, 0]\n"
      "self_contact: true\nphases:\n" +
          phases,
      "cut"));
  while (simulation.script().status() != ScriptStatus::kDone) simulation.step();
  return simulation;
}

std::set<std::pair<FaceId, FaceId>> pairsAt(const Model& model, const std::vector<Vec3>& x) {
  FacePairSearch search;
  search.build(model, 5e-4);
  search.findPairs(x, x, Reach{}, NearPairs::kAll);
  std::set<std::pair<FaceId, FaceId>> pairs;
  for (const FaceIds& pair : search.near()) {
    EXPECT_TRUE(pairs.insert({pair.first, pair.second}).second) << "listed twice";
  }
  return pairs;
}

class CutCloth : public testing::TestWithParam<std::vector<double>> {};

TEST_P(CutCloth, TheSearchMissesNoPairOfPieces) {
  const Simulation simulation = cutCloth(GetParam());
  ASSERT_EQ(simulation.pieces(), static_cast<int>(GetParam().size()) + 1);
  const Model& model = simulation.model();
  RandomPoints random(4);
  std::vector<Vec3> x = simulation.state().x.values();
  for (Vec3& at : x) at += 0.03 * random.point();
  const std::set<std::pair<FaceId, FaceId>> found = pairsAt(model, x);
  const std::vector<Face>& faces = model.mesh.faces();
  int meeting = 0;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    for (FaceId g = f + 1; g < model.mesh.faceCount(); ++g) {
      if (!meet(faces[f], faces[g], x)) continue;
      ++meeting;
      EXPECT_EQ(found.count({f, g}), 1U) << f << ' ' << g;
    }
  }
  EXPECT_GT(meeting, 500);
}

INSTANTIATE_TEST_SUITE_P(IntoHalvesAndStrips, CutCloth,
                         testing::Values(std::vector<double>{0.205},
                                         std::vector<double>{0.013, 0.027, 0.205, 0.31}));

/// Half of a cloth that lies flat has been taken away: only faces beside the cut have neighbours
/// that nothing rules out.
TEST(FacePairSearch, HalvesThatAreFarApartAreNoPairs) {
  const Simulation simulation = cutCloth({0.205});
  const Model& model = simulation.model();
  std::vector<Vec3> x = simulation.state().x.values();
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    x[v] = {model.mesh.material(v).x(), model.mesh.material(v).y(), 0.0};
  }
  const ConnectedComponents pieces = connectedComponents(model.mesh);
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    if (pieces.ofFace[f] != pieces.ofFace[0]) continue;
    for (const VertexId v : model.mesh.face(f)) x[v].z() = 1.0;
  }
  std::size_t beside = 0;
  for (const auto& [f, g] : pairsAt(model, x)) {
    EXPECT_EQ(pieces.ofFace[f], pieces.ofFace[g]);
    for (const FaceId face : {f, g}) {
      double away = 1.0;
      for (const VertexId v : model.mesh.face(face)) {
        away = std::min(away, std::abs(model.mesh.material(v).x() - 0.205));
      }
      EXPECT_LT(away, 0.041) << "more than two cells";
    }
    ++beside;
  }
  EXPECT_GT(beside, 0U);
}

}  // namespace
}  // namespace cloth_sim
