#include "depth_camera.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadiansPerDegree = M_PI / 180.0;
/// Margin of a box of pixels against rounding; the exact test is that of each pixel [pixels].
constexpr double kPixelMargin = 1e-6;

/// Part of a ray inside of a solid, by depth [m]; empty if it ends before it begins.
struct RayPart {
  double begin = -kInfinity;
  double end = kInfinity;
};

constexpr RayPart kNoPart{kInfinity, -kInfinity};

RayPart common(const RayPart& a, const RayPart& b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

/// The part between two parallel planes at -half and half [m], along one axis.
RayPart betweenPlanes(double from, double direction, double half) {
  if (direction == 0.0) return std::abs(from) <= half ? RayPart() : kNoPart;
  const double a = (-half - from) / direction;
  const double b = (half - from) / direction;
  return {std::min(a, b), std::max(a, b)};
}

/// The part within `radius` [m] of the origin: of a ball, or in two dimensions of a round rod.
template <class Vector>
RayPart withinRadius(const Vector& from, const Vector& direction, double radius) {
  const double a = direction.squaredNorm();
  const double c = from.squaredNorm() - radius * radius;
  if (a == 0.0) return c <= 0.0 ? RayPart() : kNoPart;
  const double b = from.dot(direction);
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return kNoPart;
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

RayPart withinBox(const Vec3& from, const Vec3& direction, const Vec3& size) {
  RayPart inside;
  for (int k = 0; k < 3; ++k) {
    inside = common(inside, betweenPlanes(from[k], direction[k], 0.5 * size[k]));
  }
  return inside;
}

bool isSolid(const DrawnPart& part) {
  return part.kind != DrawnPart::Kind::kBoxEdges && part.kind != DrawnPart::Kind::kTriangles;
}

/// The part of a ray inside of a box, ball or cylinder. \param from  in the axes of the obstacle
/// [m].
RayPart within(const DrawnPart& part, const Vec3& from, const Vec3& direction) {
  const Vec3 start = from - part.centre;
  const double radius = 0.5 * part.size.x();
  switch (part.kind) {
    case DrawnPart::Kind::kBox:
      return withinBox(start, direction, part.size);
    case DrawnPart::Kind::kSphere:
      return withinRadius(start, direction, radius);
    case DrawnPart::Kind::kCylinder:
      return common(withinRadius<Vec2>(start.head<2>(), direction.head<2>(), radius),
                    betweenPlanes(start.z(), direction.z(), 0.5 * part.size.z()));
    case DrawnPart::Kind::kBoxEdges:
    case DrawnPart::Kind::kTriangles:
      break;
  }
  return kNoPart;
}

/// Depth at which a ray enters the solid that the parts form, which is convex [m]; infinite if it
/// does not, negative if it starts inside.
double entry(const std::vector<DrawnPart>& parts, const Vec3& from, const Vec3& direction) {
  double first = kInfinity;
  for (const DrawnPart& part : parts) {
    const RayPart inside = within(part, from, direction);
    if (inside.begin <= inside.end) first = std::min(first, inside.begin);
  }
  return first;
}

Vec2 project(const Vec3& point) { return point.head<2>() / point.z(); }

}  // namespace

DepthCamera::DepthCamera(const CameraLens& lens)
    : lens_(lens),
      pixel_(std::tan(0.5 * lens.fieldOfView * kRadiansPerDegree) / (0.5 * lens.width)),
      middleX_(0.5 * (lens.width - 1)),
      middleY_(0.5 * (lens.height - 1)) {}

void DepthCamera::look(const Pose& camera, const Snapshot& snapshot) {
  camera_ = camera;
  const auto pixels =
      static_cast<std::size_t>(lens_.width) * static_cast<std::size_t>(lens_.height);
  seen_.assign(pixels, SeenPoint());
  seeCloth(snapshot);
  for (const Obstacle& obstacle : snapshot.obstacles) {
    const std::vector<DrawnPart> parts = drawing(obstacle.shape);
    hideBehindSolid(parts, obstacle.pose);
    for (const DrawnPart& part : parts) {
      if (part.surface) hideBehindTriangles(*part.surface, obstacle.pose);
    }
  }
}

void DepthCamera::seeCloth(const Snapshot& snapshot) {
  corners_.clear();
  for (const Vec3& position : snapshot.positions) corners_.push_back(camera_.toLocal(position));
  const std::vector<Face>& faces = snapshot.topology->faces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Face& face = faces[f];
    visitPixels({corners_[face[0]], corners_[face[1]], corners_[face[2]]},
                [&](SeenPoint& seen, double depth) {
                  if (depth > lens_.farthest) return;
                  seen = {depth, static_cast<FaceId>(f)};
                });
  }
}

/// The triangles of a closed surface hide from outside only, as the solid does.
void DepthCamera::hideBehindTriangles(const TriangleSurface& surface, const Pose& pose) {
  corners_.clear();
  for (const Vec3& vertex : surface.vertices()) {
    corners_.push_back(camera_.toLocal(pose.toWorld(vertex)));
  }
  for (const TriangleSurface::Triangle& triangle : surface.triangles()) {
    const std::array<Vec3, 3> at{corners_[triangle[0]], corners_[triangle[1]],
                                 corners_[triangle[2]]};
    const Vec3 normal = (at[1] - at[0]).cross(at[2] - at[0]);
    if (surface.isClosed() && normal.dot(at[0]) >= 0.0) continue;
    visitPixels(at, [](SeenPoint& seen, double depth) { seen = {depth, kNone}; });
  }
}

