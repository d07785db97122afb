#include "feature_search.h"

#include <algorithm>

namespace cloth_sim {
namespace {

constexpr FaceId kFaceBlock = 64;  // faces that are searched for together

/// Finds the pairs of one mesh and one cloth.
class PairSearch {
 public:
  PairSearch(const PlacedFeatures& placed, const TriangleMesh& mesh, const State& state,
             const FeatureSearch& search, std::vector<std::int32_t>& scratch,
             std::vector<FeaturePair>& out)
      : placed_(placed), mesh_(mesh), state_(state), search_(search), found_(scratch), out_(out) {}

  void run() {
    for (FaceId first = 0; first < mesh_.faceCount(); first += kFaceBlock) {
      const FaceId last = std::min(first + kFaceBlock, mesh_.faceCount());
      if (!mayMeet(first, last)) continue;
      for (FaceId f = first; f < last; ++f) search(mesh_.face(f));
    }
  }

 private:
  /// Distance that a particle may move relative to the mesh [m].
  double pathOf(VertexId v) const {
    const double path = search_.dt * (state_.v[v] - search_.velocity).norm();
    return path + search_.turn * ((state_.x[v] - placed_.position).norm() + path);
  }
  Vec3 localOf(VertexId v) const {
    return placed_.rotation.transpose() * (state_.x[v] - placed_.position);
  }

  /// Tells whether a feature may be met by a block of faces, whose box is turned as a whole.
  bool mayMeet(FaceId first, FaceId last) const {
    PointBox world;
    double path = 0.0;
    for (FaceId f = first; f < last; ++f) {
      for (const VertexId v : mesh_.face(f)) {
        world.add(state_.x[v]);
        path = std::max(path, pathOf(v));
      }
    }
    const Vec3 centre =
        placed_.rotation.transpose() * (0.5 * (world.low + world.high) - placed_.position);
    const Vec3 half = placed_.rotation.transpose().cwiseAbs() * (0.5 * (world.high - world.low)) +
                      Vec3::Constant(path + search_.reach);
    return placed_.features.areIn(centre - half, centre + half);
  }

  void search(const Face& face) {
    PointBox box;
    double path = 0.0;
    for (const VertexId v : face) {
      box.add(localOf(v));
      path = std::max(path, pathOf(v));
    }
    const Vec3 room = Vec3::Constant(path + search_.reach);
    placed_.features.find(box.low - room, box.high + room, found_);
    for (const std::int32_t feature : found_) {
      if (placed_.features[feature].isCorner) {
        add({feature, {face[0], face[1], face[2]}});
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        const VertexId a = face[k];
        const VertexId b = face[(k + 1) % 3];
        // An edge between two faces runs up in one of them.
        if (a > b && mesh_.facesOnEdge(a, b)[1] != kNone) continue;
        add({feature, {a, b, kNone}});
      }
    }
  }

  void add(FeaturePair pair) {
    pair.isPierced = placed_.surface.isClosed() && isPierced(pair);
    out_.push_back(pair);
  }

  /// Tells whether the point of the cloth that is opposite to the feature is inside of the mesh.
  bool isPierced(const FeaturePair& pair) const {
    return visitFeature(placed_, pair.feature, [&](const auto& meeting) {
      MeetingPoints x{};
      for (int k = 0; k < meeting.kPoints; ++k) x[k] = state_.x[pair.cloth[k]];
      Vec3 normal;
      MeetingWeights weight;
      if (!meeting.normal(x, normal) || !meeting.weigh(x, normal, weight)) return false;
      Vec3 point = Vec3::Zero();
      for (int k = 0; k < meeting.kPoints; ++k) point += weight[k] * x[k];
      return placed_.surface.distance(placed_.rotation.transpose() * (point - placed_.position)) <
             0.0;
    });
  }

  const PlacedFeatures& placed_;
  const TriangleMesh& mesh_;
  const State& state_;
  const FeatureSearch& search_;
  std::vector<std::int32_t>& found_;
  std::vector<FeaturePair>& out_;
};

}  // namespace

void collectPairs(const PlacedFeatures& placed, const TriangleMesh& mesh, const State& state,
                  const FeatureSearch& search, std::vector<std::int32_t>& scratch,
                  std::vector<FeaturePair>& out) {
  PairSearch(placed, mesh, state, search, scratch, out).run();
}

}  // namespace cloth_sim
