#pragma once
/// \file A surface of triangles as the form of an obstacle: closest points, and sweeps of
/// particles.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cloth_sim/contact/box_tree.h"
#include "cloth_sim/types.h"

namespace cloth_sim {

/// Most triangles of a surface.
constexpr std::size_t kMostTriangles = 200000;

/// The point of a surface that is closest to another point.
struct TrianglePoint {
  Vec3 point = Vec3::Zero();           ///< [m]
  double distance = 0.0;               ///< [m], >= 0
  std::int32_t triangle = kNone;       ///< kNone: there is none in reach
  std::array<double, 3> weight{{0.0}}; /**< barycentric coordinates: one is exactly 0 if the point
                                            lies on the opposite edge */
};

/// Contact of the path of a particle with a surface.
struct SurfaceHit {
  double at = 2.0;              ///< part of the path before it, 0 to 1; negative: it began too near
  Vec3 normal = Vec3::UnitZ();  ///< unit vector away from the surface
  double push = 0.0;            ///< distance that the end of the path must move along it [m], > 0
};

/// The triangles near one particle. It saves the search while the particle stays in a box, and
/// changes no result.
struct NearTriangles {
  static constexpr std::int32_t kMost = 14;

  Vec3 centre = Vec3::Zero();  ///< of the box, in the axes of the surface [m]
  double half = -1.0;          ///< half its edge length [m]; negative: not searched yet
  bool isInside = false;       ///< whether the particle was inside the closed surface
  std::int32_t count = 0;      ///< kNone: too many triangles for a list
  std::array<std::int32_t, kMost> triangles{};
};

/// Triangles in space, in any arrangement, with a bounding volume hierarchy. A surface is closed if
/// each edge has two triangles that run along it in opposite directions; it is then the surface of
/// a solid, whatever the direction in which the triangles turn. Any other surface has two sides and
/// no inside.
class TriangleSurface {
 public:
  using Triangle = std::array<std::int32_t, 3>;
  /// One side of a triangle.
  struct Edge {
    std::int32_t low = 0;   ///< the smaller of its vertices
    std::int32_t high = 0;  ///< the larger one
    std::int32_t triangle = 0;
    std::int32_t corner = 0;  ///< of the triangle where it begins
    bool isUp = false;        ///< whether it begins at the smaller one
  };

  /// Leaves out triangles without area.
  /// \param vertices   positions [m].
  /// \param triangles  corners, as indices of vertices.
  /// \throws std::invalid_argument "expected ..." if no triangle has an area, if there are more
  ///         than kMostTriangles, or if a vertex is not finite or does not exist.
  TriangleSurface(std::vector<Vec3> vertices, const std::vector<Triangle>& triangles);

  const std::vector<Vec3>& vertices() const { return vertices_; }
  /// The triangles with an area; those of a closed surface are counter-clockwise from outside.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  bool isClosed() const { return isClosed_; }
  /// The unit normal of a triangle.
  const Vec3& normal(std::int32_t triangle) const { return flats_[triangle].normal; }
  /// The sum of the normals around a vertex of a closed surface, weighted by the angles there.
  const Vec3& vertexNormal(std::int32_t vertex) const { return vertexNormals_[vertex]; }
  /// Calls `function(first, last)` with the sides of triangles along each edge, sorted.
  template <class Function>
  void forEachEdge(Function&& function) const {
    const std::vector<Edge> edges = sortedEdges();
    for (const Edge *first = edges.data(), *end = first + edges.size(), *last = first; first != end;
         first = last) {
      while (last != end && last->low == first->low && last->high == first->high) ++last;
      function(first, last);
    }
  }
  /// Corners of the bounding box [m].
  const Vec3& low() const { return nodes_.front().low; }
  const Vec3& high() const { return nodes_.front().high; }
  /// A number that other triangles do not have.
  std::uint64_t contentHash() const { return contentHash_; }
  /// Says in a sentence why a surface that has an inside to the eye is not closed; "" otherwise.
  const std::string& doubt() const { return doubt_; }

  /// Returns the closest point; without a triangle if none is nearer than `within` [m].
  TrianglePoint closest(const Vec3& p, double within) const;
  /// Distance to the surface [m], negative inside a closed one.
  double distance(const Vec3& p) const;
  /// The same, and the unit vector in which it grows fastest.
  double distance(const Vec3& p, Vec3& normal) const;
  /// Tells whether the distance is at most `limit` [m]. Cheaper than `distance`.
  bool isWithin(const Vec3& p, double limit, const NearTriangles& near) const;

  /// Finds where a particle that keeps `reach` from the surface is stopped on its path first. Of a
  /// path that begins nearer or inside, the end is pushed away by at most `rise`.
  /// \param reach  [m], > 0.
  bool sweep(const Vec3& from, const Vec3& to, double reach, double rise, NearTriangles& near,
             SurfaceHit& hit) const;

 private:
  friend class SurfaceSweep;

  /// Distance below which round-off decides a direction [m].
  static constexpr double kNoDistance = 1e-12;

  /// A triangle ready for use.
  struct Flat {
    Vec3 corner;                    ///< the first one [m]
    Vec3 normal;                    ///< of unit length
    std::array<Vec3, 2> gradients;  ///< of the weights of the other two, along the plane [1/m]

    /// Tells whether the foot of a point is in the triangle. \param p  relative to `corner`.
    bool isOver(const Vec3& p) const;
    /// A lower bound of the squared distance from the foot of a point to the triangle [m^2].
    /// \param p  relative to `corner`.
    double leastSquareBeside(const Vec3& p) const;
  };

  std::array<Vec3, 3> cornersOf(std::int32_t triangle) const;
  void takeTriangles(const std::vector<Triangle>& triangles);
  std::vector<Edge> sortedEdges() const;
  void findWhetherClosed();
  void turnOutwards();
  void sortTriangles();
  void finish();
  void findPseudonormals();

  Vec3 pseudonormal(const TrianglePoint& at) const;
  TrianglePoint closestOf(std::int32_t triangle, const Vec3& p) const;

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;               ///< in the order of the leaves
  std::vector<Flat> flats_;                       ///< by triangle
  std::vector<BoxNode> nodes_;                    ///< over the triangles
  std::vector<Vec3> vertexNormals_;               ///< weighted by angles; of closed surfaces
  std::vector<std::array<Vec3, 3>> edgeNormals_;  ///< by triangle, from its corner k to k + 1
  bool isClosed_ = false;
  double pad_ = 0.0;  ///< by which boxes of NearTriangles exceed a path [m]
  std::uint64_t contentHash_ = 0;
  std::string doubt_;
};

}  // namespace cloth_sim
