#include <algorithm>
#include <cmath>
#include <tuple>

#include "stroke_pieces.h"

namespace cloth_sim {
namespace {

/// Points this near to each other, in lengths of the face's edges, are one point.
constexpr double kSamePoint = 1e-12;
/// Movements along the stroke and along the blade that count as none.
constexpr double kNoAdvance = 1e-9;

/// The two ends of a piece are numbered 2 k and 2 k + 1.
using EndId = std::int32_t;

PathPiece reversed(const PathPiece& piece) { return {piece.to, piece.from, piece.face}; }

/// By end of a piece, the end of another one that shares its node; kNone where the path ends.
std::vector<EndId> partnersOf(const std::vector<PathPiece>& pieces) {
  std::vector<std::pair<PathNode, EndId>> ends;
  ends.reserve(2 * pieces.size());
  for (const PathPiece& piece : pieces) {
    ends.emplace_back(piece.from.node, static_cast<EndId>(ends.size()));
    ends.emplace_back(piece.to.node, static_cast<EndId>(ends.size()));
  }
  std::sort(ends.begin(), ends.end());
  std::vector<EndId> partner(ends.size(), kNone);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    if (ends[k].first != ends[k + 1].first) continue;
    partner[ends[k].second] = ends[k + 1].second;
    partner[ends[k + 1].second] = ends[k].second;
    ++k;
  }
  return partner;
}

/// Follows pieces from end to end.
class Walk {
 public:
  explicit Walk(const std::vector<PathPiece>& pieces)
      : pieces_(pieces), partner_(partnersOf(pieces)), taken_(pieces.size(), false) {}

  std::vector<PathChain> run() {
    const auto ends = static_cast<EndId>(partner_.size());
    for (EndId end = 0; end < ends; ++end) {
      if (partner_[end] == kNone) follow(end, false);
    }
    for (EndId end = 0; end < ends; end += 2) follow(end, true);
    return std::move(chains_);
  }

 private:
  void follow(EndId start, bool closed) {
    PathChain chain;
    chain.closed = closed;
    for (EndId end = start; end != kNone && !taken_[end / 2]; end = partner_[end ^ 1]) {
      taken_[end / 2] = true;
      const PathPiece& piece = pieces_[end / 2];
      chain.pieces.push_back(end % 2 == 0 ? piece : reversed(piece));
    }
    if (!chain.pieces.empty()) chains_.push_back(std::move(chain));
  }

  const std::vector<PathPiece>& pieces_;
  std::vector<EndId> partner_;
  std::vector<bool> taken_;
  std::vector<PathChain> chains_;
};

bool goesBackwards(const PathChain& chain) {
  double advance = 0.0;
  double outwards = 0.0;
  for (const PathPiece& piece : chain.pieces) {
    advance += piece.to.at.stroke - piece.from.at.stroke;
    outwards += piece.to.at.blade - piece.from.at.blade;
  }
  return std::abs(advance) > kNoAdvance ? advance < 0.0 : outwards < 0.0;
}

/// Lets a closed chain start where the blade reaches it first.
void rotateToStart(PathChain& chain) {
  const auto rank = [](const PathPiece& piece) {
    return std::make_tuple(piece.from.need != Need::kAlways, piece.from.at.stroke,
                           piece.from.at.blade);
  };
  const auto first =
      std::min_element(chain.pieces.begin(), chain.pieces.end(),
                       [&](const PathPiece& a, const PathPiece& b) { return rank(a) < rank(b); });
  std::rotate(chain.pieces.begin(), first, chain.pieces.end());
}

bool hasLength(const PathPiece& piece, const TriangleMesh& mesh) {
  const auto& [a, b, c] = mesh.face(piece.face);
  const double size = std::max((mesh.material(b) - mesh.material(a)).norm(),
                               (mesh.material(c) - mesh.material(a)).norm());
  return (piece.to.material - piece.from.material).norm() > kSamePoint * size;
}

/// Puts a point where another one of the same place is; it keeps its parameters.
void place(PathSample& sample, const PathSample& at) {
  const StripParameters own = sample.at;
  sample = at;
  sample.at = own;
}

void dropEmptyPieces(PathChain& chain, const TriangleMesh& mesh) {
  std::vector<PathPiece> kept;
  kept.reserve(chain.pieces.size());
  for (const PathPiece& piece : chain.pieces) {
    if (hasLength(piece, mesh)) {
      kept.push_back(piece);
    } else if (!kept.empty() && kept.back().to.need < piece.to.need) {
      place(kept.back().to, piece.to);
    }
  }
  for (std::size_t k = 1; k < kept.size(); ++k) place(kept[k].from, kept[k - 1].to);
  if (chain.closed && !kept.empty()) place(kept.front().from, kept.back().to);
  chain.pieces = std::move(kept);
}

}  // namespace

void direct(PathChain& chain) {
  if (!goesBackwards(chain)) return;
  std::reverse(chain.pieces.begin(), chain.pieces.end());
  for (PathPiece& piece : chain.pieces) std::swap(piece.from, piece.to);
}

std::vector<PathChain> joinPieces(const std::vector<PathPiece>& pieces, const TriangleMesh& mesh) {
  std::vector<PathChain> chains = Walk(pieces).run();
  for (PathChain& chain : chains) {
    direct(chain);
    if (chain.closed) rotateToStart(chain);
    dropEmptyPieces(chain, mesh);
  }
  chains.erase(std::remove_if(chains.begin(), chains.end(),
                              [](const PathChain& chain) { return chain.pieces.empty(); }),
               chains.end());
  return chains;
}

}  // namespace cloth_sim
