#pragma once
/// \file On which side of each other points, lines and planes of a surface and of a cloth lie:
/// signs that contradict each other nowhere, however close the geometry.
///
/// Signs are those of exact arithmetic (a floating-point filter decides the clear cases; the method
/// is that of Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates", 1997). Ties are broken by simulation of simplicity (Edelsbrunner and Mücke, 1990):
/// the cloth counts as moved by (e, e^2, e^3), e positive and smaller than any number. What remains
/// zero are parallels, which no motion makes cross.

#include "cloth_sim/types.h"

namespace cloth_sim {

/// det(b - a, c - a, d - a), correct to nearly the last digit.
double exactOrientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the cloth's point `v` over the surface's plane (p, q, r), along (q - p) x (r - p).
int sideOfPlane(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& v);

/// Sign of the turn between the surface's line p -> q and the cloth's a -> b: positive if, looked
/// at against a -> b, the latter passes to the left of the former.
int sideOfLine(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b);

/// Sign of the surface's point `p` over the cloth's face (a, b, c), along (b - a) x (c - a).
int sideOfFace(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// Whether three points are not on one line.
bool spanPlane(const Vec3& p, const Vec3& q, const Vec3& r);

}  // namespace cloth_sim
