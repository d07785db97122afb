#include "sharp_features.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "closest_points.h"

namespace cloth_sim {
namespace {

constexpr std::int32_t kFeaturesOfLeaf = 4;
constexpr std::size_t kDeepestFeature = 64;

/// An edge of a triangle.
struct Edge {
  std::int32_t first = 0;   ///< the smaller one of its vertices
  std::int32_t second = 0;  ///< the larger one
  std::size_t triangle = 0;

  bool isSame(const Edge& other) const { return first == other.first && second == other.second; }
  bool operator<(const Edge& other) const {
    return std::tie(first, second, triangle) < std::tie(other.first, other.second, other.triangle);
  }
};

/// The triangles around each edge, and the normals of all triangles.
class Surroundings {
 public:
  explicit Surroundings(const TriangleSurface& surface) : surface_(surface) {
    const std::vector<TriangleSurface::Triangle>& all = surface.triangles();
    for (std::size_t t = 0; t < all.size(); ++t) {
      const std::array<Vec3, 3> x = corners(t);
      normals_.push_back((x[1] - x[0]).cross(x[2] - x[0]).normalized());
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [first, second] = std::minmax(all[t][k], all[t][(k + 1) % 3]);
        edges_.push_back({first, second, t});
      }
    }
    std::sort(edges_.begin(), edges_.end());
  }

  /// Calls `function(first, last)` with the edges of all triangles around each edge.
  template <class Function>
  void forEachEdge(Function&& function) const {
    for (auto first = edges_.begin(); first != edges_.end();) {
      const auto last = std::find_if_not(first, edges_.end(),
                                         [&](const Edge& edge) { return edge.isSame(*first); });
      function(first, last);
      first = last;
    }
  }

  const Vec3& normal(std::size_t triangle) const { return normals_[triangle]; }

  /// Tells whether the surface turns sharply at an edge, outwards if it is closed, or ends there.
  template <class Iterator>
  bool isSharp(Iterator first, Iterator last) const {
    if (last - first != 2) return true;
    const Vec3 a = acrossFrom(*first);
    const Vec3 b = acrossFrom(*(first + 1));
    if (a.dot(b) <= -std::cos(SharpFeatures::kSharp)) return false;  // nearly flat
    return !surface_.isClosed() || b.dot(normals_[first->triangle]) < 0.0;
  }

 private:
  std::array<Vec3, 3> corners(std::size_t t) const {
    const TriangleSurface::Triangle& c = surface_.triangles()[t];
    const std::vector<Vec3>& x = surface_.vertices();
    return {x[c[0]], x[c[1]], x[c[2]]};
  }

  /// Unit vector in a triangle, away from an edge of it and normal to it.
  Vec3 acrossFrom(const Edge& edge) const {
    const std::vector<Vec3>& x = surface_.vertices();
    const Vec3 along = (x[edge.second] - x[edge.first]).normalized();
    Vec3 across = Vec3::Zero();
    for (const std::int32_t v : surface_.triangles()[edge.triangle]) {
      if (v != edge.first && v != edge.second) across = x[v] - x[edge.first];
    }
    return (across - across.dot(along) * along).normalized();
  }

  const TriangleSurface& surface_;
  std::vector<Vec3> normals_;  // by triangle
  std::vector<Edge> edges_;    // those of an edge beside each other
};

/// A corner of a surface while its triangles are added up.
struct Corner {
  bool isSharp = false;
  Vec3 outwards = Vec3::Zero();  ///< sum of normals, weighted by angles
};

/// Marks the corners of a closed surface at which a triangle is turned sharply against the sum of
/// the normals around it: tips of cones, too.
std::vector<Corner> cornersOf(const TriangleSurface& surface, const Surroundings& around) {
  const std::vector<Vec3>& x = surface.vertices();
  std::vector<Corner> corners(x.size());
  const auto forEachCorner = [&](auto&& function) {
    for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
      const TriangleSurface::Triangle& c = surface.triangles()[t];
      for (std::size_t k = 0; k < 3; ++k) {
        function(t, c[k], angleAt(x[c[k]], x[c[(k + 1) % 3]], x[c[(k + 2) % 3]]));
      }
    }
  };
  forEachCorner([&](std::size_t t, std::int32_t v, double angle) {
    corners[v].outwards += angle * around.normal(t);
  });
  if (!surface.isClosed()) {
    for (Corner& corner : corners) corner.outwards.setZero();
    return corners;
  }
  forEachCorner([&](std::size_t t, std::int32_t v, double /*angle*/) {
    const double size = corners[v].outwards.norm();
    const double least = std::cos(SharpFeatures::kSharp) * size;
    if (corners[v].outwards.dot(around.normal(t)) < least) corners[v].isSharp = true;
  });
  return corners;
}

}  // namespace

