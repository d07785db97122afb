#pragma once
/// \file Exact geometric predicates between a swept surface and a cloth. Their signs never
/// contradict each other, however close the geometry is.
///
/// The signs are those of exact arithmetic; a floating-point filter decides clear cases (Shewchuk
/// 1997, Adaptive precision floating-point arithmetic and fast robust geometric predicates). Ties
/// are broken by simulation of simplicity (Edelsbrunner and Mücke 1990): the cloth counts as
/// displaced by (e, e^2, e^3) with an infinitesimal e > 0. Only parallels, which no displacement
/// makes cross, give zero.

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Returns det(b - a, c - a, d - a) with an error of about one unit in the last place.
double exactOrientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Returns on which side of the plane (p, q, r) of the surface a point `v` of the cloth lies:
/// positive in the direction of (q - p) x (r - p).
int sideOfPlane(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& v);

/// Returns on which side the line a -> b of the cloth passes the line p -> q of the surface:
/// positive if, seen against the direction a -> b, it passes to the left of p -> q.
int sideOfLine(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b);

/// Returns on which side of the face (a, b, c) of the cloth a point `p` of the surface lies:
/// positive in the direction of (b - a) x (c - a).
int sideOfFace(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// Returns whether three points are not collinear.
bool spanPlane(const Vec3& p, const Vec3& q, const Vec3& r);

}  // namespace cloth_sim
