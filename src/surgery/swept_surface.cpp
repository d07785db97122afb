#include "swept_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stroke_predicates.h"

namespace cloth_sim {
namespace {

/// Tolerated distance of facets from the ruled surface, in lengths of the blade.
constexpr double kDeviation = 1e-5;
/// Largest number of slices between two poses.
constexpr double kMaxSlices = 1024.0;
/// Largest number of slices of a stroke, which takes precedence unless it leaves fewer than
/// kLeastMaxSlices between two poses.
constexpr double kMaxSlicesOfStroke = 8192.0;
constexpr double kLeastMaxSlices = 16.0;
/// Relative size below which a volume counts as flat, and a turn as straight.
constexpr double kFlat = 1e-12;

bool same(const Blade& a, const Blade& b) { return a.heel == b.heel && a.tip == b.tip; }

/// Returns the blade a fraction of the way from a to b.
Blade between(const Blade& a, const Blade& b, double fraction) {
  if (fraction >= 1.0) return b;
  return {(1.0 - fraction) * a.heel + fraction * b.heel,
          (1.0 - fraction) * a.tip + fraction * b.tip};
}

/// Returns the normal of a triangle, of twice its area in length [m^2].
Vec3 areaVector(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

/// Returns whether the blade moves along its own line.
bool slides(const Blade& a, const Blade& b) {
  const double none = kFlat * (a.tip - a.heel).squaredNorm();
  return areaVector(a.heel, a.tip, b.heel).norm() <= none &&
         areaVector(a.heel, a.tip, b.tip).norm() <= none;
}

double longestOf(const Blade& a, const Blade& b) {
  return std::max((a.tip - a.heel).norm(), (b.tip - b.heel).norm());
}

/// Returns an upper bound on the distance between the ruled surface of two poses and two triangles
/// [m]. The surface is bilinear: it deviates by u v times the component of the `twist` that is
/// normal to it, which is at most a quarter.
double deviationOf(const Blade& a, const Blade& b) {
  const Vec3 path = b.heel - a.heel;
  const Vec3 blade = a.tip - a.heel;
  const Vec3 twist = b.tip - b.heel - blade;
  const double volume = std::abs(path.cross(blade).dot(twist));
  const double length = longestOf(a, b);
  const double reach = std::max(path.norm(), (b.tip - a.tip).norm());
  if (volume <= kFlat * length * length * reach) return 0.0;
  double normalTwist = 0.0;  // largest component along the normals at the four corners
  for (double along : {0.0, 1.0}) {
    for (double when : {0.0, 1.0}) {
      const double area = (path + along * twist).cross(blade + when * twist).norm();
      // Where the area vanishes, the quotient is infinite and all of the twist counts.
      normalTwist = std::max(normalTwist, std::min(volume / area, twist.norm()));
    }
  }
  return 0.25 * normalTwist;
}

/// Returns the number of slices between two poses.
int sliceCount(double deviation, double length, std::size_t poses) {
  const double most =
      std::clamp(kMaxSlicesOfStroke / static_cast<double>(poses - 1), kLeastMaxSlices, kMaxSlices);
  return static_cast<int>(std::clamp(std::ceil(deviation / (kDeviation * length)), 1.0, most));
}

/// Returns the point of the second of two coplanar blades that is nearest to their intersection.
Vec3 crossingOf(const Blade& a, const Blade& b) {
  const Vec3 u = a.tip - a.heel;
  const Vec3 v = b.tip - b.heel;
  const Vec3 normal = u.cross(v);
  const double part = normal.dot((a.heel - b.heel).cross(u)) / -normal.squaredNorm();
  return b.heel + (std::isfinite(part) ? std::clamp(part, 0.0, 1.0) : 0.5) * v;
}

/// Builds the surface slice by slice.
class SweptSurfaceBuilder {
 public:
  explicit SweptSurfaceBuilder(const Stroke& stroke) : poses_(stroke.poses) {
    for (const Blade& pose : poses_) allow(kDeviation * (pose.tip - pose.heel).norm());
  }

  SweptSurface build() {
    current_ = addEdge(poses_.front(), Keep::kAlways);
    const bool closed = same(poses_.front(), poses_.back());
    for (std::size_t k = 0; k + 1 < poses_.size(); ++k) {
      if (same(poses_[k], poses_[k + 1])) continue;
      addSlices(k);
    }
    if (closed) renumber(current_, 0);
    markStraightEdges();
    return std::move(surface_);
  }

 private:
  std::int32_t addEdge(const Blade& at, Keep keep) {
    surface_.edges.push_back({at.heel, at.tip, keep});
    return static_cast<std::int32_t>(surface_.edges.size()) - 1;
  }

  /// Raises the tolerance of the surface to at least `deviation`.
  void allow(double deviation) { surface_.tolerance = std::max(surface_.tolerance, deviation); }

  /// Adds the slices between the poses k and k + 1.
  void addSlices(std::size_t k) {
    const Blade& from = poses_[k];
    const Blade& to = poses_[k + 1];
    const double deviation = deviationOf(from, to);
    const int count = sliceCount(deviation, longestOf(from, to), poses_.size());
    allow(deviation / count);
    for (int i = 0; i < count; ++i) {
      const double start = static_cast<double>(i) / count;
      const double end = static_cast<double>(i + 1) / count;
      SweptSlice slice{between(from, to, start), between(from, to, end)};
      slice.start = static_cast<double>(k) + start;
      slice.end = i + 1 == count ? static_cast<double>(k + 1) : static_cast<double>(k) + end;
      addSlice(slice, i + 1 == count);
    }
  }

  void addSlice(SweptSlice slice, bool endsAtPose) {
    const auto& [heel, tip] = slice.first;
    const auto& [nextHeel, nextTip] = slice.last;
    if (slides(slice.first, slice.last)) return;  // continues from the edge at which it was
    slice.firstEdge = current_;
    slice.lastEdge = addEdge(slice.last, endsAtPose ? Keep::kAlways : Keep::kIfFar);
    slice.firstFacet = static_cast<std::int32_t>(surface_.facets.size());
    // A convex quadrilateral can be divided along either diagonal, a concave one along the diagonal
    // at its reflex corner; one that intersects itself is divided at the intersection.
    const auto agree = [](const Vec3& a, const Vec3& b) { return a.dot(b) >= 0.0; };
    if (agree(areaVector(heel, tip, nextTip), areaVector(heel, nextTip, nextHeel))) {
      addQuadrilateral(slice);
    } else if (agree(areaVector(tip, nextTip, nextHeel), areaVector(tip, nextHeel, heel))) {
      addConcave(slice);
    } else {
      addPivot(slice);
    }
    slice.lastFacet = static_cast<std::int32_t>(surface_.facets.size());
    for (std::int32_t k = slice.firstFacet; k < slice.lastFacet; ++k) {
      const Vec3& normal = surface_.facets[k].normal;
      slice.normal += slice.normal.dot(normal) < 0.0 ? Vec3(-normal) : normal;
    }
    surface_.slices.push_back(slice);
    current_ = slice.lastEdge;
  }

  /// Divides a slice along the diagonal from the first heel to the last tip.
  void addQuadrilateral(const SweptSlice& slice) {
    const auto& [heel, tip] = slice.first;
    const auto& [nextHeel, nextTip] = slice.last;
    const std::int32_t diagonal =
        diagonalOf({heel, nextTip}, spanPlane(heel, tip, nextTip),
                   spanPlane(heel, nextTip, nextHeel), slice.firstEdge, slice.lastEdge);
    addFacet({heel, tip, nextTip}, {slice.firstEdge, kNone, diagonal});
    addFacet({heel, nextTip, nextHeel}, {diagonal, slice.lastEdge, kNone});
  }

  /// Divides a slice along the diagonal from the last heel to the first tip.
  void addConcave(const SweptSlice& slice) {
    const auto& [heel, tip] = slice.first;
    const auto& [nextHeel, nextTip] = slice.last;
    const std::int32_t diagonal =
        diagonalOf({nextHeel, tip}, spanPlane(tip, nextHeel, heel),
                   spanPlane(tip, nextTip, nextHeel), slice.firstEdge, slice.lastEdge);
    addFacet({tip, nextHeel, heel}, {diagonal, kNone, slice.firstEdge});
    addFacet({tip, nextTip, nextHeel}, {kNone, slice.lastEdge, diagonal});
  }

  /// Adds the slice of a blade that turned about a point of itself in its plane: it swept a
  /// triangle on each side.
  void addPivot(const SweptSlice& slice) {
    const Vec3 pivot = crossingOf(slice.first, slice.last);
    addFacet({slice.first.heel, pivot, slice.last.heel}, {slice.firstEdge, slice.lastEdge, kNone});
    addFacet({slice.first.tip, slice.last.tip, pivot}, {kNone, slice.lastEdge, slice.firstEdge});
  }

  /// Returns the edge for a diagonal. It is the edge of the first or last blade if the triangle
  /// between them is degenerate, so that they are on one line.
  std::int32_t diagonalOf(const Blade& at, bool firstSpans, bool lastSpans, std::int32_t first,
                          std::int32_t last) {
    if (!firstSpans) return first;
    return lastSpans ? addEdge(at, Keep::kNever) : last;
  }

  /// Adds a facet unless it is degenerate. Edges without a number lie on the rails and get a new
  /// one.
  void addFacet(const std::array<Vec3, 3>& corners, const std::array<std::int32_t, 3>& edges) {
    if (!spanPlane(corners[0], corners[1], corners[2])) return;
    SweptFacet facet;
    facet.corners = corners;
    facet.edges = edges;
    facet.normal = areaVector(corners[0], corners[1], corners[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& next = corners[(k + 1) % 3];
      facet.length = std::max(facet.length, (next - corners[k]).norm());
      if (edges[k] == kNone) facet.edges[k] = addEdge({corners[k], next}, Keep::kAlways);
    }
    surface_.facets.push_back(facet);
  }

  /// Replaces an edge by another one, where a closed surface ends.
  void renumber(std::int32_t edge, std::int32_t to) {
    for (SweptFacet& facet : surface_.facets) {
      std::replace(facet.edges.begin(), facet.edges.end(), edge, to);
    }
    for (SweptSlice& slice : surface_.slices) {
      if (slice.lastEdge == edge) slice.lastEdge = to;
    }
  }

  /// Finds the edges at which the surface does not turn: paths do not need points there.
  void markStraightEdges() {
    std::vector<std::array<const SweptFacet*, 2>> facetsAt(surface_.edges.size());
    std::vector<int> count(surface_.edges.size(), 0);
    for (const SweptFacet& facet : surface_.facets) {
      for (std::int32_t edge : facet.edges) {
        if (count[edge] < 2) facetsAt[edge][count[edge]] = &facet;
        ++count[edge];
      }
    }
    for (std::size_t k = 0; k < surface_.edges.size(); ++k) {
      if (count[k] != 2) continue;
      const Vec3& a = facetsAt[k][0]->normal;
      const Vec3& b = facetsAt[k][1]->normal;
      const bool straight = a.cross(b).norm() <= kFlat * a.norm() * b.norm() && a.dot(b) > 0.0;
      if (straight) surface_.edges[k].keep = std::min(surface_.edges[k].keep, Keep::kIfFar);
    }
  }

  const std::vector<Blade>& poses_;
  SweptSurface surface_;
  std::int32_t current_ = kNone;
};

/// Returns the root of a t^2 + b t + c that is nearest to [0, 1], clamped to it. Uses the stable
/// form of the quadratic formula (Press et al., Numerical Recipes, 5.6).
double rootWithin(double a, double b, double c) {
  const double root = std::sqrt(std::max(b * b - 4.0 * a * c, 0.0));
  const double q = -0.5 * (b + std::copysign(root, b));
  double best = 0.0;
  double distance = std::numeric_limits<double>::infinity();
  for (double t : {c / q, q / a}) {
    const double off = std::abs(t - std::clamp(t, 0.0, 1.0));
    if (!(off < distance)) continue;  // also if t is not finite
    best = std::clamp(t, 0.0, 1.0);
    distance = off;
  }
  return best;
}

/// Returns the blade parameter of the point on a blade that is nearest to `point`.
double alongBlade(const Blade& blade, const Vec3& point) {
  const Vec3 d = blade.tip - blade.heel;
  const double part = d.dot(point - blade.heel) / d.squaredNorm();
  return std::isfinite(part) ? std::clamp(part, 0.0, 1.0) : 0.0;
}

}  // namespace

SweptSurface makeSweptSurface(const Stroke& stroke) { return SweptSurfaceBuilder(stroke).build(); }

SweptParameters parametersAt(const SweptSlice& slice, const Vec3& point) {
  // The point is on the blade at the fraction t of the way if (point - heel(t)) x blade(t) = 0.
  // Both factors are linear in t; the component along the normal gives a quadratic equation.
  const Vec3 path = slice.last.heel - slice.first.heel;
  const Vec3 blade = slice.first.tip - slice.first.heel;
  const Vec3 twist = slice.last.tip - slice.last.heel - blade;
  const Vec3 offset = point - slice.first.heel;
  const Vec3& normal = slice.normal;
  const double t = rootWithin(-path.cross(twist).dot(normal),
                              (offset.cross(twist) - path.cross(blade)).dot(normal),
                              offset.cross(blade).dot(normal));
  return {slice.start + t * (slice.end - slice.start),
          alongBlade(between(slice.first, slice.last, t), point)};
}

SweptParameters parametersAtFirst(const SweptSlice& slice, const Vec3& point) {
  return {slice.start, alongBlade(slice.first, point)};
}

SweptParameters parametersAtLast(const SweptSlice& slice, const Vec3& point) {
  return {slice.end, alongBlade(slice.last, point)};
}

}  // namespace cloth_sim
