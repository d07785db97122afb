/// \file Embedding of paths over the surface into mesh edges.

#include "cloth_sim/surgery/path_embedder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <set>

#include "unit/sound_mesh.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using testing::ElementsAre;

constexpr double kDegree = M_PI / 180.0;
constexpr double kLeastAngle = 5.0 * kDegree;

using Polyline = std::vector<Vec2>;

// ---- polylines as paths over a mesh -------------------------------------------------------------

/// A part of a segment, within one face.
struct Stretch {
  FaceId face = kNone;
  double from = 0.0;
  double to = 1.0;
};

std::optional<Stretch> clip(const TriangleMesh& mesh, FaceId f, const Vec2& p, const Vec2& q) {
  Stretch inside{f, 0.0, 1.0};
  for (int k = 0; k < 3; ++k) {
    const Vec2& a = mesh.material(mesh.face(f)[k]);
    const Vec2& b = mesh.material(mesh.face(f)[(k + 1) % 3]);
    const double length = (b - a).norm();
    const double atP = doubleArea(a, b, p) / length;
    const double atQ = doubleArea(a, b, q) / length;
    if (std::max(atP, atQ) < -1e-13) return std::nullopt;
    if (std::abs(atQ - atP) < 1e-13) continue;  // parallel to the edge, inside of it or on it
    const double t = atP / (atP - atQ);
    if (atQ > atP) {
      inside.from = std::max(inside.from, t);
    } else {
      inside.to = std::min(inside.to, t);
    }
  }
  if ((inside.to - inside.from) * (q - p).norm() < 1e-12) return std::nullopt;
  return inside;
}

/// Returns the faces along a segment, in order, each part of it once.
std::vector<Stretch> stretches(const TriangleMesh& mesh, const Vec2& p, const Vec2& q) {
  std::vector<Stretch> all;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (const auto inside = clip(mesh, f, p, q)) all.push_back(*inside);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  std::vector<Stretch> parts;
  for (const Stretch& s : all) {
    if (parts.empty() || s.to > parts.back().to + 1e-12) parts.push_back(s);
  }
  return parts;
}

/// Returns whether two faces are connected across an edge or fan at a common point.
bool joined(const TriangleMesh& mesh, FaceId f, FaceId g, const Vec2& at) {
  if (f == g) return true;
  int shared = 0;
  for (VertexId v : mesh.face(f)) {
    for (VertexId w : mesh.face(g)) {
      if (v != w) continue;
      ++shared;
      if ((mesh.material(v) - at).norm() < 1e-9) return true;
    }
  }
  return shared == 2;
}

/// Returns the paths of a polyline on the mesh: one for each connected part.
std::vector<SurfacePath> pathsAlong(const TriangleMesh& mesh, const Polyline& line) {
  std::vector<SurfacePath> paths;
  SurfacePoint last;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const auto at = [&](double t) -> Vec2 {
      return t <= 0.0 ? line[k] : (t >= 1.0 ? line[k + 1] : line[k] + t * (line[k + 1] - line[k]));
    };
    for (const Stretch& s : stretches(mesh, line[k], line[k + 1])) {
      const SurfacePoint begin{s.face, at(s.from)};
      const bool goesOn = last.face != kNone && (last.material - begin.material).norm() < 1e-9 &&
                          joined(mesh, last.face, s.face, begin.material);
      if (!goesOn) paths.push_back({{begin}});
      last = {s.face, at(s.to)};
      paths.back().points.push_back(last);
    }
  }
  return paths;
}

/// Returns the only path along a polyline.
SurfacePath pathAlong(const TriangleMesh& mesh, const Polyline& line) {
  const std::vector<SurfacePath> paths = pathsAlong(mesh, line);
  EXPECT_EQ(paths.size(), 1U);
  return paths.at(0);
}

// ---- what must hold -----------------------------------------------------------------------------

