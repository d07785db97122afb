#pragma once
/// \file The cloth as a depth camera sees it. No ROS in here.

#include <array>
#include <limits>
#include <vector>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// Image and lens of a pinhole camera without distortion.
struct CameraLens {
  int width = 320;            ///< of the image [pixels], > 0
  int height = 240;           ///< of the image [pixels], > 0
  double fieldOfView = 60.0;  ///< horizontal, between the edges of the image [degrees], 0 to 180
  double nearest = 0.05;      ///< least depth that is seen [m], > 0
  double farthest = 10.0;     ///< largest depth that is seen [m], > nearest
};

/// The point that a pixel shows.
struct SeenPoint {
  double depth = std::numeric_limits<double>::infinity();  ///< along the optical axis [m]
  FaceId face = kNone;  ///< of the cloth; kNone: no cloth, or something in front of it
};

/// Finds which point of the cloth each pixel of a camera sees first, along the ray through the
/// middle of the pixel. The frame of the camera is an optical one: z is forward, x to the right, y
/// down.
///
/// Cloth hides cloth, and so do the drawn parts of obstacles (without the lines of bounds). Parts
/// of cloth and obstacles nearer than `nearest` are neither seen nor in the way. A solid is in the
/// way where its ray enters it: a camera within a solid, such as its own case, sees out of it.
/// Buffers are kept from image to image.
class DepthCamera {
 public:
  explicit DepthCamera(const CameraLens& lens);

  /// Computes the image. \param camera  pose of the optical frame in the world.
  void look(const Pose& camera, const Snapshot& snapshot);

  const CameraLens& lens() const { return lens_; }
  /// The image of the last look, row by row from the top.
  const std::vector<SeenPoint>& seen() const { return seen_; }
  /// Returns the point at depth 1 m on the ray of a pixel, in the frame of the camera [m].
  Vec3 ray(int column, int row) const {
    return {(column - middleX_) * pixel_, (row - middleY_) * pixel_, 1.0};
  }

 private:
  /// A rectangle of pixels; the ends are not part of it.
  struct PixelBox {
    int left, right, top, bottom;
  };

  void seeCloth(const Snapshot& snapshot);
  void hideBehindTriangles(const TriangleSurface& surface, const Pose& pose);
  void hideBehindSolid(const std::vector<DrawnPart>& parts, const Pose& pose);
  PixelBox pixelsOf(const std::array<Vec3, 3>& corners) const;
  PixelBox pixelsOf(const std::vector<DrawnPart>& parts, const Pose& pose) const;
  PixelBox pixelsBetween(const Vec2& low, const Vec2& high) const;
  template <class Visit>
  void visitPixels(const std::array<Vec3, 3>& corners, Visit&& visit);

  CameraLens lens_;
  double pixel_;               ///< side of a pixel at depth 1 m [m]
  double middleX_;             ///< column of the optical axis [pixels]
  double middleY_;             ///< row of the optical axis [pixels]
  Pose camera_;                ///< in the world
  std::vector<Vec3> corners_;  ///< vertices in the frame of the camera [m]
  std::vector<SeenPoint> seen_;
};

}  // namespace cloth_sim
