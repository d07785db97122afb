/// \file The parts of layer contact: directions that separate faces, the search for pairs, and the
/// certificate that faces do not pass through each other.

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "contact/allowance.h"
#include "contact/face_pair_set.h"
#include "contact/face_pairs.h"  // private, as the next: pairs are tested one by one
#include "contact/layer_contacts.h"
#include "contact/material_tree.h"
#include "verify/intersections.h"

namespace cloth_sim {
namespace {

class RandomPoints {
 public:
  explicit RandomPoints(unsigned seed) : generator_(seed) {}
  double number() { return uniform_(generator_); }
  Vec3 point() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }

 private:
  std::mt19937 generator_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

TEST(ClosestPoints, OfATriangleBeatAllOthers) {
  RandomPoints random(1);
  for (int k = 0; k < 500; ++k) {
    const Corners t{random.point(), random.point(), random.point()};
    const Vec3 p = random.point();
    const auto distance = [&](double u, double v) {
      return (p - (1.0 - u - v) * t[0] - u * t[1] - v * t[2]).norm();
    };
    const std::array<double, 3> w = closestOnTriangle(p, t);
    const double found = distance(w[1], w[2]);
    for (double u = 0.0; u <= 1.0; u += 0.125) {
      for (double v = 0.0; u + v <= 1.0; v += 0.125) EXPECT_LE(found, distance(u, v) + 1e-12);
    }
  }
}

TEST(ClosestPoints, OfSegmentsBeatAllOthers) {
  RandomPoints random(2);
  for (int k = 0; k < 500; ++k) {
    const Vec3 a0 = random.point(), a1 = random.point(), b0 = random.point();
    const Vec3 b1 = k % 5 == 0 ? Vec3(b0 + 2.0 * (a1 - a0)) : random.point();  // parallel, too
    const auto distance = [&](double s, double t) {
      return (a0 + s * (a1 - a0) - b0 - t * (b1 - b0)).norm();
    };
    const SegmentPoints at = closestOnSegments(a0, a1, b0, b1);
    for (double s = 0.0; s <= 1.0; s += 0.1) {
      for (double t = 0.0; t <= 1.0; t += 0.1) {
        EXPECT_LE(distance(at.s, at.t), distance(s, t) + 1e-12);
      }
    }
  }
}

TEST(ClosestPoints, TrianglesApartHaveASeparatingDirectionAndOthersHaveNot) {
  RandomPoints random(3);
  int apart = 0;
  for (int k = 0; k < 2000; ++k) {
    std::vector<Vec3> x;
    for (int v = 0; v < 6; ++v) x.push_back(random.point());
    const bool meet = pierces({0, 1, 2}, {3, 4, 5}, x) || pierces({3, 4, 5}, {0, 1, 2}, x);
    const SeparatingDirection found = separate({x[0], x[1], x[2]}, {x[3], x[4], x[5]});
    EXPECT_EQ(found.distance > 0.0, !meet);
    apart += meet ? 0 : 1;
  }
  EXPECT_GT(apart, 200);
  EXPECT_LT(apart, 1800);
}

TEST(ClosestPoints, TrianglesThatShareACornerHaveASeparatingDirectionUnlessTheyMeet) {
  RandomPoints random(4);
  int apart = 0;
  for (int k = 0; k < 2000; ++k) {
    std::vector<Vec3> x{Vec3::Zero()};
    for (int v = 0; v < 4; ++v) x.push_back(random.point());
    // Two triangles with a common corner meet elsewhere if and only if their cones do.
    const std::vector<Vec3> far{Vec3::Zero(), 9.0 * x[1], 9.0 * x[2], 9.0 * x[3], 9.0 * x[4]};
    std::vector<Vec3> mixed = x;
    mixed.insert(mixed.end(), far.begin() + 1, far.end());
    const bool meet = pierces({0, 1, 2}, {0, 7, 8}, mixed) || pierces({0, 3, 4}, {0, 5, 6}, mixed);
    const SeparatingDirection found = separateAtVertex({x[1], x[2]}, {x[3], x[4]});
    EXPECT_EQ(found.distance > 0.0, !meet) << k;
    apart += meet ? 0 : 1;
  }
  EXPECT_GT(apart, 200);
  EXPECT_LT(apart, 1950);
}

/// Two triangles that move from a place where they are apart to any other one.
struct MovingPair {
  std::vector<Vec3> start;
  std::vector<Vec3> end;
  Face a{0, 1, 2};
  Face b{3, 4, 5};
};

MovingPair movingPair(int shared, RandomPoints& random) {
  MovingPair pair;
  for (int k = 0; k < shared; ++k) pair.b[k] = pair.a[k];
  do {
    pair.start.clear();
    for (int v = 0; v < 6; ++v) pair.start.push_back(random.point());
  } while (!FacePairs::areApart(pair.a, pair.b, pair.start));
  pair.end = pair.start;
  for (Vec3& x : pair.end) x += 1.5 * random.point();
  return pair;
}

bool meet(const Face& a, const Face& b, const std::vector<Vec3>& x) {
  return pierces(a, b, x) || pierces(b, a, x);
}

class Certificate : public testing::TestWithParam<int> {};

TEST_P(Certificate, FacesDoNotMeetAtAnyTimeOfTheSubstep) {
  RandomPoints random(5);
  int changed = 0;
  for (int k = 0; k < 1500; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    std::vector<double> mass(6, 1.0);
    if (k % 3 == 0) mass[0] = 0.0;
    std::vector<std::uint8_t> truncated(6, 0);
    const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
    const std::vector<Vec3> wanted = pair.end;
    const PairOutcome outcome = pairs.keepApart({{pair.start, pair.end, mass, all}, truncated});
    EXPECT_EQ(outcome.unproven, 0);
    changed += outcome.changed ? 1 : 0;
    if (!outcome.changed) {
      EXPECT_EQ(pair.end, wanted);
    }
    std::vector<Vec3> x(6);
    for (int part = 0; part <= 64; ++part) {
      const double t = part / 64.0;
      for (int v = 0; v < 6; ++v) x[v] = (1.0 - t) * pair.start[v] + t * pair.end[v];
      ASSERT_FALSE(meet(pair.a, pair.b, x)) << k << " at " << t;
    }
  }
  EXPECT_GT(changed, 100);
  EXPECT_LT(changed, 1500);
}

/// Faces that would part far, but whose motion is taken back, have not parted.
TEST_P(Certificate, MotionThatIsTakenBackDoesNotCount) {
  RandomPoints random(8);
  const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
  const std::vector<double> mass(6, 1.0);
  int changed = 0;
  for (int k = 0; k < 300; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    std::vector<std::uint8_t> truncated(6, 0);
    const std::vector<Vec3> wanted = pair.end;
    Vec3 fromBToA = Vec3::Zero();
    for (int v = 0; v < 3; ++v) fromBToA += pair.start[pair.a[v]] - pair.start[pair.b[v]];
    pair.end = pair.start;
    for (int v = GetParam(); v < 3; ++v) pair.end[pair.a[v]] += 100.0 * fromBToA.normalized();
    pairs.keepApart({{pair.start, pair.end, mass, all}, truncated});
    pairs.stop({{pair.start, pair.end, mass, all}, truncated});
    EXPECT_EQ(pair.end, pair.start);
    pair.end = wanted;
    changed += pairs.keepApart({{pair.start, pair.end, mass, all}, truncated}).changed ? 1 : 0;
    ASSERT_FALSE(meet(pair.a, pair.b, pair.end)) << k;
  }
  EXPECT_GT(changed, 20);
}

/// Corners that are held and pressed together for many substeps, and are then carried on. Without a
/// least distance they approach by a part of what is left in each substep, until round-off hides
/// the direction between them, and the pair stays where it is for ever.
TEST_P(Certificate, FacesThatArePressedTogetherCanBeToldApartForEver) {
  RandomPoints random(7);
  const std::vector<VertexId> all{0, 1, 2, 3, 4, 5};
  std::vector<std::uint8_t> truncated(6, 0);
  for (int k = 0; k < 20; ++k) {
    MovingPair pair = movingPair(GetParam(), random);
    FacePairs pairs;
    pairs.assign({{0, 1}}, {pair.a, pair.b}, 0.01);
    const std::vector<double> held(6, 0.0);
    for (int substep = 0; substep < 200; ++substep) {
      Vec3 fromBToA = Vec3::Zero();
      for (int v = 0; v < 3; ++v) fromBToA += pair.start[pair.a[v]] - pair.start[pair.b[v]];
      const Vec3 push = 0.02 * fromBToA.normalized();
      for (int v = GetParam(); v < 3; ++v) {
        pair.end[pair.a[v]] = pair.start[pair.a[v]] - push;
        pair.end[pair.b[v]] = pair.start[pair.b[v]] + push;
      }
      const PairOutcome outcome = pairs.keepApart({{pair.start, pair.end, held, all}, truncated});
      ASSERT_EQ(outcome.unproven, 0) << k << " in " << substep;
      ASSERT_FALSE(meet(pair.a, pair.b, pair.end)) << k << " in " << substep;
      pair.start = pair.end;
    }
    for (Vec3& x : pair.end) x.x() += 1.0;
    const std::vector<Vec3> wanted = pair.end;
    const std::vector<double> mass(6, 1.0);
    pairs.keepApart({{pair.start, pair.end, mass, all}, truncated});
    for (const VertexId v : all) EXPECT_NEAR(pair.end[v].x(), wanted[v].x(), 1e-6) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(SharedCorners, Certificate, testing::Values(0, 1, 2));

TEST(GradientBall, GrowsToContainBoth) {
  RandomPoints random(6);
  for (int k = 0; k < 200; ++k) {
    GradientBall a, b;
    a.centre = {random.point(), random.point()};
    b.centre = {random.point(), random.point()};
    a.radius = std::abs(random.number());
    b.radius = std::abs(random.number());
    GradientBall both = a;
    both.add(b);
    EXPECT_LE((both.centre - a.centre).norm() + a.radius, both.radius + 1e-12);
    EXPECT_LE((both.centre - b.centre).norm() + b.radius, both.radius + 1e-12);
  }
}

/// A square sheet whose rows are bent along a circle of `radius` [m], by more than one turn if the
/// radius is small.
State rolled(const Model& model, double radius, double drift) {
  State state;
  state.x = VertexData<Vec3>(static_cast<std::size_t>(model.particleCount()), Vec3::Zero());
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const Vec2 at = model.mesh.material(v);
    const double angle = at.x() / radius;
    const double r = radius + drift * angle;
    state.x[v] = Vec3(r * std::sin(angle), at.y() + 0.1 * at.x() * at.y(), r * std::cos(angle));
  }
  return state;
}

/// Boxes and gradients of the faces of a cloth.
struct FaceBounds {
  std::vector<QuickBox> boxes;
  std::vector<GradientBall> balls;
};

FaceBounds boundsOf(const Model& model, const State& state) {
  FaceBounds bounds;
  for (const Face& face : model.mesh.faces()) {
    Box box;
    for (const VertexId v : face) box.add({state.x[v], state.x[v]});
    bounds.boxes.emplace_back(box);
    Eigen::Matrix2d rest;
    for (int k = 0; k < 2; ++k) {
      rest.col(k) = model.mesh.material(face[k + 1]) - model.mesh.material(face[0]);
    }
    GradientBall ball;
    ball.centre = Gradient::of(state.x[face[1]] - state.x[face[0]],
                               state.x[face[2]] - state.x[face[0]], rest.inverse());
    ball.radius = 0.05;
    bounds.balls.push_back(ball);
  }
  return bounds;
}

std::vector<FaceIds> searchPairs(const Model& model, const FaceBounds& bounds) {
  MaterialTree tree;
  tree.build(model, 0);
  tree.refit(bounds.boxes, bounds.balls);
  std::vector<FaceIds> pairs;
  tree.collectOwn({bounds.boxes, pairs});
  return pairs;
}

std::vector<FaceIds> searchPairs(const Model& model, const State& state) {
  return searchPairs(model, boundsOf(model, state));
}

/// Held corners of a face come down on another face, a thousandth of its edge from a held corner.
TEST(LayerContacts, APushThrowsNoLightVertexBesideAHeldOne) {
  ClothSpec cloth;
  cloth.columns = cloth.rows = 4;
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  const FaceId last = model.mesh.faceCount() - 1;
  const Face above = model.mesh.face(0);
  const Face below = model.mesh.face(last);
  std::vector<Vec3> start(static_cast<std::size_t>(model.particleCount()), Vec3(9.0, 9.0, 9.0));
  std::vector<double> mass(start.size(), 1e-6);
  start[below[0]] = Vec3::Zero();
  start[below[1]] = Vec3(0.1, 0.0, 0.0);
  start[below[2]] = Vec3(0.0, 0.1, 0.0);
  mass[below[0]] = 0.0;
  std::vector<Vec3> end = start;
  for (int k = 0; k < 3; ++k) {
    start[above[k]] = Vec3(1e-4, 1e-5 * k, 0.001);
    end[above[k]] = Vec3(1e-4, 1e-5 * k, 0.0005);
    mass[above[k]] = 0.0;
  }
  LayerContacts contacts;
  contacts.build(model, {{0.001, 0.3}});
  std::vector<QuickBox> boxes;
  for (const Vec3& x : start) boxes.emplace_back(Box{x.array() - 0.0005, x.array() + 0.0005});
  contacts.assign({{0, last}}, boxes);
  std::vector<VertexId> all(start.size());
  std::iota(all.begin(), all.end(), 0);
  contacts.project({start, end, mass, all}, 1e-3);
  EXPECT_GT(contacts.active(), 0);
  EXPECT_LT((end[below[1]] - start[below[1]]).norm(), 0.02);
}

TEST(LayerContacts, PointsAndLeastDistanceAreOfContactsThatCarryLoad) {
  const std::string yaml = R"(
cloth:
  - {name: lower, size: [0.1, 0.1], particles: [9, 9], fabric: cotton, thickness: 0.001}
  - {name: upper, size: [0.1, 0.1], particles: [9, 9], fabric: cotton, thickness: 0.001,
     pose: {position: [0, 0, 0.01]}}
self_contact: true
drag: 2
solver: {method: line_xpbd, error: 0.01}
obstacles: {table: {type: board, size: [1, 1, 0.1], position: [0, 0, -0.0505]}}
)";
  Simulation simulation(parseScene(yaml, "two"));
  simulation.step();
  ASSERT_TRUE(simulation.layerReport().has_value());
  EXPECT_EQ(simulation.layerReport()->contacts, 0) << "the upper cloth is still in the air";
  EXPECT_TRUE(std::isinf(simulation.layerReport()->leastDistance));
  for (int k = 0; k < 60; ++k) simulation.step();
  const auto snapshot = simulation.snapshot(Detail::kShape, ContactDetail::kPoints);
  EXPECT_NEAR(simulation.layerReport()->leastDistance, 0.001, 2e-5);
  ASSERT_TRUE(snapshot->contactPoints.has_value());
  double force = 0.0;
  for (const LayerContactPoint& contact : *snapshot->contactPoints) {
    EXPECT_NEAR(contact.place.z(), 0.0005, 1e-4) << "in the middle between the cloths";
    EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-12);
    EXPECT_GT(contact.force, 0.0);
    force += contact.force * std::abs(contact.normal.z());
  }
  const double weight = 9.81 * 0.5 * totalMass(simulation.model());
  EXPECT_NEAR(force, weight, 0.05 * weight) << "the lower cloth carries the upper one";
  EXPECT_FALSE(simulation.snapshot(Detail::kShape)->contactPoints) << "not asked for";
}

TEST(MaterialTree, FindsEveryPairThatMeetsAndNoneInASmoothSheet) {
  ClothSpec cloth;
  cloth.columns = cloth.rows = 21;
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  EXPECT_TRUE(searchPairs(model, rolled(model, 10.0, 0.0)).empty()) << "nearly flat";
  EXPECT_LT(searchPairs(model, rolled(model, 0.3, 0.0)).size(), 500U) << "half a turn";
  int meeting = 0;
  for (const double radius : {0.05, 0.08, 0.11}) {
    const State state = rolled(model, radius, -0.006);
    std::set<std::pair<FaceId, FaceId>> listed;
    for (const FaceIds& pair : searchPairs(model, state)) {
      EXPECT_LT(pair.first, pair.second);
      EXPECT_TRUE(listed.insert({pair.first, pair.second}).second) << "listed twice";
    }
    const std::vector<Face>& faces = model.mesh.faces();
    for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
      for (FaceId g = f + 1; g < model.mesh.faceCount(); ++g) {
        if (!meet(faces[f], faces[g], state.x.values())) continue;
        ++meeting;
        EXPECT_EQ(listed.count({f, g}), 1U) << f << ' ' << g;
      }
    }
  }
  EXPECT_GT(meeting, 20);
}