/// Returns whether one marked edge, or several on a line, join two vertices: where a path crosses
/// itself, it splits edges that it marked before.
bool isMarkedBetween(const Remesher& remesher, VertexId from, VertexId to) {
  const TriangleMesh& mesh = remesher.mesh();
  while (from != to) {
    const Vec2 d = mesh.material(to) - mesh.material(from);
    VertexId next = kNone;
    for (VertexId w : mesh.neighbours(from)) {
      const Vec2 e = mesh.material(w) - mesh.material(from);
      const bool between = std::abs(d.x() * e.y() - d.y() * e.x()) <= 1e-12 * d.norm() &&
                           d.dot(e) > 0.0 && e.norm() <= d.norm();
      if (remesher.isMarked(from, w) && (w == to || between)) next = w;
    }
    if (next == kNone) return false;
    from = next;
  }
  return true;
}

bool isMarkedPolyline(const Remesher& remesher, const std::vector<VertexId>& vertices) {
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    if (vertices[k] == vertices[k + 1]) return false;
    if (!isMarkedBetween(remesher, vertices[k], vertices[k + 1])) return false;
  }
  return true;
}

double lengthOf(const TriangleMesh& mesh, const std::vector<VertexId>& vertices) {
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    length += (mesh.material(vertices[k + 1]) - mesh.material(vertices[k])).norm();
  }
  return length;
}

double distanceTo(const Polyline& line, const Vec2& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vec2 d = line[k + 1] - line[k];
    const double t = std::clamp(d.dot(p - line[k]) / d.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (line[k] + t * d - p).norm());
  }
  return nearest;
}

/// Embeds one path, and checks the invariants.
EmbeddedPath embed(const SurfacePath& path, Remesher& remesher, PathEnd end = PathEnd::kExact) {
  const double area = preciseArea(remesher.mesh());
  const EmbeddedPath done = embedPath(path, end, remesher);
  expectSound(remesher.mesh(), area);
  EXPECT_TRUE(isMarkedPolyline(remesher, done.vertices));
  EXPECT_NEAR(done.length, lengthOf(remesher.mesh(), done.vertices), 1e-12);
  Polyline line;
  for (const SurfacePoint& p : path.points) line.push_back(p.material);
  for (VertexId v : done.vertices) {
    EXPECT_LE(distanceTo(line, remesher.mesh().material(v)), done.deviation + 1e-12);
  }
  return done;
}

// ---- straight across ----------------------------------------------------------------------------

/// Returns the area of the part of a rectangle (from the origin) to the left of p-q.
double areaLeftOf(const Vec2& size, const Vec2& p, const Vec2& q) {
  const Polyline corners{{0.0, 0.0}, {size.x(), 0.0}, size, {0.0, size.y()}};
  Polyline left;
  for (int k = 0; k < 4; ++k) {
    const Vec2& a = corners[k];
    const Vec2& b = corners[(k + 1) % 4];
    const double atA = doubleArea(p, q, a);
    const double atB = doubleArea(p, q, b);
    if (atA >= 0.0) left.push_back(a);
    if ((atA > 0.0 && atB < 0.0) || (atA < 0.0 && atB > 0.0)) {
      left.push_back(a + (b - a) * (atA / (atA - atB)));
    }
  }
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < left.size(); ++k) {
    twice += doubleArea(left[0], left[k], left[k + 1]);
  }
  return 0.5 * twice;
}

/// Returns the points at which the line through `p` at an angle crosses the border of a rectangle.
std::pair<Vec2, Vec2> chordOf(const Vec2& size, const Vec2& p, double angle) {
  const Vec2 d(std::cos(angle), std::sin(angle));
  double back = -std::numeric_limits<double>::infinity();
  double ahead = -back;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(d[axis]) < 1e-12) continue;
    const double low = -p[axis] / d[axis];
    const double high = (size[axis] - p[axis]) / d[axis];
    back = std::max(back, std::min(low, high));
    ahead = std::min(ahead, std::max(low, high));
  }
  // On the border to the bit, as a stroke's crossings with border edges are.
  const auto snapped = [&](Vec2 end) {
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(end[axis]) < 1e-12) end[axis] = 0.0;
      if (std::abs(end[axis] - size[axis]) < 1e-12) end[axis] = size[axis];
    }
    return end;
  };
  return {snapped(p + back * d), snapped(p + ahead * d)};
}

