#include "face_pair_search.h"

#include <algorithm>
#include <utility>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Share of all faces from which on a piece has a tree of its own.
constexpr double kLargePiece = 1.0 / 64.0;

/// The faces of each tree. Faces on both sides of a tear lie in the same part of the material
/// plane, but once they have come apart a box around both meets everything between. So large pieces
/// have a tree each, and all others of a cloth one.
std::vector<std::vector<FaceId>> facesOfTrees(const Model& model) {
  const ConnectedComponents pieces = connectedComponents(model.mesh);
  std::vector<std::int32_t> sizes(static_cast<std::size_t>(pieces.count), 0);
  for (const std::int32_t piece : pieces.ofFace) ++sizes[piece];
  const double large = kLargePiece * static_cast<double>(pieces.ofFace.size());
  std::vector<std::vector<FaceId>> trees(model.cloths.size());
  std::vector<std::size_t> treeOf(sizes.size(), 0);  // by large piece; 0: none yet
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    const std::int32_t piece = pieces.ofFace[f];
    std::size_t tree = model.clothOf(model.mesh.face(f)[0]);
    if (sizes[piece] >= large) {
      if (treeOf[piece] == 0) {
        treeOf[piece] = trees.size();
        trees.emplace_back();
      }
      tree = treeOf[piece];
    }
    trees[tree].push_back(f);
  }
  return trees;
}

}  // namespace

void FacePairSearch::build(const Model& model, double margin) {
  margin_ = margin;
  faces_ = model.mesh.faces();
  allowance_.build(model);
  std::vector<std::vector<FaceId>> faces = facesOfTrees(model);
  trees_.resize(faces.size());
  for (std::size_t k = 0; k < faces.size(); ++k) trees_[k].build(model, std::move(faces[k]));
  corners_.resize(static_cast<std::size_t>(model.particleCount()));
  boxes_.resize(faces_.size());
}

/// Puts a box around the places that a vertex may take.
void FacePairSearch::boxCorner(VertexId v) {
  const Vec3 margin = Vec3::Constant(margin_);
  const Vec3& x = allowance_.origin()[v];
  const Box& motion = allowance_.motions()[v];
  corners_[v] = QuickBox({x + motion.low - margin, x + motion.high + margin});
}

void FacePairSearch::boxFace(FaceId f) {
  const Face& face = faces_[f];
  QuickBox box = corners_[face[0]];
  box.add(corners_[face[1]]);
  box.add(corners_[face[2]]);
  boxes_[f] = box;
}

bool FacePairSearch::findPairs(const std::vector<Vec3>& start, const std::vector<Vec3>& end,
                               const Reach& reach, std::size_t most) {
  constexpr std::int32_t kGrain = 2048;
  allowance_.renew(start, end, reach);
  parallelForEach(corners_.size(), kGrain, [&](VertexId v) { boxCorner(v); });
  parallelForEach(faces_.size(), kGrain, [&](FaceId f) { boxFace(f); });
  for (MaterialTree& tree : trees_) tree.refit(boxes_, allowance_.gradients());
  near_.clear();
  known_.clear(faces_.size());
  collect(most);
  return near_.size() <= most;
}

/// Appends the pairs of faces near each other in parts that were brought up to date, until there
/// are more than `most`.
void FacePairSearch::collect(std::size_t most) {
  const NearPairs near{boxes_, near_, most};
  for (std::size_t a = 0; a < trees_.size(); ++a) {
    trees_[a].collectOwn(near);
    for (std::size_t b = a + 1; b < trees_.size(); ++b) {
      MaterialTree::collectBetween(trees_[a], trees_[b], near);
    }
  }
}

void FacePairSearch::findAround() {
  const Renewed& renewed = allowance_.renewed();
  for (const VertexId v : renewed.vertices) boxCorner(v);
  for (const FaceId f : renewed.faces) boxFace(f);
  for (MaterialTree& tree : trees_) tree.refit(renewed.faces, boxes_, allowance_.gradients());
  collectNew();
}

/// Appends the pairs of faces that have come near since.
void FacePairSearch::collectNew() {
  if (known_.isEmpty()) {
    for (const FaceIds& pair : near_) known_.insert(pair);
  }
  const auto first = static_cast<std::ptrdiff_t>(near_.size());
  collect(NearPairs::kAll);
  const auto isKnown = [this](const FaceIds& pair) { return !known_.insert(pair); };
  near_.erase(std::remove_if(near_.begin() + first, near_.end(), isKnown), near_.end());
}

}  // namespace cloth_sim