TEST(MaterialTree, ASearchAroundChangedFacesMissesNothing) {
  ClothSpec cloth;
  cloth.columns = cloth.rows = 21;
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  RandomPoints random(9);
  FaceBounds bounds = boundsOf(model, rolled(model, 0.11, -0.006));
  MaterialTree tree;
  tree.build(model, 0);
  tree.refit(bounds.boxes, bounds.balls);
  std::vector<FaceIds> pairs;
  tree.collectOwn({bounds.boxes, pairs});
  std::set<std::pair<FaceId, FaceId>> known;
  std::size_t added = 0;
  for (int round = 0; round < 60; ++round) {
    for (const FaceIds& pair : pairs) added += known.insert({pair.first, pair.second}).second;
    for (const FaceIds& pair : searchPairs(model, bounds)) {
      ASSERT_EQ(known.count({pair.first, pair.second}), 1U) << "round " << round;
    }
    std::vector<FaceId> changed;
    for (int k = 0; k <= round % 5; ++k) {
      const auto f = static_cast<FaceId>(std::abs(random.number()) * 0.999 *
                                         static_cast<double>(model.mesh.faceCount()));
      const Vec3 at = 0.5 * random.point();
      bounds.boxes[f].add(QuickBox({at, at}));
      bounds.balls[f].radius = std::abs(random.number());
      changed.push_back(f);
    }
    tree.refit(changed, bounds.boxes, bounds.balls);
    pairs.clear();
    tree.collectOwn({bounds.boxes, pairs});
  }
  EXPECT_GT(added, 500U);
}

