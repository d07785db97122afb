#include "cloth_sim/surgery/path_embedder.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "cloth_sim/surgery/material_path.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Cosine of the angle (15 degrees) by which a path must turn at a point for that point to become a
/// vertex.
constexpr double kCornerCosine = 0.966;
/// Fractions of a length up to which two points count as one, and a point as on a line.
constexpr double kNegligible = 1e-9;
/// Smallest angle from which a face is good enough, so that no other placement is considered [rad].
constexpr double kGoodAngle = 0.17;
/// Snapping distance for the ends of a path on the border, where vertices only slide along it, as a
/// fraction of the edge length.
constexpr double kSlide = 0.45;
/// Largest number of faces that `locate` visits.
constexpr std::size_t kMaxVisited = 400;
/// Largest number of vertices that the search for a way around visits.
constexpr std::size_t kMaxSearched = 64;

/// One way to place a vertex at a point of a path.
struct Placement {
  enum class Kind {
    kUseVertex,  ///< none: take an existing vertex as it is
    kMove,       ///< move vertex[0] to the point
    kSplitEdge,  ///< split the edge {vertex[0], vertex[1]} at the point
    kSplitFace,  ///< split the face at the point
  };
  Kind kind = Kind::kUseVertex;
  std::array<VertexId, 2> vertex{kNone, kNone};
  FaceId face = kNone;
  double angle = -1.0;  ///< smallest of the faces that it creates [rad]; negative: not allowed
};

/// Keeps the placement with the larger angle.
void keepBetter(const Placement& candidate, Placement& best) {
  if (candidate.angle > best.angle) best = candidate;
}

/// Chooses the first of two placements that makes good faces. If neither does, it chooses the one
/// of three with the largest angle, and `fallback` if none of them is allowed.
/// \param good  smallest angle of good faces [rad], >= 0.
Placement choose(const Placement& first, const Placement& second, const Placement& third,
                 const Placement& fallback, double good = kGoodAngle) {
  for (const Placement& placement : {first, second}) {
    if (placement.angle >= good) return placement;
  }
  Placement best;
  for (const Placement& placement : {first, second, third}) keepBetter(placement, best);
  return best.angle < 0.0 ? fallback : best;
}

/// Edits the mesh as a placement says. \return the vertex at the point.
VertexId apply(const Placement& placement, const Vec2& at, Remesher& remesher) {
  switch (placement.kind) {
    case Placement::Kind::kUseVertex:
      return placement.vertex[0];
    case Placement::Kind::kMove:
      remesher.moveVertex(placement.vertex[0], at);
      return placement.vertex[0];
    case Placement::Kind::kSplitEdge:
      return remesher.splitEdge(placement.vertex[0], placement.vertex[1], at);
    case Placement::Kind::kSplitFace:
      return remesher.splitFace(placement.face, at);
  }
  return kNone;
}

/// The point at which a path leaves the faces around a vertex.
struct Exit {
  std::array<VertexId, 2> edge{kNone, kNone};  ///< an outer edge of those faces
  double along = 0.0;                          ///< position on the edge, 0 ... 1
  Vec2 at = Vec2::Zero();                      ///< material coordinates [m]
  std::size_t segment = 0;                     ///< segment of the path that crosses the edge
};

/// The way along edges from one vertex to another that stays nearest to a line: its detour, the
/// largest distance from the line of its vertices and of the middles of its edges, is the smallest;
/// of equal ways it has the fewest edges (Dijkstra 1959, with the larger of two detours for their
/// sum).
class NearestWay {
 public:
  NearestWay(const TriangleMesh& mesh, const MaterialPath& line, VertexId from, VertexId to)
      : mesh_(mesh), line_(line) {
    reach({0.0, 0, from}, kNone);
    for (std::size_t k = 0; k < kMaxSearched && !open_.empty(); ++k) {
      const Reached next = *open_.begin();
      open_.erase(open_.begin());
      done_.insert(next.vertex);
      if (next.vertex == to) {
        collect(next, from);
        return;
      }
      for (const VertexId w : mesh_.neighbours(next.vertex)) {
        const double detour = std::max(next.detour, detourOf(next.vertex, w));
        reach({detour, next.edges + 1, w}, next.vertex);
      }
    }
  }

  /// Vertices from the one after `from` up to `to`; none if the search was too long.
  const std::vector<VertexId>& vertices() const { return vertices_; }
  double detour() const { return detour_; }  ///< [m]

 private:
  struct Reached {
    double detour = 0.0;  ///< [m]
    int edges = 0;
    VertexId vertex = kNone;
    bool operator<(const Reached& other) const {
      return std::tie(detour, edges, vertex) < std::tie(other.detour, other.edges, other.vertex);
    }
  };

