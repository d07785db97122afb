#include "cloth_sim/surgery/path_embedder.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "cloth_sim/surgery/material_path.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// A corner of a path that turns by more than this becomes a vertex [cosine].
constexpr double kCornerCosine = 0.966;
/// Parts of something that are no more than this are none: parameters of crossings are then 0 or 1.
constexpr double kNegligible = 1e-9;
/// Faces with angles from here on are good enough not to look for better ones [rad].
constexpr double kGoodAngle = 0.17;
/// Where a path ends on the border, a vertex of the border this near slides there [edge lengths].
constexpr double kSlide = 0.45;
/// Faces that `locate` looks at.
constexpr std::size_t kSearched = 400;
/// Vertices that a detour may pass.
constexpr int kDetour = 64;

/// One way of making a vertex at a point of a path, and what it is worth.
struct Choice {
  enum class Kind { kBend, kMove, kSplitEdge, kSplitFace } kind = Kind::kBend;
  std::array<VertexId, 2> at{kNone, kNone};
  FaceId face = kNone;
  double angle = -1.0;  ///< smallest of the faces that it makes [rad]
};

void consider(const Choice& choice, Choice& best) {
  if (choice.angle > best.angle) best = choice;
}

/// The first that makes good faces; or else of those that are allowed the one that makes the best;
/// or else the last.
Choice choose(const Choice& first, const Choice& second, const Choice& third,
              const Choice& otherwise) {
  for (const Choice& choice : {first, second}) {
    if (choice.angle >= kGoodAngle) return choice;
  }
  Choice best;
  for (const Choice& choice : {first, second, third}) consider(choice, best);
  return best.angle < 0.0 ? otherwise : best;
}

VertexId carryOut(const Choice& choice, const Vec2& at, Remesher& remesher) {
  switch (choice.kind) {
    case Choice::Kind::kBend:
      return choice.at[0];
    case Choice::Kind::kMove:
      remesher.moveVertex(choice.at[0], at);
      return choice.at[0];
    case Choice::Kind::kSplitEdge:
      return remesher.splitEdge(choice.at[0], choice.at[1], at);
    case Choice::Kind::kSplitFace:
      return remesher.splitFace(choice.face, at);
  }
  return kNone;
}

/// Where a polyline leaves the faces around a vertex.
struct Exit {
  std::array<VertexId, 2> edge{kNone, kNone};
  double along = 0.0;       ///< of the edge, 0 ... 1
  Vec2 at = Vec2::Zero();   ///< [m]
  std::size_t segment = 0;  ///< of the polyline that crosses there
};

class Embedding {
 public:
  Embedding(const SurfacePath& path, PathEnd end, Remesher& remesher)
      : path_(path), end_(end), remesher_(remesher), mesh_(remesher.mesh()) {}

  EmbeddedPath run() {
    placeAnchors();
    result_.vertices.push_back(anchors_.front().vertex);
    for (std::size_t k = 0; k + 1 < anchors_.size(); ++k) walk(anchors_[k], anchors_[k + 1]);
    return std::move(result_);
  }

 private:
  /// A point of the path that becomes a vertex.
  struct Anchor {
    std::size_t point = 0;
    VertexId vertex = kNone;
  };

  const Vec2& point(std::size_t k) const { return path_.points[k].material; }
  void placeAnchors();
  bool isCorner(std::size_t k) const;
  bool isOnBorder(FaceId f, const Vec2& at) const;
  bool isOn(VertexId v, VertexId w, const Vec2& at) const;
  VertexId placeAnchor(const SurfacePoint& where);
  void walk(const Anchor& from, const Anchor& to);
  std::optional<Exit> findExit(VertexId centre, std::size_t segment, const Vec2& at,
                               std::size_t last) const;
  std::optional<Exit> crossing(VertexId centre, FaceId f, const Vec2& from, const Vec2& to,
                               double& nearest) const;
  VertexId makeVertex(const Exit& exit);
  void step(VertexId to);
  void detour(VertexId to);
  double distanceFromPath(VertexId v) const;
  void bent(VertexId to, const Vec2& from) {
    result_.deviation = std::max(result_.deviation, (mesh_.material(to) - from).norm());
  }

  const SurfacePath& path_;
  PathEnd end_;
  Remesher& remesher_;
  const TriangleMesh& mesh_;
  std::vector<Anchor> anchors_;
  EmbeddedPath result_;
};

bool Embedding::isCorner(std::size_t k) const {
  const Vec2 before = point(k) - point(k - 1);
  const Vec2 after = point(k + 1) - point(k);
  return before.dot(after) < kCornerCosine * before.norm() * after.norm();
}

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

bool Embedding::isOnBorder(FaceId f, const Vec2& at) const {
  for (int k = 0; k < 3; ++k) {
    const VertexId v = mesh_.face(f)[k];
    const VertexId w = mesh_.face(f)[(k + 1) % 3];
    if (mesh_.facesOnEdge(v, w)[1] == kNone && isOn(v, w, at)) return true;
  }
  return false;
}

/// Whether a point is on an edge, or the line that it is part of.
bool Embedding::isOn(VertexId v, VertexId w, const Vec2& at) const {
  const double beside = std::abs(doubleArea(mesh_.material(v), mesh_.material(w), at));
  return beside <= kNegligible * (mesh_.material(w) - mesh_.material(v)).squaredNorm();
}

