/// \file Zones of vertices that move alike, and tangles of faces that nothing else keeps apart.

#include "contact/impact_zones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "contact/face_pairs.h"
#include "layer_support.h"

namespace cloth_sim {
namespace {

/// Faces in a pile along z, each with three vertices of its own, that are pressed together.
struct PressedPile {
  std::vector<Face> faces;
  std::vector<FaceIds> pairs;
  std::vector<Vec3> start, end;
  std::vector<double> mass;
  std::vector<VertexId> all;
  std::vector<std::uint8_t> truncated, stopped;

  /// \param count   number of faces.
  /// \param common  motion that they have in common [m].
  PressedPile(int count, const Vec3& common) {
    for (int f = 0; f < count; ++f) {
      const double inwards = f == 0 ? 0.1 : f == count - 1 ? -0.1 : 0.0;
      for (int k = 0; k < 3; ++k) {
        const double angle = 2.1 * k + 0.3 * f;
        start.emplace_back(std::cos(angle), std::sin(angle), 1e-3 * f);
        end.push_back(start.back() + common + Vec3(0.0, 0.0, inwards));
        mass.push_back(inwards == 0.0 ? 1.0 : 1e3);
      }
      faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
      if (f > 0) pairs.push_back({f - 1, f});
    }
    all.resize(start.size());
    std::iota(all.begin(), all.end(), 0);
    truncated.resize(start.size(), 0);
    stopped.resize(start.size(), 0);
  }

  Truncation now() { return {{start, end, mass, all}, truncated, stopped}; }
  PairOutcome keepApart() {
    FacePairs certificate;
    certificate.assign(pairs, faces, 1e-5);
    return certificate.keepApart(now());
  }
  /// Sum of masses and motions [kg m].
  Vec3 moment() const {
    Vec3 sum = Vec3::Zero();
    for (const VertexId v : all) sum += mass[v] * (end[v] - start[v]);
    return sum;
  }
  bool doFacesMeet() const {
    std::vector<Vec3> x(start.size());
    for (int part = 0; part <= 16; ++part) {
      const double t = part / 16.0;
      for (const VertexId v : all) x[v] = (1.0 - t) * start[v] + t * end[v];
      for (const FaceIds& pair : pairs) {
        if (meet(faces[pair.first], faces[pair.second], x)) return true;
      }
    }
    return false;
  }
};

/// Heavy faces press light ones together so hard that sliding does not part them in the passes that
/// it has. Motion that is shortened towards its start would leave the pile where it is, for ever.
TEST(ImpactZones, APileThatIsPressedFliesOnWithItsMomentum) {
  const Vec3 common(0.3, 0.0, -0.2);
  PressedPile pile(12, common);
  const Vec3 before = pile.moment();
  const PairOutcome outcome = pile.keepApart();
  EXPECT_TRUE(outcome.changed);
  EXPECT_EQ(outcome.unproven, 0);
  EXPECT_FALSE(pile.doFacesMeet());
  EXPECT_LT((pile.moment() - before).norm(), 1e-12 * before.norm());
  for (const VertexId v : pile.all) {
    EXPECT_NEAR(pile.end[v].x() - pile.start[v].x(), common.x(), 1e-9) << v;
  }
}

TEST(ImpactZones, APileOnSomethingThatStopsItStaysThere) {
  PressedPile pile(12, Vec3(0.0, 0.0, -0.2));
  for (int v = 0; v < 3; ++v) {
    pile.end[v] = pile.start[v];
    pile.stopped[v] = 1;
    pile.mass[v] = 0.0;
  }
  EXPECT_TRUE(pile.keepApart().changed);
  EXPECT_FALSE(pile.doFacesMeet());
  for (const VertexId v : pile.all) EXPECT_GT(pile.end[v].z(), -1e-3) << v;
}

TEST(ImpactZones, ZonesThatAreJoinedKeepTheirPlacesToEachOtherAndTheirMomentum) {
  PressedPile pile(3, Vec3::Zero());
  pile.mass.assign(9, 1.0);
  for (int v = 0; v < 9; ++v) pile.end[v] = pile.start[v] + Vec3(v < 6 ? 0.1 : 0.4, 0.0, 0.0);
  const std::vector<Vec3> wanted = pile.end;
  const Truncation now = pile.now();
  ImpactZones zones;
  zones.begin(9);
  EXPECT_NEAR(zones.join({pile.faces[0], pile.faces[1]}, now).x(), 0.1, 1e-15);
  EXPECT_EQ(pile.end, wanted) << "vertices that were alone move as before";
  // The zone of the first two faces moves on with 0.2; the vertices of the third were alone.
  EXPECT_NEAR(zones.join({pile.faces[1], pile.faces[2]}, now).x(), 0.2, 1e-15);
  for (int v = 0; v < 9; ++v) {
    EXPECT_NEAR(pile.end[v].x() - pile.start[v].x(), v < 6 ? 0.2 : 0.4, 1e-15) << v;
    EXPECT_EQ(pile.truncated[v], v < 6 ? 1 : 0) << v;
  }
  zones.restoreMomentum(now);
  EXPECT_NEAR(pile.moment().x(), 6 * 0.1 + 3 * 0.4, 1e-14);
}

TEST(ImpactZones, AZoneWithAStoppedVertexMovesNowhere) {
  PressedPile pile(2, Vec3(0.1, 0.0, 0.0));
  pile.stopped[4] = 1;
  ImpactZones zones;
  zones.begin(6);
  const std::vector<Vec3> wanted = pile.end;
  EXPECT_EQ(zones.join({pile.faces[0], pile.faces[1]}, pile.now()), Vec3::Zero());
  zones.restoreMomentum(pile.now());
  EXPECT_EQ(pile.end, wanted);
}

}  // namespace
}  // namespace cloth_sim
