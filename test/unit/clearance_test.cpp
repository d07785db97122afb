/// \file The check that cloth is nowhere near itself.

#include "contact/clearance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "cloth_sim/surgery/operation.h"
#include "layer_support.h"

namespace cloth_sim {
namespace {

constexpr double kMargin = 5e-4;

std::vector<Vec3> between(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double t) {
  std::vector<Vec3> x;
  for (std::size_t k = 0; k < a.size(); ++k) x.push_back((1.0 - t) * a[k] + t * b[k]);
  return x;
}

/// A band that `rolled` rolls up along its length of a metre, in cells of 8 mm.
ClothSpec band() {
  ClothSpec cloth = cottonSheet(129);
  cloth.height = 0.032;
  cloth.rows = 5;
  return cloth;
}

/// A check of a model.
class Checker {
 public:
  explicit Checker(const Model& model) { clearance_.build(model, kMargin); }
  bool begin(const std::vector<Vec3>& from) {
    Backwards way(from);
    return clearance_.begin(way.view());
  }
  bool isClearAt(const std::vector<Vec3>& x) { return clearance_.isClearAt(x); }
  bool follow(const std::vector<Vec3>& to) {
    Backwards way(to);  // it remembers where the way began
    return clearance_.follow(way.view());
  }

 private:
  Clearance clearance_;
};

TEST(Clearance, IsThatOfAClothThatIsFarFromItself) {
  const Model model = buildModel(cottonSheet(33));
  Checker check(model);
  std::vector<Vec3> from = rolled(model, 0.3, 0.0).x.values();  // half a turn
  ASSERT_TRUE(check.begin(from));
  for (int k = 0; k < 5; ++k) {
    for (Vec3& x : from) x += Vec3(0.0, 0.2, -1.0);  // falls fast
    for (std::size_t v = 0; v < from.size(); ++v) from[v].x() *= 0.98;
    ASSERT_TRUE(check.follow(from));
  }
}

TEST(Clearance, NoFacesMeetWhereItIs) {
  const Model model = buildModel(band());
  Checker check(model);
  RandomPoints random(21);
  int clear = 0;
  int meeting = 0;
  for (int round = 0; round < 80; ++round) {
    const auto roll = [&] {
      return rolled(model, 0.08 + 0.1 * std::abs(random.number()), 12e-3 * random.number());
    };
    const std::vector<Vec3> from = roll().x.values();
    const std::vector<Vec3> to = between(from, roll().x.values(), round % 2 == 0 ? 0.1 : 1.0);
    const bool isClear = check.begin(from) && check.follow(to);
    clear += isClear ? 1 : 0;
    bool meet = false;
    for (int k = 0; k <= 4 && !meet; ++k) {
      State state;
      state.x = VertexData<Vec3>(between(from, to, k / 4.0));
      meet = countIntersections(model, state) > 0;
    }
    meeting += meet ? 1 : 0;
    EXPECT_FALSE(isClear && meet) << "round " << round;
  }
  EXPECT_GT(clear, 15);
  EXPECT_GT(meeting, 15);
}

TEST(Clearance, LooksAtTheWay) {
  const Model model = buildModel(band());
  Checker check(model);
  const std::vector<Vec3> from = rolled(model, 0.12, 6e-3).x.values();
  const std::vector<Vec3> to = rolled(model, 0.12, -6e-3).x.values();
  ASSERT_TRUE(check.begin(to)) << "nothing is near itself there";
  ASSERT_TRUE(check.begin(from));
  EXPECT_FALSE(check.follow(to)) << "an end of the roll has passed through it";
}

/// Two cloths, one above the other.
class ClearanceOfTwoSheets : public testing::Test {
 protected:
  std::vector<Vec3> at(double height) const { return laidFlat(model_, height); }