double cornerDistance(const Vec2& size, const Vec2& p) {
  return std::min({p.norm(), (p - size).norm(), (p - Vec2(size.x(), 0.0)).norm(),
                   (p - Vec2(0.0, size.y())).norm()});
}

/// Returns the angle between a line and the border at which it ends [degrees].
double angleToBorder(const Vec2& size, const Vec2& end, double angle) {
  const bool onVertical = end.x() == 0.0 || end.x() == size.x();
  const double lean = std::abs(std::remainder(angle, M_PI)) / kDegree;  // to the u axis, 0 ... 90
  return onVertical ? 90.0 - lean : lean;
}

/// Draws lines of all directions that end away from corners and at no small angle to the border.
struct Across {
  Vec2 from, to;
};

std::vector<Across> linesAcross(const Vec2& size, double cell, int perAngle, Generator& random) {
  std::vector<Across> lines;
  for (int degrees = 0; degrees < 360; degrees += 7) {
    for (int k = 0; k < perAngle; ++k) {
      const double v = uniform(random, 0.1, 0.9);
      const Vec2 p(uniform(random, 0.1, 0.9) * size.x(), v * size.y());
      const auto [from, to] = chordOf(size, p, degrees * kDegree);
      const double corner = std::min(cornerDistance(size, from), cornerDistance(size, to));
      const double flat = std::min(angleToBorder(size, from, degrees * kDegree),
                                   angleToBorder(size, to, degrees * kDegree));
      if (corner > 0.5 * cell && flat > 20.0) lines.push_back({from, to});
    }
  }
  return lines;
}

TEST(EmbedPath, StraightAcrossAGridGivesTwoPiecesOfTheRightAreas) {
  Generator random(1);
  const Vec2 size(1.0, 0.8);
  for (const Across& line : linesAcross(size, 0.1, 12, random)) {
    TriangleMesh mesh = makeGridMesh({11, 9, size.x(), size.y()});
    const double area = testing_support::preciseArea(mesh);
    Remesher remesher(mesh, {}, {});
    const EmbeddedPath done = embed(pathAlong(mesh, {line.from, line.to}), remesher);
    EXPECT_LT(done.deviation, 1e-13);
    EXPECT_NEAR(done.length, (line.to - line.from).norm(), 1e-12);
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
    remesher.improveAngles();
    EXPECT_TRUE(isMarkedPolyline(remesher, done.vertices));
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
    remesher.openMarkedEdges();
    remesher.finish();
    expectSound(mesh, area);
    std::vector<double> areas = pieceAreas(mesh);
    ASSERT_EQ(areas.size(), 2U) << line.from.transpose() << " to " << line.to.transpose();
    std::sort(areas.begin(), areas.end());
    const double left = areaLeftOf(size, line.from, line.to);
    EXPECT_NEAR(areas[0], std::min(left, 0.8 - left), 1e-12)
        << line.from.transpose() << " to " << line.to.transpose();
  }
}

struct AlongTheMesh {
  const char* name;
  Polyline line;
  std::vector<VertexId> vertices;
};

class EmbedAlongTheMesh : public testing::TestWithParam<AlongTheMesh> {};

