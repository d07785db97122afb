#include "untangle.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace cloth_sim {
namespace {

/// Passes without fewer pairs after which nothing more is tried.
constexpr int kMostInVain = 80;
/// Averages over neighbours, so that what moves takes along what is around it.
constexpr int kSmoothings = 3;
/// Least sine of the angle between an edge and a face that it crosses, for the direction of motion.
constexpr double kLeastSine = 0.1;
/// Below this, the change of length with a motion counts as a bend rather than an end of the line.
constexpr double kBend = 0.1;

/// An edge that passes through a face.
struct Crossing {
  VertexId from = kNone;  ///< of the edge
  VertexId to = kNone;
  FaceId face = kNone;
  double along = 0.0;              ///< place on the edge, 0 ... 1
  std::array<double, 3> within{};  ///< barycentric coordinates in the face
};

Vec3 normalOf(const Face& face, const std::vector<Vec3>& x) {
  return (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]);
}

/// Finds where an edge passes through a face. \return false if it does not.
bool cross(const Face& face, const std::vector<Vec3>& x, Crossing& crossing) {
  if (contains(face, crossing.from) || contains(face, crossing.to)) return false;
  const Vec3 normal = normalOf(face, x);
  const double from = normal.dot(x[crossing.from] - x[face[0]]);
  const double to = normal.dot(x[crossing.to] - x[face[0]]);
  if (!(from * to < 0.0)) return false;
  crossing.along = from / (from - to);
  const Vec3 at = x[crossing.from] + crossing.along * (x[crossing.to] - x[crossing.from]);
  const double square = normal.squaredNorm();
  for (int k = 0; k < 3; ++k) {
    const Vec3& b = x[face[(k + 1) % 3]];
    const Vec3& c = x[face[(k + 2) % 3]];
    crossing.within[k] = normal.dot((b - at).cross(c - at)) / square;
    if (!(crossing.within[k] >= 0.0)) return false;
  }
  return true;
}

/// Lists the edges of faces that pass through the other face of their pair, each once.
std::vector<Crossing> findCrossings(const TriangleMesh& mesh, const FacePairList& pairs,
                                    const std::vector<Vec3>& x) {
  std::vector<Crossing> crossings;
  std::set<std::array<std::int32_t, 3>> known;
  for (const auto& [first, second] : pairs) {
    for (const auto& [of, through] : {std::pair(first, second), std::pair(second, first)}) {
      const Face& edges = mesh.face(of);
      for (int k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(edges[k], edges[(k + 1) % 3]);
        Crossing crossing{a, b, through, 0.0, {}};
        if (!cross(mesh.face(through), x, crossing)) continue;
        if (known.insert({a, b, through}).second) crossings.push_back(crossing);
      }
    }
  }
  return crossings;
}

/// The motion of an edge against a face, per length, that shortens the line of intersection most:
/// the sum over the faces at the edge of r - (e.r) / (e.n) n, where r goes along the line into the
/// face, e along the edge, and n is normal to the face that it crosses.
Vec3 shorteningMotion(const TriangleMesh& mesh, const Crossing& crossing,
                      const std::vector<Vec3>& x) {
  const Vec3 edge = (x[crossing.to] - x[crossing.from]).normalized();
  const Vec3 normal = normalOf(mesh.face(crossing.face), x).normalized();
  const double sine = edge.dot(normal);
  const double divisor = std::copysign(std::max(std::abs(sine), kLeastSine), sine);
  Vec3 motion = Vec3::Zero();
  for (const FaceId f : mesh.facesOnEdge(crossing.from, crossing.to)) {
    if (f == kNone) continue;
    const Face& face = mesh.face(f);
    Vec3 line = normalOf(face, x).cross(normal);
    const double length = line.norm();
    if (!(length > 0.0)) continue;
    line /= length;
    for (const VertexId v : face) {  // the corner beside the edge
      if (v == crossing.from || v == crossing.to) continue;
      const Vec3 inward = x[v] - x[crossing.from];
      if (line.dot(inward - edge.dot(inward) * edge) < 0.0) line = -line;
    }
    motion += line - edge.dot(line) / divisor * normal;
  }
  return motion / std::sqrt(motion.squaredNorm() + kBend * kBend);
}