  double detourOf(VertexId v, VertexId w) const {
    const Vec2 middle = 0.5 * (mesh_.material(v) + mesh_.material(w));
    return std::max(distanceTo(line_, mesh_.material(w)), distanceTo(line_, middle));
  }

  void reach(const Reached& it, VertexId previous) {
    if (done_.count(it.vertex) != 0) return;
    const auto known = best_.find(it.vertex);
    if (known != best_.end()) {
      if (!(it < known->second.first)) return;
      open_.erase(known->second.first);
    }
    best_[it.vertex] = {it, previous};
    open_.insert(it);
  }

  void collect(const Reached& last, VertexId from) {
    detour_ = last.detour;
    for (VertexId v = last.vertex; v != from; v = best_.at(v).second) vertices_.push_back(v);
    std::reverse(vertices_.begin(), vertices_.end());
  }

  const TriangleMesh& mesh_;
  const MaterialPath& line_;
  std::set<Reached> open_;
  std::set<VertexId> done_;
  std::map<VertexId, std::pair<Reached, VertexId>> best_;  ///< with the vertex before
  std::vector<VertexId> vertices_;
  double detour_ = 0.0;
};

/// The embedding of one path.
class Embedding {
 public:
  Embedding(const SurfacePath& path, PathEnd end, Remesher& remesher)
      : path_(path), end_(end), remesher_(remesher), mesh_(remesher.mesh()) {}

  EmbeddedPath run() {
    placeAnchors();
    result_.vertices.push_back(anchors_.front().vertex);
    for (std::size_t k = 0; k + 1 < anchors_.size(); ++k) trace(anchors_[k], anchors_[k + 1]);
    return std::move(result_);
  }

 private:
  /// A point of the path that becomes a vertex: an end or a corner.
  struct Anchor {
    std::size_t point = 0;    ///< index into the points of the path
    VertexId vertex = kNone;  ///< kNone for a last point where the path need not end exactly
  };
  /// The ways to place an anchor in a face.
  struct AnchorPlacements {
    Placement nearest;  ///< use the nearest corner as it is
    Placement snap;     ///< move a corner within the snapping distance
    Placement split;    ///< split an edge or the face
    Placement pull;     ///< move a corner from farther away, or split an edge beside the point
    bool isAtCorner = false;  ///< the point coincides with the nearest corner
  };

  const Vec2& point(std::size_t k) const { return path_.points[k].material; }
  void placeAnchors();
  bool isCorner(std::size_t k) const;
  bool isOnBorder(FaceId f, const Vec2& at) const;
  bool isOn(VertexId v, VertexId w, const Vec2& at) const;
  VertexId placeAnchor(const SurfacePoint& where);
  AnchorPlacements anchorPlacements(FaceId f, const Vec2& at) const;
  void trace(const Anchor& from, const Anchor& to);
  std::optional<Exit> findExit(VertexId centre, std::size_t segment, const Vec2& at,
                               std::size_t last) const;
  std::optional<Exit> crossing(VertexId centre, FaceId f, const Vec2& from, const Vec2& to,
                               double& nearest) const;
  VertexId makeVertex(const Exit& exit);
  void append(VertexId to);
  void appendNearestWay(VertexId to, const MaterialPath& line);
  void noteDeviation(VertexId to, const Vec2& from) {
    result_.deviation = std::max(result_.deviation, (mesh_.material(to) - from).norm());
  }

  const SurfacePath& path_;
  PathEnd end_;
  Remesher& remesher_;
  const TriangleMesh& mesh_;
  std::vector<Anchor> anchors_;
  EmbeddedPath result_;
};

/// Returns whether the path turns sharply at an inner point.
bool Embedding::isCorner(std::size_t k) const {
  const Vec2 before = point(k) - point(k - 1);
  const Vec2 after = point(k + 1) - point(k);
  return before.dot(after) < kCornerCosine * before.norm() * after.norm();
}

/// Makes vertices of the ends and corners of the path.
void Embedding::placeAnchors() {
  const std::size_t last = path_.points.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    if (k == 0 || (k < last && isCorner(k))) {
      anchors_.push_back({k, placeAnchor(path_.points[k])});
    }
  }
  if (path_.isClosed()) {
    anchors_.push_back({last, anchors_.front().vertex});
  } else if (end_ == PathEnd::kExact) {
    anchors_.push_back({last, placeAnchor(path_.points[last])});
  } else {
    anchors_.push_back({last, kNone});
  }
}