TEST_P(EmbedAlongTheMesh, MakesNoVertexWhereThereAreSome) {
  TriangleMesh mesh = makeGridMesh({5, 5, 4.0, 4.0});
  Remesher remesher(mesh, {}, {});
  const EmbeddedPath done = embed(pathAlong(mesh, GetParam().line), remesher);
  EXPECT_EQ(done.vertices, GetParam().vertices);
  EXPECT_EQ(done.deviation, 0.0);
  EXPECT_EQ(mesh.vertexCount(), 25);
  EXPECT_EQ(mesh.material(), makeGridMesh({5, 5, 4.0, 4.0}).material());
  remesher.openMarkedEdges();
  remesher.finish();
  expectSound(mesh, 16.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, EmbedAlongTheMesh,
    testing::Values(AlongTheMesh{"AlongEdges", {{0, 2}, {4, 2}}, {10, 11, 12, 13, 14}},
                    AlongTheMesh{"UpAColumn", {{1, 0}, {1, 4}}, {1, 6, 11, 16, 21}},
                    AlongTheMesh{"AlongDiagonals", {{1, 0}, {4, 3}}, {1, 7, 13, 19}},
                    AlongTheMesh{"FromCornerToCorner", {{0, 0}, {4, 4}}, {0, 6, 12, 18, 24}},
                    AlongTheMesh{"BetweenInnerVertices", {{1, 1}, {3, 1}}, {6, 7, 8}},
                    AlongTheMesh{"RoundACorner", {{0, 2}, {2, 2}, {2, 4}}, {10, 11, 12, 17, 22}},
                    AlongTheMesh{"OneEdge", {{1, 1}, {2, 2}}, {6, 12}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(EmbedPath, GoesThroughAVertexThatLiesOnIt) {
  // From (0, 0.5) through 12 at (2, 2), with a slope of 3/4.
  TriangleMesh mesh = makeGridMesh({5, 5, 4.0, 4.0});
  Remesher remesher(mesh, {}, {});
  const EmbeddedPath done = embed(pathAlong(mesh, {{0.0, 0.5}, {4.0, 3.5}}), remesher);
  EXPECT_THAT(done.vertices, testing::Contains(12));
  EXPECT_EQ(mesh.material(12), Vec2(2.0, 2.0));
  EXPECT_LT(done.deviation, 1e-14);
  remesher.openMarkedEdges();
  remesher.finish();
  EXPECT_THAT(pieceAreas(mesh),
              ElementsAre(testing::DoubleNear(8.0, 1e-12), testing::DoubleNear(8.0, 1e-12)));
}

// ---- ends inside --------------------------------------------------------------------------------

TEST(EmbedPath, EndsAtExactlyItsLastPoint) {
  Generator random(2);
  for (int trial = 0; trial < 200; ++trial) {
    TriangleMesh mesh = makeGridMesh({9, 9, 1.0, 1.0});
    const Vec2 to(uniform(random, 0.3, 0.7), uniform(random, 0.3, 0.7));
    const Vec2 from(uniform(random, 0.1, 0.9), 0.0);
    Remesher remesher(mesh, {}, {});
    const EmbeddedPath done = embed(pathAlong(mesh, {from, to}), remesher);
    EXPECT_LT((mesh.material(done.vertices.back()) - to).norm(), 1e-14);
    EXPECT_LT((mesh.material(done.vertices.front()) - from).norm(), 1e-14);
    EXPECT_LT(done.deviation, 0.5 * std::sqrt(2.0) / 8.0);
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
    remesher.openMarkedEdges();
    remesher.finish();
    expectSound(mesh, 1.0);
    EXPECT_EQ(connectedComponents(mesh).count, 1);
  }
}

TEST(EmbedPath, EndsNearItsLastPointWhereNothingMoves) {
  Generator random(2);
  int exact = 0;
  constexpr int kTrials = 200;
  constexpr double kCell = 1.0 / 8.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    TriangleMesh mesh = makeGridMesh({9, 9, 1.0, 1.0});
    const std::vector<Vec2> before = mesh.material();
    const Vec2 to(uniform(random, 0.3, 0.7), uniform(random, 0.3, 0.7));
    ShapeLimits limits;
    limits.keepsSurface = true;
    Remesher remesher(mesh, limits, {});
    const EmbeddedPath done = embed(pathAlong(mesh, {{0.5 * kCell, 0.0}, to}), remesher);
    const double off = (mesh.material(done.vertices.back()) - to).norm();
    if (off < 1e-14) ++exact;
    EXPECT_LT(off, 0.5 * std::sqrt(2.0) * kCell) << to.transpose();
    EXPECT_TRUE(std::equal(before.begin(), before.end(), mesh.material().begin()));
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
  }
  EXPECT_GT(exact, kTrials / 2) << "the rest would leave slivers";
}

TEST(EmbedPath, EndsAtTheLastCrossingIfAsked) {
  TriangleMesh mesh = makeGridMesh({9, 9, 8.0, 8.0});
  Remesher remesher(mesh, {}, {});
  // In cell (4, 3) the diagonal is the last edge before (4.8, 3.4): crossed at y - 3 = x - 4.
  const Vec2 from(4.0, 0.0);
  const Vec2 to(4.8, 3.4);
  const EmbeddedPath done = embed(pathAlong(mesh, {from, to}), remesher, PathEnd::kLastCross);
  const Vec2& end = mesh.material(done.vertices.back());
  EXPECT_LT(std::abs(doubleArea(from, to, end)), 1e-13);
  EXPECT_LT(end.y(), 3.4 - 1e-3);
  EXPECT_GT(end.y(), 2.9);
}

TEST(EmbedPath, OfTwoPointsInOneFace) {
  Generator random(3);
  int exact = 0;
  for (int trial = 0; trial < 200; ++trial) {
    TriangleMesh mesh = makeGridMesh({5, 5, 4.0, 4.0});
    const FaceId f = whole(random, 0, mesh.faceCount() - 1);
    const Vec2 from = pointIn(mesh, f, randomWeights(random, 0.05));
    const Vec2 to = pointIn(mesh, f, randomWeights(random, 0.05));
    if ((to - from).norm() < 0.2) continue;
    Remesher remesher(mesh, {}, {});
    const EmbeddedPath done = embed(pathAlong(mesh, {from, to}), remesher);
    EXPECT_GE(done.vertices.size(), 2U) << "from " << from.transpose() << " to " << to.transpose();
    EXPECT_LT(done.deviation, 0.5 * std::sqrt(2.0));
    if (done.deviation < 1e-14) {
      ++exact;
      EXPECT_LT((mesh.material(done.vertices.front()) - from).norm(), 1e-14);
      EXPECT_LT((mesh.material(done.vertices.back()) - to).norm(), 1e-14);
      EXPECT_NEAR(done.length, (to - from).norm(), 1e-12);
    }
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
    remesher.openMarkedEdges();
    remesher.finish();
    expectSound(mesh, 16.0);
    EXPECT_EQ(connectedComponents(mesh).count, 1);
  }
  EXPECT_GT(exact, 90) << "most need not bend";
}

TEST(EmbedPath, InsideAFaceWithRoomIsExact) {
  TriangleMesh mesh = makeGridMesh({5, 5, 4.0, 4.0});
  Remesher remesher(mesh, {}, {});
  const Vec2 from(1.45, 1.2);
  const Vec2 to(1.8, 1.5);
  const EmbeddedPath done = embed(pathAlong(mesh, {from, to}), remesher);
  EXPECT_LT(done.deviation, 1e-14);
  EXPECT_LT((mesh.material(done.vertices.front()) - from).norm(), 1e-14);
  EXPECT_LT((mesh.material(done.vertices.back()) - to).norm(), 1e-14);
  EXPECT_NEAR(done.length, (to - from).norm(), 1e-13);
}

TEST(EmbedPath, KeepsTheAreaIfAnEndIsJustBesideTheBorder) {
  // Distances that rounding may leave between point and edge, and larger ones.
  for (double beside : {1e-16, 1e-13, 1e-12, 1e-11, 9e-11}) {
    for (double sign : {-1.0, 1.0}) {
      TriangleMesh mesh = makeGridMesh({11, 11, 1.0, 1.0});
      SurfacePath path = pathAlong(mesh, {{0.43, 0.0}, {0.5, 0.5}});
      path.points.front().material.y() = sign * beside;
      Remesher remesher(mesh, {}, {});
      embed(path, remesher);
      EXPECT_NEAR(preciseArea(mesh), 1.0, 1e-14) << sign * beside;
      EXPECT_NEAR(rimLength(mesh), 4.0, 1e-13) << sign * beside;
    }
  }
}

// ---- closed -------------------------------------------------------------------------------------

TEST(EmbedPath, AClosedOneFreesADisc) {
  Generator random(4);
  for (int trial = 0; trial < 20; ++trial) {
    TriangleMesh mesh = makeGridMesh({21, 21, 1.0, 1.0});
    const double area = testing_support::preciseArea(mesh);
    const Vec2 centre(uniform(random, 0.4, 0.6), uniform(random, 0.4, 0.6));
    const double radius = uniform(random, 0.33, 0.38);
    const int n = 64;
    Polyline circle;
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * M_PI * (k + 0.3) / n;
      circle.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    circle.push_back(circle.front());
    const SurfacePath path = pathAlong(mesh, circle);
    ASSERT_TRUE(path.isClosed());
    Remesher remesher(mesh, {}, {});
    const EmbeddedPath done = embed(path, remesher);
    EXPECT_EQ(done.vertices.front(), done.vertices.back());
    remesher.improveAngles();
    remesher.openMarkedEdges();
    remesher.finish();
    expectSound(mesh, area);
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
    std::vector<double> areas = pieceAreas(mesh);
    ASSERT_EQ(areas.size(), 2U);
    std::sort(areas.begin(), areas.end());
    // Between vertices it is straight: chords of c take pi c^2 / 6 off a circle, 0.3 % for edges of
    // c = 0.05.
    const double disc = 0.5 * n * radius * radius * std::sin(2.0 * M_PI / n);
    EXPECT_NEAR(areas[0], disc, 0.005 * disc);
  }
}

// ---- several ------------------------------------------------------------------------------------

TEST(EmbedPath, ACrossOfTwoGivesFourPieces) {
  Generator random(5);
  const Vec2 size(1.0, 1.0);
  int crossings = 0;
  for (int trial = 0; trial < 150; ++trial) {
    TriangleMesh mesh = makeGridMesh({13, 13, 1.0, 1.0});
    const double area = testing_support::preciseArea(mesh);
    const Vec2 middle(uniform(random, 0.35, 0.65), uniform(random, 0.35, 0.65));
    const double first = uniform(random, 20.0, 70.0) * kDegree;
    const double second = first + uniform(random, 40.0, 140.0) * kDegree;
    const auto [a, b] = chordOf(size, middle, first);
    const auto [c, d] = chordOf(size, middle, second);
    if (std::min(angleToBorder(size, c, second), angleToBorder(size, d, second)) < 15.0) continue;
    double corner = 1.0;
    for (const Vec2& end : {a, b, c, d}) corner = std::min(corner, cornerDistance(size, end));
    if (corner < 1.0 / 24.0) continue;
    ++crossings;
    // At once; every other time after the first has been opened.
    const bool oneByOne = trial % 2 == 1;
    Remesher remesher(mesh, {}, {});
    double bent = embed(pathAlong(mesh, {a, b}), remesher).deviation;
    remesher.improveAngles();
    if (oneByOne) {
      remesher.openMarkedEdges();
      remesher.finish();
    }
    const std::vector<SurfacePath> paths = pathsAlong(mesh, {c, d});
    EXPECT_EQ(paths.size(), oneByOne ? 2U : 1U);
    for (const SurfacePath& path : paths) {
      bent = std::max(bent, embed(path, remesher).deviation);
    }
    remesher.openMarkedEdges();
    remesher.finish();
    expectSound(mesh, area);
    EXPECT_GE(smallestAngle(mesh), kLeastAngle - 1e-9);
    EXPECT_LT(bent, 0.5 * std::sqrt(2.0) / 12.0);
    std::vector<double> areas = pieceAreas(mesh);
    ASSERT_EQ(areas.size(), 4U) << "trial " << trial;
    // Two neighbours make what is on one side of the first line, bent by no more than that.
    const double side = areaLeftOf(size, a, b);
    double nearest = 1.0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        nearest = std::min(nearest, std::abs(areas[i] + areas[j] - side));
      }
    }
    EXPECT_LE(nearest, 1e-12 + 2.0 * bent * 1.5) << "trial " << trial;
  }
  EXPECT_GT(crossings, 50);
}

// ---- deviation ----------------------------------------------------------------------------------

/// A line across a grid that passes a held vertex at a fraction of the side of a cell.
TEST(EmbedPath, BendsToAHeldVertexBySnapAndRarelyByUpToHalfAnEdge) {
  Generator random(6);
  const double h = 0.1;
  const Vec2 size(1.0, 1.0);
  int bent = 0;
  int lines = 0;
  int bentFarther = 0;
  for (double snap : {0.05, 0.2, 0.45}) {
    for (int trial = 0; trial < 150; ++trial) {
      const Grid grid{11, 11, 1.0, 1.0};
      TriangleMesh mesh = makeGridMesh(grid);
      // One number a statement: compilers differ in the order in which they take arguments.
      const int row = whole(random, 3, 7);
      const VertexId held = grid.vertex(whole(random, 3, 7), row);
      const double above = uniform(random, -0.3, 0.3) * h;
      const Vec2 off(uniform(random, -0.3, 0.3) * h, above);
      const double quarter = whole(random, 0, 1) * M_PI / 2;
      const double angle = uniform(random, 20.0, 70.0) * kDegree + quarter;
      const auto [from, to] = chordOf(size, mesh.material(held) + off, angle);
      if (std::min(cornerDistance(size, from), cornerDistance(size, to)) < 0.5 * h) continue;
      ShapeLimits limits;
      limits.snap = snap;
      Remesher remesher(mesh, limits, {held});
      const Vec2 before = mesh.material(held);
      const EmbeddedPath done = embed(pathAlong(mesh, {from, to}), remesher);
      EXPECT_EQ(mesh.material(held), before);
      const double edge = std::sqrt(2.0) * h;
      EXPECT_LE(done.deviation, 0.5 * edge) << "snap " << snap << ", trial " << trial;
      ++lines;
      bent += done.deviation > 1e-12 ? 1 : 0;
      // Under about a sixth of an edge, splitting beside the vertex would make slivers, whatever
      // snap says.
      bentFarther += done.deviation > std::max(snap, 0.18) * edge + 1e-12 ? 1 : 0;
    }
  }
  EXPECT_GT(bent, 10);
  EXPECT_LT(bentFarther, lines / 50);
}

/// Draws a polyline within the unit square.
Polyline randomStroke(Generator& random) {
  Polyline line;
  for (int k = whole(random, 2, 4); k > 0; --k) {
    line.emplace_back(uniform(random, -0.1, 1.1), uniform(random, -0.1, 1.1));
  }
  return line;
}

/// The faces of a mesh by the coordinates of their corners.
std::set<std::array<double, 6>> facesByPlace(const TriangleMesh& mesh) {
  std::set<std::array<double, 6>> faces;
  for (const Face& face : mesh.faces()) {
    std::array<std::array<double, 2>, 3> corner;
    for (int k = 0; k < 3; ++k)
      corner[k] = {mesh.material(face[k]).x(), mesh.material(face[k]).y()};
    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
    faces.insert(
        {corner[0][0], corner[0][1], corner[1][0], corner[1][1], corner[2][0], corner[2][1]});
  }
  return faces;
}

double longestEdgeOf(const TriangleMesh& mesh) {
  double longest = 0.0;
  for (const Face& face : mesh.faces()) {
    for (int k = 0; k < 3; ++k) {
      longest =
          std::max(longest, (mesh.material(face[(k + 1) % 3]) - mesh.material(face[k])).norm());
    }
  }
  return longest;
}

void expectWithinLimits(const TriangleMesh& mesh, const TriangleMesh& original,
                        const ShapeLimits& limits) {
  EXPECT_GE(shortestEdge(mesh), limits.minEdge * (1.0 - 1e-9));
  const auto known = facesByPlace(original);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (minAngle(mesh, f) >= limits.minAngle - 1e-9) continue;
    std::vector<Vec2> material;
    for (VertexId v : mesh.face(f)) material.push_back(mesh.material(v));
    const auto own = facesByPlace(TriangleMesh(material, {{0, 1, 2}}));
    EXPECT_EQ(known.count(*own.begin()), 1U)
        << minAngle(mesh, f) / kDegree << " degrees at face " << f;
  }
}

