#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "stroke_predicates.h"
#include "stroke_segments.h"

namespace cloth_sim {
namespace {

/// Distance from 0 or 1 up to which the parameter of a point on an edge or in a face is set to it.
constexpr double kAtEnd = 1e-12;
/// Distance from the plane of a facet, in lengths of the facet, up to which corners count as in it.
constexpr double kCoplanar = 1e-13;
/// Determinants below this fraction of the lengths involved are computed exactly, since rounding
/// errors would dominate their quotient.
constexpr double kExactBelow = 1e-3;

/// An axis-aligned bounding box.
struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;

  void add(const Blade& blade) {
    low = low.cwiseMin(blade.heel).cwiseMin(blade.tip);
    high = high.cwiseMax(blade.heel).cwiseMax(blade.tip);
  }
};

/// Sets a parameter near 0 or 1 to it.
double snapped(double part) {
  if (!(part > kAtEnd)) return 0.0;
  return part < 1.0 - kAtEnd ? part : 1.0;
}

/// The intersection of a surface with a cloth.
class Crossing {
 public:
  Crossing(const SweptSurface& surface, const TriangleMesh& mesh, const VertexData<Vec3>& positions)
      : surface_(surface),
        mesh_(mesh),
        x_(positions),
        side_(positions.size(), 0),
        sideOfFacet_(positions.size(), kNone) {}

  std::vector<PathSegment> run() {
    std::vector<FaceId> faces;
    const Box box = boxOf(0, surface_.slices.size());
    for (FaceId f = 0; f < mesh_.faceCount(); ++f) {
      if (mayMeet(f, box)) faces.push_back(f);
    }
    crossSlices(0, surface_.slices.size(), faces);
    return std::move(segments_);
  }

 private:
  /// A mesh edge that crosses the plane of a facet.
  struct CrossingEdge {
    VertexId below = kNone;
    VertexId above = kNone;
    std::array<bool, 3> inside{};  ///< it passes inside the line of each facet edge
    bool crossesFacet() const { return inside[0] && inside[1] && inside[2]; }
  };

  Box boxOf(std::size_t first, std::size_t last) const {
    Box box;
    for (std::size_t k = first; k < last; ++k) {
      box.add(surface_.slices[k].first);
      box.add(surface_.slices[k].last);
    }
    return box;
  }

  bool mayMeet(FaceId f, const Box& box) const {
    const auto& [u, v, w] = mesh_.face(f);
    const Vec3& a = x_[u];
    const Vec3& b = x_[v];
    const Vec3& c = x_[w];
    for (int k = 0; k < 3; ++k) {
      const double high = box.high[k];
      const double low = box.low[k];
      // Written such that a coordinate that is no number meets nothing.
      if (!(a[k] <= high || b[k] <= high || c[k] <= high)) return false;
      if (!(a[k] >= low || b[k] >= low || c[k] >= low)) return false;
    }
    return true;
  }

  /// Crosses faces with the slices from `first` to before `last`. Halves the range and selects
  /// faces by bounding boxes until one slice is left.
  void crossSlices(std::size_t first, std::size_t last, const std::vector<FaceId>& faces) {
    if (faces.empty() || first == last) return;
    if (last - first == 1) {
      const SweptSlice& slice = surface_.slices[first];
      for (std::int32_t k = slice.firstFacet; k < slice.lastFacet; ++k) {
        for (FaceId f : faces) crossFacet(slice, k, f);
      }
      return;
    }
    const std::size_t middle = first + (last - first) / 2;
    for (const auto& [begin, end] : {std::pair(first, middle), std::pair(middle, last)}) {
      const Box box = boxOf(begin, end);
      std::vector<FaceId> some;
      std::copy_if(faces.begin(), faces.end(), std::back_inserter(some),
                   [&](FaceId f) { return mayMeet(f, box); });
      crossSlices(begin, end, some);
    }
  }

  /// Returns the side of a facet's plane on which a vertex lies, computed once per facet.
  int sideOf(std::int32_t facet, VertexId v) {
    if (sideOfFacet_[v] != facet) {
      const auto& [p, q, r] = surface_.facets[facet].corners;
      side_[v] = static_cast<std::int8_t>(sideOfPlane(p, q, r, x_[v]));
      sideOfFacet_[v] = facet;
    }
    return side_[v];
  }