  Model model_ = buildModel(std::vector<ClothSpec>{cottonSheet(17), cottonSheet(13)});
  Checker check_{model_};
};

TEST_F(ClearanceOfTwoSheets, KeepTheMargins) {
  EXPECT_TRUE(check_.begin(at(2.1 * kMargin)));
  EXPECT_TRUE(check_.follow(at(2.05 * kMargin)));
  EXPECT_FALSE(check_.follow(at(1.9 * kMargin)));
  EXPECT_TRUE(check_.follow(at(2.05 * kMargin))) << "from the last place that was clear";
}

TEST_F(ClearanceOfTwoSheets, AreFarApartAtTheStart) {
  EXPECT_FALSE(check_.begin(at(1.9 * kMargin)));
  EXPECT_TRUE(check_.begin(at(20.0 * kMargin)));
}

TEST_F(ClearanceOfTwoSheets, CanBeAskedOfPlacesAlone) {
  EXPECT_TRUE(check_.isClearAt(at(2.1 * kMargin)));
  EXPECT_FALSE(check_.isClearAt(at(1.9 * kMargin)));
  EXPECT_FALSE(check_.begin(at(1.9 * kMargin)));
  EXPECT_TRUE(check_.begin(at(2.1 * kMargin)));
}

TEST(Clearance, IsCheckedEveryTenSubstepsOrTwiceAFrame) {
  EXPECT_EQ(Clearance::interval(1.0 / 60.0), 10);
  EXPECT_EQ(Clearance::interval(1.0 / 1200.0), 10);
  EXPECT_EQ(Clearance::interval(1.0 / 2400.0), 20);
  EXPECT_EQ(Clearance::interval(1.0 / 60.0 / 30.0), 15);
}

TEST(Clearance, IsNotThatOfPlacesThatAreNotFinite) {
  const Model model = buildModel(cottonSheet(9));
  Checker check(model);
  std::vector<Vec3> x = rolled(model, 2.0, 0.0).x.values();
  ASSERT_TRUE(check.begin(x));
  x[40].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check.follow(x));
}

TEST(Clearance, BeginsWhereTheLastCheckEnded) {
  const Model model = buildModel(band());
  const std::vector<Vec3> flat = rolled(model, 100.0, 0.0).x.values();
  const std::vector<Vec3> coiled = rolled(model, 0.05, 0.0).x.values();  // in itself
  const std::vector<Vec3> bent = rolled(model, 1.0, 0.0).x.values();
  Checker check(model);
  ASSERT_FALSE(check.begin(coiled));
  ASSERT_TRUE(check.begin(flat));
  ASSERT_TRUE(check.follow(bent));
  ASSERT_TRUE(check.begin(bent));  // by the bounds of the check before
  EXPECT_FALSE(check.follow(coiled));
  EXPECT_FALSE(check.begin(coiled));
  ASSERT_TRUE(check.begin(bent));
  std::vector<Vec3> one = bent;
  one.back() = one.front();  // the ends of the band meet
  EXPECT_FALSE(check.begin(one));
}

TEST(Clearance, IsNotAskedOfACutCloth) {
  Model model = buildModel(cottonSheet(17));
  const std::vector<Vec3> flat = rolled(model, 100.0, 0.0).x.values();
  ASSERT_TRUE(Checker(model).begin(flat));
  State state;
  state.x = VertexData<Vec3>(flat);
  state.v = VertexData<Vec3>(flat.size(), Vec3::Zero());
  cutOut({100, 101, 102, 103}, model, state);
  const std::vector<Vec3>& cut = state.x.values();
  EXPECT_FALSE(Checker(model).begin(cut));
}

TEST(Clearance, IsAskedOfGridsFiveParticlesWide) {
  const auto isAsked = [](const Model& model) {
    return Checker(model).begin(rolled(model, 100.0, 0.0).x.values());
  };
  Model model = buildModel(cottonSheet(5));
  EXPECT_TRUE(isAsked(model));
  model.cloths.front().grid->columns = 6;
  EXPECT_FALSE(isAsked(model));
  model.cloths.front().grid.reset();
  EXPECT_FALSE(isAsked(model));
  EXPECT_FALSE(isAsked(buildModel(cottonSheet(4))));
}

/// A face of a tile.
struct TileFace {
  std::array<std::int32_t, 3> corners{};
  Eigen::Matrix2d inverseRest;

