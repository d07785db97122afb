#pragma once
/// \file A surface of triangles as an obstacle: a gripper, a folding board, a bowl.

#include <memory>
#include <string>

#include "cloth_sim/contact/shape_geometry.h"
#include "cloth_sim/contact/triangle_surface.h"

namespace cloth_sim {
namespace geometry {

/// A surface of triangles. A closed one is a solid; an open one has two sides. Its members that
/// take triangles near a particle are those of the contract, without the search for them.
class Mesh {
 public:
  static constexpr int kMaxHits = 6;  ///< a hollow can stop a particle many times; then `stop` does
  /// Least distance that particles keep, where cloth has no thickness [m].
  static constexpr double kLeastReach = 1e-6;

  Mesh(const TriangleSurface& surface, const Quat& orientation, double margin)
      : surface_(&surface), axes_(orientation), margin_(margin) {}

  double gap(const Vec3& p) const { return surface_->distance(axes_.toLocal(p)) - margin_; }
  double gap(const Vec3& p, Vec3& normal) const {
    Vec3 local;
    const double distance = surface_->distance(axes_.toLocal(p), local);
    normal = axes_.toWorld(local);
    return distance - margin_;
  }
  /// Tests the axes of the bounding box as separating axes.
  double leastGap(const Vec3& centre, const Vec3& half) const {
    const Vec3 local = axes_.toLocal(centre);
    const Vec3 extent = axes_.extent(half);
    return (surface_->low() - local).cwiseMax(local - surface_->high()).maxCoeff() -
           extent.maxCoeff() - margin_;
  }
  bool isBeyond(const Vec3& p, double distance) const {
    const Vec3 local = axes_.toLocal(p);
    return (surface_->low() - local).cwiseMax(local - surface_->high()).maxCoeff() >
           margin_ + distance;
  }
  /// Tells whether gap(p) <= limit.
  bool isWithin(const Vec3& p, double limit, const NearTriangles& near) const {
    return surface_->isWithin(axes_.toLocal(p), limit + margin_, near);
  }

  bool sweep(const Vec3& start, const Vec3& end, double rise, SweepHit& hit) const {
    NearTriangles near;
    return sweep(start, end, rise, hit, near);
  }
  bool sweep(const Vec3& start, const Vec3& end, double rise, SweepHit& hit,
             NearTriangles& near) const {
    SurfaceHit found;
    if (!find(start, end, rise, found, near)) return false;
    hit = {axes_.toWorld(found.normal), found.push};
    return true;
  }
  /// Stops a particle where it comes within reach of the surface first, if it does.
  bool stop(const Vec3& start, const Vec3& end, double rise, SweepHit& hit,
            NearTriangles& near) const {
    SurfaceHit found;
    if (!find(start, end, rise, found, near)) return false;
    const double length = (end - start).norm();
    hit.push = (1.0 - std::max(0.0, found.at)) * length;
    if (!(hit.push > 0.0)) return false;
    hit.normal = (start - end) / length;
    return true;
  }

  std::optional<LevelTop> levelTop() const { return std::nullopt; }

 private:
  bool find(const Vec3& start, const Vec3& end, double rise, SurfaceHit& hit,
            NearTriangles& near) const {
    return surface_->sweep(axes_.toLocal(start), axes_.toLocal(end), std::max(margin_, kLeastReach),
                           rise, near, hit);
  }

  const TriangleSurface* surface_;
  RotatedAxes axes_;
  double margin_;
};

}  // namespace geometry

/// The triangles of a file.
struct SurfaceFile {
  std::string name;  ///< as in the scene
  std::shared_ptr<const TriangleSurface> surface;
  std::uint64_t contentHash = 0;  ///< of the surface
  std::string path;               ///< absolute; empty if there is no file

  /// A saved state has the hash only: the scene has the triangles.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, contentHash);
  }
};

/// Returns the surface of a box around the origin. \param size  edge lengths [m].
TriangleSurface boxSurface(const Vec3& size);
/// Returns the file with these triangles.
SurfaceFile surfaceFile(std::string name, TriangleSurface surface);
/// A cube with edges of 0.2 m around the origin.
const SurfaceFile& defaultSurface();

/// A surface of triangles in the axes of the obstacle.
struct MeshShape {
  SurfaceFile file = defaultSurface();
  /// Length unit of the file along each axis [m], not 0; absent: 1 m, or what a Collada file says.
  std::optional<Vec3> scale;
  /// Whether faces and edges of the cloth meet the sharp corners and edges; otherwise only
  /// particles do.
  bool sharpEdges = false;

  static constexpr std::array<const char*, 1> kTypes{"mesh"};
  static constexpr auto keys() {
    return std::make_tuple(ShapeKey("file", &MeshShape::file), ShapeKey("scale", &MeshShape::scale),
                           ShapeKey("sharp_edges", &MeshShape::sharpEdges));
  }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& orientation, double margin, Function&& function) const {
    return function(geometry::Mesh(*file.surface, orientation, margin));
  }

  std::vector<DrawnPart> drawing() const;
  std::optional<double> handleRadius() const;
  std::shared_ptr<const TriangleSurface> sharpSurface() const {
    return sharpEdges ? file.surface : nullptr;
  }
};

}  // namespace cloth_sim