/// Several strokes in sequence, each in one edit or in two.
void strokeAtRandom(Generator& random, bool irregular) {
  const Grid grid{whole(random, 4, 12), whole(random, 4, 12), 1.0, uniform(random, 0.7, 1.2)};
  TriangleMesh mesh = irregular ? irregularMesh(grid, 0.2, random) : makeGridMesh(grid);
  const TriangleMesh original = mesh;
  const double area = preciseArea(mesh);
  const double rim = rimLength(mesh);
  ShapeLimits limits;
  limits.minEdge = 0.1 * shortestEdge(mesh);
  limits.snap = uniform(random, 0.05, 0.45);
  std::vector<VertexId> held;
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    if (whole(random, 0, 9) == 0) held.push_back(v);
  }
  for (int stroke = whole(random, 2, 5); stroke > 0; --stroke) {
    Remesher remesher(mesh, limits, held);
    for (const SurfacePath& path : pathsAlong(mesh, randomStroke(random))) {
      const PathEnd end = random() % 2 == 0 ? PathEnd::kExact : PathEnd::kLastCross;
      const double longest = longestEdgeOf(mesh);
      EXPECT_LE(embed(path, remesher, end).deviation, 0.5 * longest + 1e-12);
    }
    expectWithinLimits(mesh, original, limits);
    remesher.improveAngles();
    remesher.openMarkedEdges();
    remesher.finish();
    expectWithinLimits(mesh, original, limits);
  }
  expectSound(mesh, area);
  EXPECT_NEAR(rimLength(mesh), rim, 1e-13 * rim);
}