/// Motions of vertices, and how much asked for them.
struct Motions {
  std::vector<Vec3> sum;
  std::vector<double> weight;

  explicit Motions(std::size_t count) : sum(count, Vec3::Zero()), weight(count, 0.0) {}
  void add(VertexId v, double share, const Vec3& motion) {
    sum[v] += share * motion;
    weight[v] += std::abs(share);
  }
};

/// Replaces each motion by the mean of it and those of its neighbours.
void smooth(const TriangleMesh& mesh, std::vector<Vec3>& motion) {
  const std::vector<Vec3> before = motion;
  std::vector<int> count(motion.size(), 2);
  for (std::size_t v = 0; v < motion.size(); ++v) motion[v] *= 2.0;
  for (const Face& face : mesh.faces()) {
    for (int k = 0; k < 3; ++k) {
      motion[face[k]] += before[face[(k + 1) % 3]];
      ++count[face[k]];
    }
  }
  for (std::size_t v = 0; v < motion.size(); ++v) motion[v] /= static_cast<double>(count[v]);
}

/// The motions of a pass, by vertex [m].
std::vector<Vec3> motionsOf(const TriangleMesh& mesh, const UntangleOptions& options,
                            const std::vector<Crossing>& crossings, const std::vector<Vec3>& x) {
  Motions motions(x.size());
  for (const Crossing& crossing : crossings) {
    const Vec3 motion = shorteningMotion(mesh, crossing, x);
    motions.add(crossing.from, 1.0 - crossing.along, motion);
    motions.add(crossing.to, crossing.along, motion);
    const Face& face = mesh.face(crossing.face);
    for (int k = 0; k < 3; ++k) motions.add(face[k], -crossing.within[k], motion);
  }
  std::vector<Vec3>& motion = motions.sum;
  for (std::size_t v = 0; v < motion.size(); ++v) {
    if (motions.weight[v] > 0.0) motion[v] /= std::max(motions.weight[v], 0.2);
  }
  for (int k = 0; k < kSmoothings; ++k) smooth(mesh, motion);
  double most = 0.0;
  for (std::size_t v = 0; v < motion.size(); ++v) {
    if (options.isHeld[v] != 0) motion[v].setZero();
    most = std::max(most, motion[v].norm());
  }
  if (most > 0.0) {
    for (Vec3& it : motion) it *= options.step / most;
  }
  return std::move(motions.sum);
}

}  // namespace

Untangled untangle(const TriangleMesh& mesh, const UntangleOptions& options,
                   const std::function<FacePairList(const std::vector<Vec3>&)>& overlap,
                   std::vector<Vec3>& x) {
  const std::vector<Vec3> start = x;
  FacePairList pairs = overlap(x);
  Untangled result;
  result.pairs = static_cast<int>(pairs.size());
  result.left = result.pairs;
  std::vector<Vec3> best = x;
  for (int inVain = 0; !pairs.empty() && inVain < kMostInVain; ++inVain) {
    if (result.passes == options.mostPasses) break;
    const std::vector<Crossing> crossings = findCrossings(mesh, pairs, x);
    if (crossings.empty()) break;  // faces touch, and nothing says in which direction they part
    const std::vector<Vec3> motion = motionsOf(mesh, options, crossings, x);
    for (std::size_t v = 0; v < x.size(); ++v) x[v] += motion[v];
    ++result.passes;
    pairs = overlap(x);
    if (static_cast<int>(pairs.size()) >= result.left) continue;
    result.left = static_cast<int>(pairs.size());
    best = x;
    inVain = 0;
  }
  x = best;
  for (std::size_t v = 0; v < x.size(); ++v) {
    result.farthest = std::max(result.farthest, (x[v] - start[v]).norm());
  }
  return result;
}

}  // namespace cloth_sim
