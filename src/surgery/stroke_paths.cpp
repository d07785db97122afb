#include <algorithm>
#include <tuple>

#include "stroke_pieces.h"

namespace cloth_sim {
namespace {

double distanceToSegment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 d = b - a;
  const double length = d.squaredNorm();
  const double part = length > 0.0 ? std::clamp(d.dot(p - a) / length, 0.0, 1.0) : 0.0;
  return (a + part * d - p).norm();
}

/// Leaves out points inside a face that the path does not need (Douglas and Peucker, 1973).
class Simplifier {
 public:
  Simplifier(const std::vector<PathPiece>& pieces, double tolerance)
      : pieces_(pieces), tolerance_(tolerance) {}

  std::vector<PathPiece> run() {
    std::size_t first = 0;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      const bool ends = k + 1 == pieces_.size() || pieces_[k].to.need == Need::kAlways ||
                        pieces_[k].face != pieces_[k + 1].face;
      if (!ends) continue;
      simplify(first, k);
      first = k + 1;
    }
    return std::move(result_);
  }

 private:
  /// One piece instead of those from `first` to `last`, or more if that takes it too far.
  void simplify(std::size_t first, std::size_t last) {
    const Vec3& a = pieces_[first].from.position;
    const Vec3& b = pieces_[last].to.position;
    double farthest = 0.0;
    std::size_t split = first;
    for (std::size_t k = first; k < last; ++k) {
      if (pieces_[k].to.need == Need::kNever) continue;
      const double distance = distanceToSegment(a, b, pieces_[k].to.position);
      if (distance <= farthest) continue;
      farthest = distance;
      split = k;
    }
    if (farthest <= tolerance_) {
      result_.push_back({pieces_[first].from, pieces_[last].to, pieces_[first].face});
      return;
    }
    simplify(first, split);
    simplify(split + 1, last);
  }

  const std::vector<PathPiece>& pieces_;
  const double tolerance_;
  std::vector<PathPiece> result_;
};

SurfacePath toPath(const PathChain& chain) {
  SurfacePath path;
  path.points.reserve(chain.pieces.size() + 1);
  for (const PathPiece& piece : chain.pieces) {
    path.points.push_back({piece.face, piece.from.material});
  }
  path.points.push_back({chain.pieces.back().face, chain.pieces.back().to.material});
  if (chain.closed) path.points.back() = path.points.front();
  return path;
}

bool startsEarlier(const PathChain& a, const PathChain& b) {
  const PathPiece& p = a.pieces.front();
  const PathPiece& q = b.pieces.front();
  return std::tie(p.from.at.stroke, p.from.at.blade, p.face) <
         std::tie(q.from.at.stroke, q.from.at.blade, q.face);
}

}  // namespace

std::vector<SurfacePath> toPaths(std::vector<PathChain> chains, double tolerance) {
  std::stable_sort(chains.begin(), chains.end(), startsEarlier);
  std::vector<SurfacePath> paths;
  paths.reserve(chains.size());
  for (PathChain& chain : chains) {
    chain.pieces = Simplifier(chain.pieces, tolerance).run();
    paths.push_back(toPath(chain));
  }
  return paths;
}

}  // namespace cloth_sim
