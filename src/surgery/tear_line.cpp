#include "tear_line.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "cloth_sim/surgery/remesher.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Number of rings around a tip, itself included, whose springs contribute to the stress there.
constexpr int kStressRings = 2;
/// Distance from a seam up to which a vertex counts as on it [m].
constexpr double kOnSeam = 1e-9;
/// Difference up to which parameters along a line, lengths [m] and angles [rad] count as equal.
constexpr double kSame = 1e-9;

/// Returns the sum of the angles of the faces at `v` [rad].
double angleAround(const TriangleMesh& mesh, VertexId v) {
  double sum = 0.0;
  for (FaceId f : mesh.facesAround(v)) {
    const Face& face = mesh.face(f);
    const auto k = std::find(face.begin(), face.end(), v) - face.begin();
    const Vec2 a = mesh.material(face[(k + 1) % 3]) - mesh.material(v);
    const Vec2 b = mesh.material(face[(k + 2) % 3]) - mesh.material(v);
    sum += std::acos(std::clamp(a.dot(b) / (a.norm() * b.norm()), -1.0, 1.0));
  }
  return sum;
}

/// Returns whether a path over the faces around `v` runs through their interior or along an inner
/// edge anywhere, and not only along the border.
bool runsInside(const TriangleMesh& mesh, VertexId v, const SurfacePath& path) {
  if (!mesh.isBoundary(v)) return true;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    for (const SurfacePoint& end : {path.points[k], path.points[k + 1]}) {
      // Test the point half-way to the vertex.
      const Vec2 p = 0.5 * (mesh.material(v) + end.material);
      int inside = 0;
      for (FaceId f : mesh.facesAround(v)) {
        const std::array<double, 3> weight = barycentric(mesh, f, p);
        const double least = *std::min_element(weight.begin(), weight.end());
        if (least > kSame) return true;
        if (least > -kSame) ++inside;
      }
      if (inside > 1 && (p - mesh.material(v)).norm() > kOnSeam) return true;
    }
  }
  return false;
}

/// The interval of the parameter t in which the line from + t d is inside a face; empty if
/// first > last.
struct FaceInterval {
  double first = 0.0;
  double last = 0.0;
  FaceId face = kNone;
};

/// Clips the part of a line with t in [low, high] against a face (Cyrus and Beck 1978).
FaceInterval clip(const TriangleMesh& mesh, FaceId f, const Vec2& from, const Vec2& d, double low,
                  double high) {
  FaceInterval inside{low, high, f};
  const Face& face = mesh.face(f);
  for (int k = 0; k < 3; ++k) {
    const Vec2& a = mesh.material(face[k]);
    const Vec2 e = mesh.material(face[(k + 1) % 3]) - a;
    const Vec2 r = from - a;
    const double height = cross(e, r);
    const double rate = cross(e, d);
    if (std::abs(rate) <= kSame * e.norm() * d.norm()) {
      if (height < -kSame * e.squaredNorm()) return {1.0, 0.0, f};
    } else if (rate > 0.0) {
      inside.first = std::max(inside.first, -height / rate);
    } else {
      inside.last = std::min(inside.last, -height / rate);
    }
  }
  return inside;
}

/// Returns the union of the intervals that are connected to `at`, with the face at its start.
FaceInterval connected(const std::vector<FaceInterval>& intervals, double at) {
  FaceInterval all{at, at, kNone};
  FaceId firstFace = kNone;
  for (bool grew = true; grew;) {
    grew = false;
    for (const FaceInterval& part : intervals) {
      const bool meets = part.first <= all.last + kSame && part.last >= all.first - kSame;
      if (!meets || part.first > part.last) continue;
      if (firstFace == kNone || part.first < all.first) {
        grew = grew || part.first < all.first;
        firstFace = part.face;
        all.first = std::min(all.first, part.first);
      }
      if (part.last > all.last) {
        all.last = part.last;
        grew = true;
      }
    }
  }
  all.face = firstFace;
  return all;
}

