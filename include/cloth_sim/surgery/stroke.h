#pragma once
/// \file Strokes of a blade, and the paths along which they cut cloth.

#include <string>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// A straight cutting edge in the world.
struct Blade {
  Vec3 heel = Vec3::Zero();  ///< [m]; the first layer is the one nearest to it
  Vec3 tip = Vec3::Zero();   ///< [m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(heel, tip);
  }
};

/// A blade that moves from pose to pose, both of its ends on straight lines at constant speed. It
/// sweeps a ruled surface. The cloth is cut where it meets that surface, at any speed of the blade.
struct Stroke {
  std::vector<Blade> poses;     ///< at least two
  bool firstLayerOnly = false;  ///< cut only the layer of cloth that is nearest to the heel
  double halfWidth = 0.0;       ///< of the cut, within which `clear_strip` removes cloth [m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(poses, firstLayerOnly, halfWidth);
  }
};

/// Makes the stroke of a blade that is drawn along a path.
/// \param direction  from heel to tip, of any length.
/// \param reach      distance of heel and tip from the path [m].
Stroke strokeAlong(const std::vector<Vec3>& path, const Vec3& direction, double reach);

/// Returns one sentence about what is wrong with a stroke: too few poses, numbers that are not
/// finite or beyond 1e6 m, a blade without length, or a blade that does not move. Empty if nothing
/// is.
std::string validationError(const Stroke& stroke);

/// A point of the cloth.
struct SurfacePoint {
  FaceId face = kNone;           ///< that contains it
  Vec2 material = Vec2::Zero();  ///< material coordinates [m]
};

/// A polyline over the cloth. The segment between two points lies in the face of the first of them,
/// its edges included. A closed path ends with its first point.
struct SurfacePath {
  std::vector<SurfacePoint> points;  ///< at least two

  bool isClosed() const {
    return points.size() > 2 && points.front().material == points.back().material;
  }
};

/// Finds the paths along which a stroke cuts cloth: one for each connected line in which the swept
/// surface meets it, in the order in which the blade reaches their first points, each directed as
/// the blade moves. A path has a point at every mesh edge that it crosses, and wherever it turns
/// inside a face. It ends at the border of the cloth, or inside a face where the stroke does.
///
/// A path through a vertex or along mesh edges has one point at each vertex. Cloth in the plane of
/// the swept surface is not cut. A path is closed if the blade returns to its first pose within the
/// cloth, or meets a loop of the cloth. A stroke that crosses itself gives a path that crosses
/// itself.
///
/// With `firstLayerOnly`, only the cloth nearest to the heel is cut at any time. A path ends where
/// that changes, inside a face if necessary. Cloth along the blade, which the blade reaches all at
/// once, is not cut.
///
/// Between two poses with blades that are not parallel, the ruled surface is divided into slices
/// whose planes are within 1e-5 of the length of the blade. There are at most 1024 slices between
/// two poses and, except for 16 slices between any two poses, 8192 in all. A blade of 0.1 m that
/// twists by 10 degrees is represented within 5 micrometres.
/// \param positions  of the vertices in the world, (vertexCount,) [m].
/// \throws std::invalid_argument if the stroke is not valid, or the number of positions is wrong.
std::vector<SurfacePath> findPaths(const Stroke& stroke, const TriangleMesh& mesh,
                                   const VertexData<Vec3>& positions);

}  // namespace cloth_sim
