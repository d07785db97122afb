/// \file The motion that a search covers.

#include "contact/allowance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "layer_support.h"

namespace cloth_sim {
namespace {

TEST(Allowance, IsKeptUntilAVertexOrAGradientLeavesIt) {
  ClothSpec cloth;
  cloth.columns = 21;
  cloth.rows = 17;  // 357 vertices: the last segment of slots is not whole
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  const std::vector<Vec3> start = rolled(model, 0.2, 0.0).x.values();
  Allowance allowance;
  allowance.build(model);
  constexpr double kMotion = 2e-3;
  constexpr double kTurn = 0.02;
  const double cell = (start[1] - start[0]).norm();
  RandomPoints random(11);
  int kept = 0;
  for (int round = 0; round < 200; ++round) {
    allowance.renew(start, start, {4.0, kMotion, 5e-3, kTurn});
    allowance.follow(Backwards(start).view());
    std::vector<Vec3> end = start;
    const Vec3 common = random.point();  // does not count
    const Vec3 wave = 0.3 * cell * kTurn * random.point();
    for (Vec3& x : end) x += common + std::sin(9.0 * x.y()) * wave;
    const auto v = static_cast<std::size_t>(std::abs(random.number()) * 356.9);
    const double far = (round % 2 == 0 ? 0.4 : 3.0) * kTurn * cell;
    end[v] += far * Vec3::UnitX();
    const bool isKept = allowance.isKept(Backwards(end).view());
    EXPECT_EQ(isKept, round % 2 == 0) << round;
    if (!isKept) {
      ASSERT_TRUE(allowance.renewLeft(Backwards(end).view(), 0.1, 1.0));
      const std::vector<FaceId>& faces = allowance.renewed().faces;
      for (const FaceId f : model.mesh.facesAround(static_cast<VertexId>(v))) {
        EXPECT_TRUE(std::binary_search(faces.begin(), faces.end(), f));
      }
      EXPECT_TRUE(allowance.isKept(Backwards(end).view()));
    }
    kept += isKept ? 1 : 0;
  }
  EXPECT_EQ(kept, 100);
  for (const std::size_t v : {std::size_t{356}, std::size_t{0}}) {
    allowance.renew(start, start, {4.0, kMotion, 5e-3, kTurn});
    allowance.follow(Backwards(start).view());
    std::vector<Vec3> end = start;
    end[v].z() = std::nan("");
    EXPECT_FALSE(allowance.isKept(Backwards(end).view()));
    EXPECT_FALSE(allowance.renewLeft(Backwards(end).view(), 0.1, 1.0));
  }
}

TEST(Allowance, KnowsThatSlotsOfRemovedVerticesStayEmpty) {
  ClothSpec cloth;
  cloth.columns = 5;
  cloth.rows = 5;
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  const std::vector<Vec3> start = rolled(model, 0.2, 0.0).x.values();
  Allowance allowance;
  allowance.build(model);
  constexpr std::size_t kEmpty = 100007;
  allowance.renew(start, start, {4.0, 2e-3, 5e-3, 0.02});
  allowance.follow(Backwards(start, kEmpty).view());
  std::vector<Vec3> end = start;
  EXPECT_TRUE(allowance.isKept(Backwards(end, kEmpty).view()));
  end[7].z() += 0.01;
  EXPECT_FALSE(allowance.isKept(Backwards(end, kEmpty).view()));
  EXPECT_TRUE(allowance.renewLeft(Backwards(end, kEmpty).view(), 1.0, 1.0));
  EXPECT_EQ(allowance.renewed().vertices, std::vector<VertexId>{7});
}

}  // namespace
}  // namespace cloth_sim