/// Returns the vertices within `kStressRings` rings of `v`, ascending.
std::vector<VertexId> ringsAround(const TriangleMesh& mesh, VertexId v) {
  std::vector<VertexId> vertices{v};
  for (int ring = 1; ring < kStressRings; ++ring) {
    std::vector<VertexId> wider = vertices;
    for (VertexId w : vertices) {
      const std::vector<VertexId> around = mesh.neighbours(w);
      wider.insert(wider.end(), around.begin(), around.end());
    }
    std::sort(wider.begin(), wider.end());
    wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
    vertices = std::move(wider);
  }
  return vertices;
}

}  // namespace

std::vector<FaceId> facesUnder(const TriangleMesh& mesh, const Spring& spring) {
  if (traitsOf(spring.kind).bridgesAVertex) return mesh.facesAround(spring.support[0]);
  std::vector<FaceId> faces;
  for (FaceId f : mesh.facesOnEdge(spring.support[0], spring.support[1])) {
    if (f != kNone) faces.push_back(f);
  }
  return faces;
}

bool isTip(const TriangleMesh& mesh, VertexId v) {
  return mesh.isBoundary(v) && angleAround(mesh, v) > 1.5 * M_PI + kSame;
}

Vec2 directionAhead(const TriangleMesh& mesh, VertexId tip) {
  Vec2 back = Vec2::Zero();
  for (VertexId w : mesh.neighbours(tip)) {
    if (mesh.facesOnEdge(tip, w)[1] != kNone) continue;
    back += (mesh.material(w) - mesh.material(tip)).normalized();
  }
  const double length = back.norm();
  return length > 0.0 ? Vec2(-back / length) : Vec2(Vec2::Zero());
}

VertexId borderVertex(const TriangleMesh& mesh, const std::vector<FaceId>& faces) {
  VertexId best = kNone;
  double most = 0.0;
  for (FaceId f : faces) {
    for (VertexId v : mesh.face(f)) {
      if (!mesh.isBoundary(v)) continue;
      const double angle = angleAround(mesh, v);
      if (angle > most + kSame) {
        most = angle;
        best = v;
      }
    }
  }
  return best;
}

Vec2 tensionDirection(const Model& model, const State& state, VertexId v) {
  Eigen::Matrix<double, 3, 2> stress = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::int32_t slot : model.springs.springsOnAny(ringsAround(model.mesh, v))) {
    const Spring& s = model.springs[slot];
    const Vec3 d = state.x[s.b] - state.x[s.a];
    const double length = d.norm();
    if (length == 0.0) continue;
    const Vec3 force = s.stiffness * (length - s.restLength) / length * d;
    stress += force * (model.mesh.material(s.b) - model.mesh.material(s.a)).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(stress.transpose() * stress);
  return axes.eigenvectors().col(1);
}

std::optional<double> crossingOf(const MaterialPath& seam, const Vec2& p, const Vec2& q) {
  for (std::size_t k = 0; k + 1 < seam.size(); ++k) {
    if (!separates({seam[k], seam[k + 1]}, p, q)) continue;
    const Vec2 d = seam[k + 1] - seam[k];
    const Vec2 e = q - p;
    const Vec2 r = p - seam[k];
    const double t = cross(r, e) / cross(d, e);
    return static_cast<double>(k) + std::clamp(t, 0.0, 1.0);
  }
  return std::nullopt;
}

std::optional<double> parameterOn(const MaterialPath& seam, const Vec2& p) {
  for (std::size_t k = 0; k + 1 < seam.size(); ++k) {
    if (distanceTo({seam[k], seam[k + 1]}, p) > kOnSeam) continue;
    const Vec2 d = seam[k + 1] - seam[k];
    return static_cast<double>(k) + std::clamp(d.dot(p - seam[k]) / d.squaredNorm(), 0.0, 1.0);
  }
  return std::nullopt;
}