/// Returns whether a point of a face is on a border edge of the face.
bool Embedding::isOnBorder(FaceId f, const Vec2& at) const {
  for (int k = 0; k < 3; ++k) {
    const VertexId v = mesh_.face(f)[k];
    const VertexId w = mesh_.face(f)[(k + 1) % 3];
    if (mesh_.facesOnEdge(v, w)[1] == kNone && isOn(v, w, at)) return true;
  }
  return false;
}

/// Returns whether a point is on the line of an edge.
bool Embedding::isOn(VertexId v, VertexId w, const Vec2& at) const {
  const double beside = std::abs(doubleArea(mesh_.material(v), mesh_.material(w), at));
  return beside <= kNegligible * (mesh_.material(w) - mesh_.material(v)).squaredNorm();
}

VertexId Embedding::placeAnchor(const SurfacePoint& where) {
  const Vec2& at = where.material;
  const AnchorPlacements ways = anchorPlacements(locate(mesh_, where), at);
  // Where nothing moves, what is not exact takes the end off the line: any allowed face will do.
  const double good = remesher_.limits().keepsSurface ? 0.0 : kGoodAngle;
  const VertexId v = apply(
      ways.isAtCorner ? ways.nearest : choose(ways.snap, ways.split, ways.pull, ways.nearest, good),
      at, remesher_);
  noteDeviation(v, at);
  remesher_.hold(v);
  return v;
}

Embedding::AnchorPlacements Embedding::anchorPlacements(FaceId f, const Vec2& at) const {
  AnchorPlacements ways;
  const double snap = isOnBorder(f, at) ? kSlide : remesher_.limits().snap;
  double nearest = std::numeric_limits<double>::infinity();
  double edgeAtNearest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const VertexId v = mesh_.face(f)[k];
    const VertexId w = mesh_.face(f)[(k + 1) % 3];
    const VertexId u = mesh_.face(f)[(k + 2) % 3];
    const double distance = (mesh_.material(v) - at).norm();
    const double length = std::min((mesh_.material(w) - mesh_.material(v)).norm(),
                                   (mesh_.material(u) - mesh_.material(v)).norm());
    if (distance < nearest) {
      nearest = distance;
      edgeAtNearest = length;
      ways.nearest.vertex[0] = v;
    }
    const Placement move{Placement::Kind::kMove, {v, kNone}, kNone, remesher_.angleIfMoved(v, at)};
    keepBetter(move, distance < snap * length ? ways.snap : ways.pull);
    // A split may leave the line of an inner edge, but not that of a border or a marked edge.
    const bool mayBend = mesh_.facesOnEdge(v, w)[1] != kNone && !remesher_.isMarked(v, w);
    const bool isOnEdge = isOn(v, w, at);
    if (mayBend || isOnEdge) {
      const bool isExact = isOnEdge || !remesher_.limits().keepsSurface;
      keepBetter({Placement::Kind::kSplitEdge, {v, w}, kNone, remesher_.angleIfSplit(v, w, at)},
                 isExact ? ways.split : ways.pull);
    }
  }
  keepBetter({Placement::Kind::kSplitFace, {}, f, remesher_.angleIfSplit(f, at)}, ways.split);
  ways.isAtCorner = nearest <= kNegligible * edgeAtNearest;
  return ways;
}

/// Appends the vertices of the path from one anchor to the next.
void Embedding::trace(const Anchor& from, const Anchor& to) {
  std::size_t segment = from.point;
  Vec2 at = point(segment);
  // Each exit is farther along the path than the last one, so the loop ends.
  while (true) {
    const VertexId centre = result_.vertices.back();
    if (centre == to.vertex && result_.vertices.size() > 1 && segment + 1 >= to.point) break;
    const std::optional<Exit> exit = findExit(centre, segment, at, to.point);
    if (!exit) break;
    append(makeVertex(*exit));
    segment = exit->segment;
    at = exit->at;
  }
  if (to.vertex == kNone || result_.vertices.back() == to.vertex) return;
  MaterialPath rest{at};
  for (std::size_t k = segment + 1; k < to.point; ++k) rest.push_back(point(k));
  rest.push_back(point(to.point));
  appendNearestWay(to.vertex, rest);
}

/// Finds the first exit of the path from the faces around `centre`.
/// \param segment  segment of the path at which the search starts.
/// \param at       point on that segment.
/// \param last     index of the last point of the path that counts.
std::optional<Exit> Embedding::findExit(VertexId centre, std::size_t segment, const Vec2& at,
                                        std::size_t last) const {
  Vec2 from = at;
  for (std::size_t k = segment; k < last; ++k) {
    double nearest = std::numeric_limits<double>::infinity();
    std::optional<Exit> first;
    for (FaceId f : mesh_.facesAround(centre)) {
      if (auto found = crossing(centre, f, from, point(k + 1), nearest)) first = found;
    }
    if (first) {
      first->segment = k;
      return first;
    }
    from = point(k + 1);
  }
  return std::nullopt;
}