TEST(MaterialTree, ASearchEndsWhenThereAreEnoughPairs) {
  ClothSpec cloth;
  cloth.columns = cloth.rows = 21;
  cloth.fabric = fabricPreset("cotton");
  const Model model = buildModel(cloth);
  FaceBounds bounds = boundsOf(model, rolled(model, 0.11, -0.006));
  for (GradientBall& ball : bounds.balls) ball.radius = 2.0;  // nothing is proven
  const std::vector<FaceIds> all = searchPairs(model, bounds);
  MaterialTree tree;
  tree.build(model, 0);
  tree.refit(bounds.boxes, bounds.balls);
  std::vector<FaceIds> pairs;
  tree.collectOwn({bounds.boxes, pairs, 20});
  ASSERT_GT(pairs.size(), 20U);
  ASSERT_LT(pairs.size(), 40U);
  ASSERT_GT(all.size(), 40U);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    EXPECT_EQ(pairs[k].first, all[k].first);
    EXPECT_EQ(pairs[k].second, all[k].second);
  }
}

TEST(FacePairSet, KnowsWhatWasInserted) {
  FacePairSet pairs;
  pairs.clear(10);
  EXPECT_TRUE(pairs.isEmpty());
  EXPECT_TRUE(pairs.insert({1, 2}));
  EXPECT_TRUE(pairs.insert({1, 3}));
  EXPECT_TRUE(pairs.insert({2, 3}));
  EXPECT_FALSE(pairs.insert({1, 2}));
  EXPECT_FALSE(pairs.isEmpty());
  pairs.clear(10);
  EXPECT_TRUE(pairs.insert({1, 2}));
}

/// Particles of a cloth in slots that run backwards, so that a slot is not its vertex.
struct Backwards {
  std::vector<double> x, y, z, mass;
  std::vector<std::int32_t> slotOf;

  /// \param empty  number of slots in front that have no vertex.
  explicit Backwards(const std::vector<Vec3>& at, std::size_t empty = 0)
      : x(empty + at.size()), y(x.size()), z(x.size()), mass(x.size(), 1.0) {
    for (std::size_t v = 0; v < at.size(); ++v) {
      const std::size_t k = x.size() - 1 - v;
      slotOf.push_back(static_cast<std::int32_t>(k));
      x[k] = at[v].x();
      y[k] = at[v].y();
      z[k] = at[v].z();
    }
  }
  ParticleView view() {
    ParticleView particles;
    particles.x = x.data();
    particles.y = y.data();
    particles.z = z.data();
    particles.startX = x.data();  // at rest
    particles.startY = y.data();
    particles.startZ = z.data();
    particles.mass = mass.data();
    particles.slotOf = slotOf.data();
    return particles;
  }
};

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