std::optional<SurfacePath> seamOver(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                    const MaterialPath& seam, double at) {
  std::vector<FaceInterval> parts;
  for (std::size_t k = 0; k + 1 < seam.size(); ++k) {
    const auto offset = static_cast<double>(k);
    for (FaceId f : faces) {
      const FaceInterval part = clip(mesh, f, seam[k], seam[k + 1] - seam[k], 0.0, 1.0);
      if (part.first > part.last) continue;
      parts.push_back({offset + part.first, offset + part.last, f});
    }
  }
  const FaceInterval whole = connected(parts, at);
  const FaceId hint = whole.face != kNone ? whole.face : faces.front();
  const auto pointAt = [&](double s) -> Vec2 {
    const auto k = std::min(static_cast<std::size_t>(s), seam.size() - 2);
    return seam[k] + (s - static_cast<double>(k)) * (seam[k + 1] - seam[k]);
  };
  SurfacePath path;
  path.points.push_back({hint, pointAt(whole.first)});
  for (int k = static_cast<int>(std::floor(whole.first)) + 1; k < whole.last - kSame; ++k) {
    if (k > whole.first + kSame) path.points.push_back({hint, pointAt(k)});
  }
  path.points.push_back({hint, pointAt(whole.last)});
  if ((path.points.back().material - path.points.front().material).norm() <= kSame) {
    return std::nullopt;
  }
  return path;
}

std::optional<SurfacePath> seamFrom(const TriangleMesh& mesh, VertexId v,
                                    const MaterialPath& seam) {
  const std::optional<double> at = parameterOn(seam, mesh.material(v));
  if (!at) return std::nullopt;
  std::optional<SurfacePath> path = seamOver(mesh, mesh.facesAround(v), seam, *at);
  if (!path || !runsInside(mesh, v, *path)) return std::nullopt;
  if (!isTip(mesh, v)) return path;
  // Keep only the points ahead of the tip, and let the path start at the tip.
  const Vec2 onwards = directionAhead(mesh, v);
  const auto isAhead = [&](const SurfacePoint& p) {
    const Vec2 d = p.material - mesh.material(v);
    return d.norm() > kSame && d.dot(onwards) > 0.0;
  };
  std::vector<SurfacePoint>& points = path->points;
  points.erase(std::remove_if(points.begin(), points.end(),
                              [&](const SurfacePoint& p) { return !isAhead(p); }),
               points.end());
  if (points.empty()) return std::nullopt;
  const bool forwards = (points.front().material - mesh.material(v)).norm() <=
                        (points.back().material - mesh.material(v)).norm();
  if (!forwards) std::reverse(points.begin(), points.end());
  points.insert(points.begin(), {mesh.facesAround(v).front(), mesh.material(v)});
  return path;
}

std::optional<SurfacePath> lineThrough(const TriangleMesh& mesh, const std::vector<FaceId>& faces,
                                       const Vec2& middle, const Vec2& direction) {
  std::vector<FaceInterval> parts;
  constexpr double kFar = 1e6;  // [m]
  for (FaceId f : faces) parts.push_back(clip(mesh, f, middle, direction, -kFar, kFar));
  const FaceInterval whole = connected(parts, 0.0);
  if (whole.face == kNone || whole.last - whole.first <= kSame) return std::nullopt;
  SurfacePath path;
  path.points.push_back({whole.face, middle + whole.first * direction});
  path.points.push_back({whole.face, middle + whole.last * direction});
  return path;
}

std::optional<SurfacePath> rayFrom(const TriangleMesh& mesh, VertexId origin, const Vec2& direction,
                                   const Vec2& ahead) {
  const Vec2& from = mesh.material(origin);
  const Vec2 onwards = isTip(mesh, origin) ? directionAhead(mesh, origin) : Vec2(ahead - from);
  // Try the direction that leads onwards first, then the other.
  const double sign = direction.dot(onwards) >= 0.0 ? 1.0 : -1.0;
  for (const Vec2& d : {Vec2(sign * direction), Vec2(-sign * direction)}) {
    for (FaceId f : mesh.facesAround(origin)) {
      const Face& face = mesh.face(f);
      const auto k = std::find(face.begin(), face.end(), origin) - face.begin();
      const Vec2& a = mesh.material(face[(k + 1) % 3]);
      const Vec2& b = mesh.material(face[(k + 2) % 3]);
      const double towardsA = doubleArea(from, a, from + d);
      const double towardsB = doubleArea(from, from + d, b);
      if (towardsA < 0.0 || towardsB < 0.0) continue;
      const double t = doubleArea(from, a, b) / (towardsA + towardsB);
      SurfacePath path;
      path.points.push_back({f, from});
      path.points.push_back({f, from + t * d});
      return path;
    }
  }
  return std::nullopt;
}

}  // namespace cloth_sim
