#include "sharp_features.h"

#include <cmath>
#include <utility>

namespace cloth_sim {
namespace {

using Edge = TriangleSurface::Edge;

/// Unit vector in a triangle, away from an edge of it and normal to it.
Vec3 acrossFrom(const TriangleSurface& surface, const Edge& edge) {
  const std::vector<Vec3>& x = surface.vertices();
  const Vec3 along = (x[edge.high] - x[edge.low]).normalized();
  Vec3 across = Vec3::Zero();
  for (const std::int32_t v : surface.triangles()[edge.triangle]) {
    if (v != edge.low && v != edge.high) across = x[v] - x[edge.low];
  }
  return (across - across.dot(along) * along).normalized();
}

/// Tells whether the surface turns sharply at an edge, outwards if it is closed, or ends there.
/// \param first, last  the sides along the edge.
bool isSharp(const TriangleSurface& surface, const Edge* first, const Edge* last) {
  if (last - first != 2) return true;
  const Vec3 a = acrossFrom(surface, first[0]);
  const Vec3 b = acrossFrom(surface, first[1]);
  if (a.dot(b) <= -std::cos(SharpFeatures::kSharp)) return false;  // nearly flat
  return !surface.isClosed() || b.dot(surface.normal(first->triangle)) < 0.0;
}

/// Marks the vertices of a closed surface at which a triangle is turned sharply against the sum of
/// the normals around it: tips of cones, too.
void markTips(const TriangleSurface& surface, std::vector<bool>& isCorner) {
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const Vec3& normal = surface.normal(static_cast<std::int32_t>(t));
    for (const std::int32_t v : surface.triangles()[t]) {
      const Vec3& sum = surface.vertexNormal(v);
      if (sum.dot(normal) < std::cos(SharpFeatures::kSharp) * sum.norm()) isCorner[v] = true;
    }
  }
}

}  // namespace

SharpFeatures::SharpFeatures(const TriangleSurface& surface) {
  const std::vector<Vec3>& x = surface.vertices();
  std::vector<bool> isCorner(x.size(), false);
  if (surface.isClosed()) markTips(surface, isCorner);
  surface.forEachEdge([&](const Edge* first, const Edge* last) {
    if (!isSharp(surface, first, last)) return;
    SharpFeature feature;
    feature.ends = {x[first->low], x[first->high]};
    if (surface.isClosed()) {
      for (const Edge* it = first; it != last; ++it)
        feature.outwards += surface.normal(it->triangle);
    }
    features_.push_back(feature);
    isCorner[first->low] = isCorner[first->high] = true;
  });
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (!isCorner[v]) continue;
    const Vec3 outwards = surface.isClosed() ? surface.vertexNormal(static_cast<std::int32_t>(v))
                                             : Vec3(Vec3::Zero());
    features_.push_back({{x[v], x[v]}, true, outwards});
  }
  if (!features_.empty()) sort();
}

/// Builds the hierarchy, and brings the features into the order of its leaves.
void SharpFeatures::sort() {
  std::vector<BoxedItem> items;
  for (const SharpFeature& feature : features_) {
    const auto& [a, b] = feature.ends;
    items.push_back({a.cwiseMin(b), a.cwiseMax(b), a + b});
  }
  std::vector<std::int32_t> order;
  nodes_ = buildBoxTree(items, order);
  std::vector<SharpFeature> sorted;
  for (const std::int32_t k : order) sorted.push_back(features_[k]);
  features_ = std::move(sorted);
}

bool SharpFeatures::meetsBox(std::int32_t feature, const Vec3& low, const Vec3& high) const {
  const auto& [a, b] = features_[feature].ends;
  return boxesMeet(a.cwiseMin(b), a.cwiseMax(b), low, high);
}

bool SharpFeatures::areIn(const Vec3& low, const Vec3& high) const {
  bool isFound = false;
  const auto isNear = [&](const BoxNode& node) {
    return !isFound && boxesMeet(node.low, node.high, low, high);
  };
  if (!empty()) {
    visitLeaves(nodes_, isNear,
                [&](std::int32_t feature) { isFound = isFound || meetsBox(feature, low, high); });
  }
  return isFound;
}

void SharpFeatures::find(const Vec3& low, const Vec3& high, std::vector<std::int32_t>& out) const {
  out.clear();
  if (empty()) return;
  const auto isNear = [&](const BoxNode& node) {
    return boxesMeet(node.low, node.high, low, high);
  };
  visitLeaves(nodes_, isNear, [&](std::int32_t feature) {
    if (meetsBox(feature, low, high)) out.push_back(feature);
  });
}

}  // namespace cloth_sim
