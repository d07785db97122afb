#pragma once
/// \file The contract of a shape, and the types that it is written in.
///
/// A shape is a struct in a header of its own in `shapes/`, and one row of `Shape` in shape.h.
/// Scene files, saved states, validation, detection, projection, markers, handles in rviz and the
/// tests are generic over the shapes, so a shape that lacks a member does not compile:
///
///     kTypes                       array of its names for `type` in scene files, the preferred
///     first keys()                       tuple of ShapeKey: its dimensions and their scene keys
///     visitGeometry(q, margin, f)  returns f(geometry), where the geometry is rotated by q
///     drawing()                    vector of DrawnPart, in the axes of the shape
///     handleRadius()               optional [m]: how far the shape reaches around its position at
///                                  least; absent if a user cannot drag it
///     sharpSurface()               the surface whose sharp corners and edges the cloth meets with
///                                  its faces and edges, too; null if only particles meet the shape
///
/// Detection and projection call the geometry, a class with inlined members. Its points are
/// relative to the position of the obstacle, in the axes of the world. Its `gap` is the signed
/// distance to the surface less the margin, so each solid is its shape inflated by a ball whose
/// radius is the margin: a box has round edges, and its normals turn continuously.
///
///     double gap(p)                      signed distance [m]
///     double gap(p, normal)              the same, and the unit vector in which it grows fastest
///     double leastGap(centre, half)      lower bound of `gap` over an axis-aligned box [m]
///     bool isBeyond(p, d)                cheap test; true only if gap(p) > d
///     bool sweep(start, end, rise, hit)  whether the solid stops a particle on its path
///     optional<LevelTop> levelTop()      the level top, if the solid has one
///     kMaxHits                           how often a solid can stop a particle in one substep
///
/// `sweep` computes along which normal, and how far, the end of the path has to move. A path that
/// starts outside (gap >= 0) ends on or above the plane that touches the solid where the path
/// enters. A path that starts inside leaves the shortest way from its start, by at most `rise` [m],
/// and never gets deeper. The loop over particles forces the inlining of `sweep`: as a call, it
/// would spend as much time on passing vectors through memory as on arithmetic.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

class TriangleSurface;

/// A dimension of a shape: a length or the three edge lengths of a box [m], > 0; a file of
/// triangles, its optional scale, or a switch.
template <class S, class Value>
struct ShapeKey {
  constexpr ShapeKey(const char* key, Value S::*where) : name(key), member(where) {}

  const char* name;  ///< in scene files
  Value S::*member;
};

/// A colour, each component from 0 to 1.
struct Rgba {
  float red, green, blue;
  float alpha = 1.0f;
};

/// A primitive of the drawing of a shape. Independent of the viewer: `cloth_ros` makes a marker of
/// each.
struct DrawnPart {
  enum class Kind {
    kBox,
    kSphere,
    kCylinder,   ///< its axis is z
    kBoxEdges,   ///< the twelve edges of a box, as lines
    kTriangles,  ///< those of `surface`
  };

  Kind kind = Kind::kBox;
  Vec3 size = Vec3::Ones();    ///< edge lengths, or diameters and height [m]
  Vec3 centre = Vec3::Zero();  ///< relative to the obstacle, in the axes of the shape [m]
  Rgba colour;
  std::shared_ptr<const TriangleSurface> surface = nullptr;  ///< of kTriangles
  std::string resource = {};  ///< URL of the file that has them, in units of `size`; may be empty
};

constexpr Rgba kRoundColour{0.98f, 0.62f, 0.42f};  ///< of spheres and rods

/// Contact of a particle's path with a solid.
struct SweepHit {
  Vec3 normal = Vec3::UnitZ();  ///< unit vector out of the solid
  double push = 0.0;            ///< distance that the end of the path must move along it [m], > 0
};

/// The level top of a solid: the most common contact, which has a fast path.
struct LevelTop {
  double halfX = 0.0;   ///< half its extent along the x axis of the world [m]
  double halfY = 0.0;   ///< half its extent along y [m]
  double height = 0.0;  ///< of the surface above the position of the obstacle [m]
  double level = 0.0;   ///< the height plus the margin, where particles rest [m]
};

}  // namespace cloth_sim