SharpFeatures::SharpFeatures(const TriangleSurface& surface) {
  const Surroundings around(surface);
  std::vector<Corner> corners = cornersOf(surface, around);
  const std::vector<Vec3>& x = surface.vertices();
  around.forEachEdge([&](auto first, auto last) {
    if (!around.isSharp(first, last)) return;
    SharpFeature feature;
    feature.ends = {x[first->first], x[first->second]};
    if (surface.isClosed()) {
      for (auto it = first; it != last; ++it) feature.outwards += around.normal(it->triangle);
    }
    features_.push_back(feature);
    corners[first->first].isSharp = corners[first->second].isSharp = true;
  });
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (corners[v].isSharp) features_.push_back({{x[v], x[v]}, true, corners[v].outwards});
  }
  if (!features_.empty()) build(0, static_cast<std::int32_t>(features_.size()));
}

/// Appends the node of a range of features and those below, splitting at the median of the centres.
void SharpFeatures::build(std::int32_t first, std::int32_t last) {
  const auto index = nodes_.size();
  nodes_.emplace_back();
  Node node;
  node.low = node.high = features_[first].ends[0];
  for (std::int32_t k = first; k < last; ++k) {
    for (const Vec3& end : features_[k].ends) {
      node.low = node.low.cwiseMin(end);
      node.high = node.high.cwiseMax(end);
    }
  }
  if (last - first <= kFeaturesOfLeaf) {
    node.first = first;
    node.count = last - first;
  } else {
    int axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    std::stable_sort(features_.begin() + first, features_.begin() + last,
                     [axis](const SharpFeature& a, const SharpFeature& b) {
                       return a.ends[0][axis] + a.ends[1][axis] < b.ends[0][axis] + b.ends[1][axis];
                     });
    const std::int32_t middle = first + (last - first) / 2;
    build(first, middle);
    node.right = static_cast<std::int32_t>(nodes_.size());
    build(middle, last);
  }
  nodes_[index] = node;
}

/// Calls `function` with each feature whose box meets the box, until it returns true.
/// \return whether it did.
template <class Function>
bool SharpFeatures::visit(const Vec3& low, const Vec3& high, Function&& function) const {
  if (nodes_.empty()) return false;
  const auto meets = [&](const Vec3& least, const Vec3& most) {
    return (least - high).maxCoeff() <= 0.0 && (low - most).maxCoeff() <= 0.0;
  };
  std::array<std::int32_t, kDeepestFeature> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::int32_t k = stack[--size];
    const Node& node = nodes_[k];
    if (!meets(node.low, node.high)) continue;
    for (std::int32_t f = node.first; f < node.first + node.count; ++f) {
      const auto& [a, b] = features_[f].ends;
      if (meets(a.cwiseMin(b), a.cwiseMax(b)) && function(f)) return true;
    }
    if (node.count > 0) continue;
    stack[size++] = node.right;
    stack[size++] = k + 1;
  }
  return false;
}

bool SharpFeatures::areIn(const Vec3& low, const Vec3& high) const {
  return visit(low, high, [](std::int32_t /*feature*/) { return true; });
}

void SharpFeatures::find(const Vec3& low, const Vec3& high, std::vector<std::int32_t>& out) const {
  out.clear();
  visit(low, high, [&](std::int32_t feature) {
    out.push_back(feature);
    return false;
  });
}

}  // namespace cloth_sim