  /// Adds the segment in which a face crosses a facet, if they cross.
  void crossFacet(const SweptSlice& slice, std::int32_t facetId, FaceId f) {
    const Face& face = mesh_.face(f);
    std::array<bool, 3> above{};
    for (std::size_t k = 0; k < 3; ++k) above[k] = sideOf(facetId, face[k]) > 0;
    if (above[0] == above[1] && above[1] == above[2]) return;
    const SweptFacet& facet = surface_.facets[facetId];
    std::array<CrossingEdge, 2> edges;  // in the orientation of the face: upwards, downwards
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (!above[k] && above[next]) edges[0] = edgeOf(facet, face[k], face[next]);
      if (above[k] && !above[next]) edges[1] = edgeOf(facet, face[next], face[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (!edges[0].inside[k] && !edges[1].inside[k]) return;
    }
    if (!isCoplanar(facet, face)) addSegment(slice, facetId, f, edges);
  }

  CrossingEdge edgeOf(const SweptFacet& facet, VertexId below, VertexId above) const {
    CrossingEdge edge{below, above};
    for (std::size_t k = 0; k < 3; ++k) {
      edge.inside[k] =
          sideOfLine(facet.corners[k], facet.corners[(k + 1) % 3], x_[below], x_[above]) > 0;
    }
    return edge;
  }

  /// Returns whether a face lies in the plane of a facet. Rounding may find a crossing then.
  bool isCoplanar(const SweptFacet& facet, const Face& face) const {
    const double none = kCoplanar * facet.length * facet.normal.norm();
    return std::all_of(face.begin(), face.end(), [&](VertexId v) {
      return std::abs(facet.normal.dot(x_[v] - facet.corners[0])) <= none;
    });
  }

  /// Adds a segment. Each end of the intersection of two triangles is on an edge of the face or on
  /// an edge of the facet.
  void addSegment(const SweptSlice& slice, std::int32_t facetId, FaceId f,
                  const std::array<CrossingEdge, 2>& edges) {
    const SweptFacet& facet = surface_.facets[facetId];
    std::array<PathSample, 2> ends;
    std::size_t count = 0;
    for (const CrossingEdge& edge : edges) {
      if (edge.crossesFacet() && count < 2) ends[count++] = onMeshEdge(slice, facetId, edge);
    }
    for (std::size_t k = 0; k < 3 && count < 2; ++k) {
      if (edges[0].inside[k] == edges[1].inside[k]) continue;
      if (!straddle(f, facet.corners[k], facet.corners[(k + 1) % 3])) continue;
      ends[count++] = onFacetEdge(slice, facet.edges[k], f);
    }
    if (count == 2) segments_.push_back({ends[0], ends[1], f});
  }

  /// Returns whether p and q are on different sides of the plane of a face.
  bool straddle(FaceId f, const Vec3& p, const Vec3& q) const {
    const auto& [a, b, c] = mesh_.face(f);
    return sideOfFace(x_[a], x_[b], x_[c], p) != sideOfFace(x_[a], x_[b], x_[c], q);
  }

  /// Returns the point at which a mesh edge crosses a facet.
  PathSample onMeshEdge(const SweptSlice& slice, std::int32_t facetId,
                        const CrossingEdge& edge) const {
    const auto [a, b] = std::minmax(edge.below, edge.above);
    const SweptFacet& facet = surface_.facets[facetId];
    const auto& [p, q, r] = facet.corners;
    double atA = facet.normal.dot(x_[a] - p);
    double atB = facet.normal.dot(x_[b] - p);
    const double scale = facet.length * facet.length * (x_[b] - x_[a]).norm();
    if (std::abs(atA - atB) < kExactBelow * scale) {
      atA = exactOrientation(p, q, r, x_[a]);
      atB = exactOrientation(p, q, r, x_[b]);
    }
    const double t = snapped(atA / (atA - atB));
    PathSample sample;
    sample.node = {a, b, facetId};
    sample.material = (1.0 - t) * mesh_.material(a) + t * mesh_.material(b);
    sample.position = (1.0 - t) * x_[a] + t * x_[b];
    sample.at = parametersAt(slice, sample.position);
    return sample;
  }

  /// Returns the point at which a facet edge pierces a face.
  PathSample onFacetEdge(const SweptSlice& slice, std::int32_t edge, FaceId f) const {
    const std::array<double, 3> weight = pierce(surface_.edges[edge], f);
    PathSample sample;
    sample.node = {-1 - edge, f, 0};
    sample.keep = surface_.edges[edge].keep;
    for (std::size_t k = 0; k < 3; ++k) {
      sample.material += weight[k] * mesh_.material(mesh_.face(f)[k]);
      sample.position += weight[k] * x_[mesh_.face(f)[k]];
    }
    if (edge == slice.firstEdge) {
      sample.at = parametersAtFirst(slice, sample.position);
    } else if (edge == slice.lastEdge) {
      sample.at = parametersAtLast(slice, sample.position);
    } else {
      sample.at = parametersAt(slice, sample.position);
    }
    return sample;
  }

  /// Returns the barycentric coordinates of the point at which a facet edge pierces a face. Each is
  /// proportional to the volume of the tetrahedron that the facet edge spans with the edge of the
  /// face opposite the corner.
  std::array<double, 3> pierce(const FacetEdge& edge, FaceId f) const {
    const Face& face = mesh_.face(f);
    const Vec3 d = edge.to - edge.from;
    std::array<double, 3> weight{};
    double sum = 0.0;
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = x_[face[(k + 1) % 3]];
      const Vec3 b = x_[face[(k + 2) % 3]];
      weight[k] = d.dot((a - edge.from).cross(b - edge.from));
      sum += weight[k];
      longest = std::max(longest, (b - a).squaredNorm());
    }
    if (std::abs(sum) < kExactBelow * d.norm() * longest) sum = pierceExactly(edge, face, weight);
    double kept = 0.0;
    for (double& part : weight) {
      part = snapped(part / sum);
      kept += part;
    }
    for (double& part : weight) part = kept > 0.0 ? part / kept : 1.0 / 3.0;
    return weight;
  }

  /// Computes those volumes exactly. \return their sum.
  double pierceExactly(const FacetEdge& edge, const Face& face,
                       std::array<double, 3>& weight) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      weight[k] =
          exactOrientation(edge.from, edge.to, x_[face[(k + 1) % 3]], x_[face[(k + 2) % 3]]);
      sum += weight[k];
    }
    return sum;
  }

  const SweptSurface& surface_;
  const TriangleMesh& mesh_;
  const VertexData<Vec3>& x_;
  std::vector<std::int8_t> side_;          ///< by vertex: its side of the facet `sideOfFacet_`
  std::vector<std::int32_t> sideOfFacet_;  ///< by vertex: the facet that `side_` is about
  std::vector<PathSegment> segments_;
};

}  // namespace

std::vector<PathSegment> crossFaces(const SweptSurface& surface, const TriangleMesh& mesh,
                                    const VertexData<Vec3>& positions) {
  if (surface.slices.empty()) return {};
  return Crossing(surface, mesh, positions).run();
}

}  // namespace cloth_sim