void DepthCamera::hideBehindSolid(const std::vector<DrawnPart>& parts, const Pose& pose) {
  const Vec3 from = pose.toLocal(camera_.position);
  const Eigen::Matrix3d turn =
      (pose.orientation.conjugate() * camera_.orientation).toRotationMatrix();
  const PixelBox box = pixelsOf(parts, pose);
  for (int row = box.top; row < box.bottom; ++row) {
    for (int column = box.left; column < box.right; ++column) {
      SeenPoint& seen = seen_[static_cast<std::size_t>(row) * lens_.width + column];
      if (seen.face == kNone) continue;
      const double depth = entry(parts, from, turn * ray(column, row));
      if (depth >= lens_.nearest && depth < seen.depth) seen = {depth, kNone};
    }
  }
}

/// The pixels between two points at depth 1 m [m].
DepthCamera::PixelBox DepthCamera::pixelsBetween(const Vec2& low, const Vec2& high) const {
  const auto pixel = [](double at, int most) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(most)));
  };
  const double left = std::ceil(low.x() / pixel_ + middleX_ - kPixelMargin);
  const double top = std::ceil(low.y() / pixel_ + middleY_ - kPixelMargin);
  const double right = std::floor(high.x() / pixel_ + middleX_ + kPixelMargin) + 1.0;
  const double bottom = std::floor(high.y() / pixel_ + middleY_ + kPixelMargin) + 1.0;
  return {pixel(left, lens_.width), pixel(right, lens_.width), pixel(top, lens_.height),
          pixel(bottom, lens_.height)};
}

/// The pixels around the part of a triangle that is not nearer than `nearest`.
DepthCamera::PixelBox DepthCamera::pixelsOf(const std::array<Vec3, 3>& corners) const {
  Vec2 low = Vec2::Constant(kInfinity);
  Vec2 high = Vec2::Constant(-kInfinity);
  const auto add = [&](const Vec2& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& a = corners[k];
    const Vec3& b = corners[(k + 1) % 3];
    if (a.z() >= lens_.nearest) add(project(a));
    if ((a.z() >= lens_.nearest) == (b.z() >= lens_.nearest)) continue;
    const double fraction = (lens_.nearest - a.z()) / (b.z() - a.z());
    add((a + fraction * (b - a)).head<2>() / lens_.nearest);
  }
  return pixelsBetween(low, high);
}

/// The pixels around boxes, balls and cylinders; all of them if one reaches behind `nearest`.
DepthCamera::PixelBox DepthCamera::pixelsOf(const std::vector<DrawnPart>& parts,
                                            const Pose& pose) const {
  Vec2 low = Vec2::Constant(kInfinity);
  Vec2 high = Vec2::Constant(-kInfinity);
  double least = kInfinity;
  double most = -kInfinity;
  for (const DrawnPart& part : parts) {
    if (!isSolid(part)) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      const Vec3 point = camera_.toLocal(pose.toWorld(part.centre + sign.cwiseProduct(part.size)));
      low = low.cwiseMin(project(point));
      high = high.cwiseMax(project(point));
      least = std::min(least, point.z());
      most = std::max(most, point.z());
    }
  }
  if (most < lens_.nearest) return {0, 0, 0, 0};
  if (least < lens_.nearest) return {0, lens_.width, 0, lens_.height};
  return pixelsBetween(low, high);
}

/// Calls `visit(seen, depth)` for the pixels that see a triangle at `depth` before anything else.
///
/// The ray d of a pixel meets the triangle a, b, c if d.(a x b), d.(b x c) and d.(c x a) have the
/// same sign: Olano and Greer (1997), Triangle scan conversion using 2D homogeneous coordinates. No
/// triangle has to be clipped for that, and a ray on an edge meets the triangles on both sides.
template <class Visit>
void DepthCamera::visitPixels(const std::array<Vec3, 3>& corners, Visit&& visit) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double height = normal.dot(corners[0]);
  if (!std::isfinite(height) || height == 0.0) return;  // edge-on, or not finite
  const double sign = height > 0.0 ? 1.0 : -1.0;
  std::array<Vec3, 3> edges;
  for (std::size_t k = 0; k < 3; ++k) edges[k] = sign * corners[k].cross(corners[(k + 1) % 3]);
  const PixelBox box = pixelsOf(corners);
  for (int row = box.top; row < box.bottom; ++row) {
    for (int column = box.left; column < box.right; ++column) {
      const Vec3 direction = ray(column, row);
      if (edges[0].dot(direction) < 0.0 || edges[1].dot(direction) < 0.0 ||
          edges[2].dot(direction) < 0.0) {
        continue;
      }
      const double depth = height / normal.dot(direction);
      SeenPoint& seen = seen_[static_cast<std::size_t>(row) * lens_.width + column];
      if (depth >= lens_.nearest && depth < seen.depth) visit(seen, depth);
    }
  }
}

}  // namespace cloth_sim