TEST(EmbedPath, ManyStrokesKeepTheLimits) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Generator random(100 + seed);
    strokeAtRandom(random, seed % 2 == 1);
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
}

// ---- finding faces ------------------------------------------------------------------------------

TEST(Locate, FindsTheFaceFromNearby) {
  Generator random(7);
  const TriangleMesh mesh = irregularMesh({9, 9, 1.0, 1.0}, 0.25, random);
  for (int trial = 0; trial < 300; ++trial) {
    const FaceId f = whole(random, 0, mesh.faceCount() - 1);
    const Vec2 p = pointIn(mesh, f, randomWeights(random, 0.01));
    EXPECT_EQ(locate(mesh, {f, p}), f);
    const FaceId start = whole(random, 0, mesh.faceCount() - 1);
    EXPECT_EQ(locate(mesh, {start, p}), f) << "128 faces are not too many to search";
  }
}

TEST(Locate, GivesTheNearestOneForAPointOutside) {
  const TriangleMesh mesh = makeGridMesh({3, 3, 2.0, 2.0});
  EXPECT_EQ(locate(mesh, {5, Vec2(0.6, -1e-6)}), 0);
  EXPECT_EQ(locate(mesh, {0, Vec2(2.0 + 1e-6, 1.5)}), 6);
}

TEST(Locate, DoesNotGoOverWhatHasComeApart) {
  TriangleMesh mesh = makeGridMesh({3, 3, 2.0, 2.0});
  MeshEditor editor(mesh);
  ASSERT_TRUE(editor.splitVertex(4, {3, 6, 7}));
  editor.finish();
  ASSERT_EQ(connectedComponents(mesh).count, 2);
  const FaceId found = locate(mesh, {0, Vec2(1.5, 0.2)});
  EXPECT_THAT((std::vector<FaceId>{0, 1, 4, 5}), testing::Contains(found));
}

}  // namespace
}  // namespace cloth_sim
