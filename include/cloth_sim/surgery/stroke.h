#pragma once
/// \file Strokes of a blade, and where they meet the cloth.

#include <string>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// A straight edge that cuts, in the world [m].
struct Blade {
  Vec3 heel = Vec3::Zero();  ///< what lies nearest to it is the first layer
  Vec3 tip = Vec3::Zero();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(heel, tip);
  }
};

/// A blade that moves from pose to pose, both its ends on straight lines at even speed. What it
/// sweeps is a strip; where the strip meets the cloth, the cloth is cut, however fast it moved.
struct Stroke {
  std::vector<Blade> poses;     ///< at least two
  bool firstLayerOnly = false;  ///< of cloth lying in layers, cut only what is nearest to the heel
  double halfWidth = 0.0;       ///< springs this near to the cut are cleared, if the scene asks [m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(poses, firstLayerOnly, halfWidth);
  }
};

/// A blade drawn along `path` that reaches `reach` metres to both sides of it along `direction`
/// (any length; the heel lies against it).
Stroke strokeAlong(const std::vector<Vec3>& path, const Vec3& direction, double reach);

/// Why a stroke cannot be carried out, in one sentence: too few poses, numbers that are not finite,
/// a blade of no length, or one that goes nowhere. Empty if it can.
std::string validationError(const Stroke& stroke);

/// A point of the surface: in which face, and where in material coordinates [m].
struct SurfacePoint {
  FaceId face = kNone;
  Vec2 material = Vec2::Zero();
};

/// A polyline over the surface. The part between two points lies in the face of the first of them,
/// borders included. A closed path ends with the point that it began with.
struct SurfacePath {
  std::vector<SurfacePoint> points;  ///< at least two

  bool isClosed() const {
    return points.size() > 2 && points.front().material == points.back().material;
  }
};

/// Where the strip of `stroke` meets the cloth: one path per connected line, in the order in which
/// the blade reaches their first points, each directed as the blade moves. A path has a point at
/// every edge that it crosses and wherever it turns inside a face; it ends at the border of the
/// cloth, or inside of a face where the stroke does. Empty if the stroke misses.
///
/// A path that goes through a vertex or along edges has points at the vertices, one each. What lies
/// in the plane of the strip is not cut. A path is closed if the blade came back to its first pose
/// within the cloth, or met a loop of it; a stroke that crosses itself gives a path that does.
///
/// First layer only: of all that the blade reaches at one time, what is not nearest to the heel is
/// left out, and a path in which that changes is cut there, inside of a face if need be. Of cloth
/// that lies along the blade, reached all at once, nothing is left.
///
/// Between two poses with blades that are not parallel the strip is a ruled surface; it is taken in
/// slices thin enough that their planes are within 1e-5 of the blade's length of it, though not
/// more than 1024 between two poses, nor (but for 16 between poses) more than 8192 in all: a blade
/// of 0.1 m that twists by 10 degrees on its way is followed within 5 micrometres.
/// \throws std::invalid_argument if the stroke has a error.
std::vector<SurfacePath> findPaths(const Stroke& stroke, const TriangleMesh& mesh,
                                   const VertexData<Vec3>& positions);

}  // namespace cloth_sim