/// Intersects from-to with the edge of `f` opposite `centre`, where it leaves `f`.
/// \param nearest  parameter along from-to below which the exit counts; set to that of the exit.
std::optional<Exit> Embedding::crossing(VertexId centre, FaceId f, const Vec2& from, const Vec2& to,
                                        double& nearest) const {
  const Face& face = mesh_.face(f);
  const auto k = std::find(face.begin(), face.end(), centre) - face.begin();
  Exit exit;
  exit.edge = {face[(k + 1) % 3], face[(k + 2) % 3]};
  const Vec2& a = mesh_.material(exit.edge[0]);
  const Vec2& b = mesh_.material(exit.edge[1]);
  const Vec2 d = to - from;
  const Vec2 e = b - a;
  const double outward = cross(d, e);  // positive if from-to leaves, as e runs counter-clockwise
  if (outward <= kNegligible * d.norm() * e.norm()) return std::nullopt;
  const Vec2 r = a - from;
  const double along = cross(r, e) / outward;
  const double t = cross(r, d) / outward;
  const bool meets = along >= -kNegligible && along <= 1.0 + kNegligible && t >= -kNegligible &&
                     t <= 1.0 + kNegligible;
  if (!meets || along >= nearest) return std::nullopt;
  nearest = along;
  exit.along = std::clamp(t, 0.0, 1.0);
  exit.at = a + exit.along * e;
  return exit;
}

/// Places a vertex at an exit.
VertexId Embedding::makeVertex(const Exit& exit) {
  const auto [a, b] = exit.edge;
  const VertexId nearer = exit.along < 0.5 ? a : b;
  const double fraction = std::min(exit.along, 1.0 - exit.along);
  if (fraction <= kNegligible) return nearer;
  const Placement bend{Placement::Kind::kUseVertex, {nearer, kNone}, kNone, 0.0};
  const Placement move{
      Placement::Kind::kMove, {nearer, kNone}, kNone, remesher_.angleIfMoved(nearer, exit.at)};
  const Placement split{
      Placement::Kind::kSplitEdge, {a, b}, kNone, remesher_.angleIfSplit(a, b, exit.at)};
  const bool snaps = fraction < remesher_.limits().snap;
  const Placement none;
  const Placement best = snaps ? choose(move, split, none, bend) : choose(none, split, move, bend);
  const VertexId v = apply(best, exit.at, remesher_);
  if (best.kind == Placement::Kind::kUseVertex) noteDeviation(v, exit.at);
  return v;
}

/// Appends a neighbour of the last vertex, and marks the edge between them.
void Embedding::append(VertexId to) {
  const VertexId from = result_.vertices.back();
  remesher_.mark(from, to);
  result_.vertices.push_back(to);
  result_.length += (mesh_.material(to) - mesh_.material(from)).norm();
}

/// Appends the way along edges from the last vertex to `to` that stays nearest to `line`; nothing
/// if that is too far. Only needed where a path bent so that its last vertex is not a neighbour of
/// the one before.
void Embedding::appendNearestWay(VertexId to, const MaterialPath& line) {
  const NearestWay way(mesh_, line, result_.vertices.back(), to);
  for (const VertexId v : way.vertices()) append(v);
  result_.deviation = std::max(result_.deviation, way.detour());
}

}  // namespace

EmbeddedPath embedPath(const SurfacePath& path, PathEnd end, Remesher& remesher) {
  return Embedding(path, end, remesher).run();
}

FaceId locate(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::deque<FaceId> open{point.face};
  std::set<FaceId> seen{point.face};
  FaceId best = point.face;
  double largest = -std::numeric_limits<double>::infinity();  // smallest barycentric coordinate
  while (!open.empty() && seen.size() < kMaxVisited) {
    const FaceId f = open.front();
    open.pop_front();
    const std::array<double, 3> weight = barycentric(mesh, f, point.material);
    const double smallest = *std::min_element(weight.begin(), weight.end());
    if (smallest > largest) {
      largest = smallest;
      best = f;
    }
    if (largest >= -1e-12) break;
    const Face& face = mesh.face(f);
    for (int k = 0; k < 3; ++k) {
      for (FaceId other : mesh.facesOnEdge(face[k], face[(k + 1) % 3])) {
        if (other != kNone && seen.insert(other).second) open.push_back(other);
      }
    }
  }
  return best;
}

}  // namespace cloth_sim