VertexId Embedding::placeAnchor(const SurfacePoint& where) {
  const FaceId f = locate(mesh_, where);
  const Vec2& at = where.material;
  Choice bend;   // to the nearest corner
  Choice snap;   // moves a corner that is near
  Choice split;  // keeps all corners
  Choice pull;   // moves a corner from farther away
  const bool onBorder = isOnBorder(f, at);
  double nearest = std::numeric_limits<double>::infinity();
  double reach = 0.0;
  for (int k = 0; k < 3; ++k) {
    const VertexId v = mesh_.face(f)[k];
    const VertexId w = mesh_.face(f)[(k + 1) % 3];
    const VertexId u = mesh_.face(f)[(k + 2) % 3];
    const double distance = (mesh_.material(v) - at).norm();
    const double length = std::min((mesh_.material(w) - mesh_.material(v)).norm(),
                                   (mesh_.material(u) - mesh_.material(v)).norm());
    if (distance < nearest) {
      nearest = distance;
      reach = length;
      bend.at[0] = v;
    }
    const Choice move{Choice::Kind::kMove, {v, kNone}, kNone, remesher_.angleIfMoved(v, at)};
    const double part = onBorder ? kSlide : remesher_.limits().snap;
    consider(move, distance < part * length ? snap : pull);
    // An edge on the border or on another cut must be split where it is, others may also bend.
    const bool free = mesh_.facesOnEdge(v, w)[1] != kNone && !remesher_.isMarked(v, w);
    if (free || isOn(v, w, at)) {
      consider({Choice::Kind::kSplitEdge, {v, w}, kNone, remesher_.angleIfSplit(v, w, at)}, split);
    }
  }
  consider({Choice::Kind::kSplitFace, {}, f, remesher_.angleIfSplit(f, at)}, split);
  const bool there = nearest <= kNegligible * reach;
  const VertexId v = carryOut(there ? bend : choose(snap, split, pull, bend), at, remesher_);
  bent(v, at);
  remesher_.hold(v);
  return v;
}

void Embedding::walk(const Anchor& from, const Anchor& to) {
  std::size_t segment = from.point;
  Vec2 at = point(segment);
  // Every step gets farther along the path, so there is an end to it.
  while (true) {
    const VertexId centre = result_.vertices.back();
    if (centre == to.vertex && result_.vertices.size() > 1 && segment + 1 >= to.point) break;
    const std::optional<Exit> exit = findExit(centre, segment, at, to.point);
    if (!exit) break;
    step(makeVertex(*exit));
    segment = exit->segment;
    at = exit->at;
  }
  if (to.vertex != kNone && result_.vertices.back() != to.vertex) detour(to.vertex);
}

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

/// Where from-to leaves `f` through the edge opposite `centre`, if nearer to `from` than `nearest`.
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
  const double outward = cross(d, e);  // e runs counter-clockwise about centre
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

VertexId Embedding::makeVertex(const Exit& exit) {
  const auto [a, b] = exit.edge;
  const VertexId nearer = exit.along < 0.5 ? a : b;
  const double part = std::min(exit.along, 1.0 - exit.along);
  const Choice bend{Choice::Kind::kBend, {nearer, kNone}, kNone, 0.0};
  if (part <= kNegligible) return nearer;
  const Choice move{
      Choice::Kind::kMove, {nearer, kNone}, kNone, remesher_.angleIfMoved(nearer, exit.at)};
  const Choice split{
      Choice::Kind::kSplitEdge, {a, b}, kNone, remesher_.angleIfSplit(a, b, exit.at)};
  const bool snaps = part < remesher_.limits().snap;
  const Choice none;
  const Choice best = snaps ? choose(move, split, none, bend) : choose(none, split, move, bend);
  const VertexId v = carryOut(best, exit.at, remesher_);
  if (best.kind == Choice::Kind::kBend) bent(v, exit.at);
  return v;
}

void Embedding::step(VertexId to) {
  const VertexId from = result_.vertices.back();
  remesher_.mark(from, to);
  result_.vertices.push_back(to);
  result_.length += (mesh_.material(to) - mesh_.material(from)).norm();
}

double Embedding::distanceFromPath(VertexId v) const {
  MaterialPath line;
  for (const SurfacePoint& p : path_.points) line.push_back(p.material);
  return distanceTo(line, mesh_.material(v));
}

/// The shortest way along edges, where the last vertex is not next to the one before it.
void Embedding::detour(VertexId to) {
  const VertexId from = result_.vertices.back();
  std::vector<std::pair<VertexId, VertexId>> reached{{from, kNone}};  // vertex, where it came from
  std::set<VertexId> seen{from};
  for (std::size_t k = 0; k < reached.size() && seen.count(to) == 0; ++k) {
    for (VertexId w : mesh_.neighbours(reached[k].first)) {
      if (seen.insert(w).second) reached.emplace_back(w, static_cast<VertexId>(k));
    }
    if (k > static_cast<std::size_t>(kDetour)) break;
  }
  if (seen.count(to) == 0) return;
  std::vector<VertexId> way;
  auto at = std::find_if(reached.begin(), reached.end(), [to](auto& r) { return r.first == to; });
  while (at->second != kNone) {
    way.push_back(at->first);
    at = reached.begin() + at->second;
  }
  for (auto v = way.rbegin(); v != way.rend(); ++v) {
    step(*v);
    if (*v != to) result_.deviation = std::max(result_.deviation, distanceFromPath(*v));
  }
}

}  // namespace

EmbeddedPath embedPath(const SurfacePath& path, PathEnd end, Remesher& remesher) {
  return Embedding(path, end, remesher).run();
}

FaceId locate(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::deque<FaceId> open{point.face};
  std::set<FaceId> seen{point.face};
  FaceId best = point.face;
  double inside = -std::numeric_limits<double>::infinity();
  while (!open.empty() && seen.size() < kSearched) {
    const FaceId f = open.front();
    open.pop_front();
    const std::array<double, 3> weight = barycentric(mesh, f, point.material);
    const double now = *std::min_element(weight.begin(), weight.end());
    if (now > inside) {
      inside = now;
      best = f;
    }
    if (inside >= -1e-12) break;
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