  Gradient gradientAt(const VectorArray& x) const {
    const auto at = [&](int k) { return x.at(static_cast<std::size_t>(corners[k])); };
    return Gradient::of(at(1) - at(0), at(2) - at(0), inverseRest);
  }
};

/// Expects the box of the faces, and a ball around all gradients that is not much too large.
void expectBounds(const std::vector<TileFace>& faces, const VectorArray& x,
                  const TileBounds& bounds) {
  Box box;
  double farthest = 0.0;
  for (const TileFace& face : faces) {
    for (const std::int32_t v : face.corners) {
      const Vec3 at = x.at(static_cast<std::size_t>(v));
      box.add({at, at});
    }
    farthest = std::max(farthest, (face.gradientAt(x) - bounds.ball.centre).norm());
  }
  EXPECT_EQ(bounds.box.low, box.low);
  EXPECT_EQ(bounds.box.high, box.high);
  EXPECT_LE(farthest, bounds.ball.radius * (1.0 + 1e-12));
  EXPECT_LE(bounds.ball.radius, 3.0 * farthest);
}

VectorArray randomPlaces(std::size_t count, RandomPoints& random) {
  VectorArray x;
  x.resize(count);
  for (std::size_t k = 0; k < count; ++k) x.set(k, random.point());
  return x;
}

/// The faces in cells of a grid: four columns and `rows` - 1 rows from a vertex on.
std::vector<TileFace> facesIn(const GridTile& tile) {
  std::vector<TileFace> faces;
  for (std::int32_t j = 0; j + 1 < tile.rows; ++j) {
    for (std::int32_t i = 0; i < 4; ++i) {
      const std::int32_t a = tile.first + j * tile.stride + i;
      const std::int32_t d = a + tile.stride;
      // Both ways to divide the cell.
      for (const auto& corners : {std::array{a, a + 1, d + 1}, std::array{a, d + 1, d},
                                  std::array{a, a + 1, d}, std::array{a + 1, d + 1, d}}) {
        TileFace& face = faces.emplace_back();
        face.corners = corners;
        const auto placeOf = [&](std::int32_t v) {
          const std::int32_t row = v / tile.stride;
          return Vec2(tile.cell.x() * (v - row * tile.stride), tile.cell.y() * row);
        };
        Eigen::Matrix2d edges;
        edges << placeOf(corners[1]) - placeOf(corners[0]),
            placeOf(corners[2]) - placeOf(corners[0]);
        face.inverseRest = edges.inverse();
      }
    }
  }
  return faces;
}

TEST(TileBounds, AreThoseOfTheCellsOfAGrid) {
  RandomPoints random(6);
  for (std::int32_t rows = 2; rows <= GridTile::kMostRows; ++rows) {
    const GridTile tile{2, rows, 9, Vec2(0.5, 0.25)};
    for (int round = 0; round < 10; ++round) {
      const VectorArray x = randomPlaces(45, random);
      expectBounds(facesIn(tile), x, boundTile(tile, x));
    }
  }
}

TEST(TileBounds, OfACellAreThoseOfItsFaces) {
  RandomPoints random(8);
  const GridTile tile{4, 2, 9, Vec2(0.5, 0.25)};
  const std::vector<TileFace> row = facesIn(tile);
  const std::vector<TileFace> first(row.begin(), row.begin() + 4);  // both ways to divide it
  for (int round = 0; round < 10; ++round) {
    const VectorArray x = randomPlaces(45, random);
    expectBounds(first, x, boundCell(tile, x));
  }
}

}  // namespace
}  // namespace cloth_sim
