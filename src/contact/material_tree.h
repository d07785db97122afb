#pragma once
/// \file Faces of one cloth in a tree over the material plane, and the pairs of faces in it that
/// nothing rules out from touching.

#include <atomic>
#include <limits>

#include "closest_points.h"
#include "cloth_sim/cloth/model.h"
#include "material_level.h"

namespace cloth_sim {

/// The inverse of the first two edges of a face in the material plane, as columns [1/m].
inline Eigen::Matrix2d inverseRestOf(const TriangleMesh& mesh, const Face& face) {
  Eigen::Matrix2d rest;
  rest.col(0) = mesh.material(face[1]) - mesh.material(face[0]);
  rest.col(1) = mesh.material(face[2]) - mesh.material(face[0]);
  return rest.inverse();
}

/// Two faces, of different cloths or of the same one.
struct FaceIds {
  FaceId first = kNone;
  FaceId second = kNone;
};

/// Where a search adds the pairs of faces that it finds.
struct NearPairs {
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  const std::vector<QuickBox>& boxes;  ///< by face of the model
  std::vector<FaceIds>& pairs;
  std::size_t enough = kAll;  ///< the search ends when there are more
  /// Pairs that other parts of the search have found; null if there are none.
  const std::atomic<std::size_t>* others = nullptr;

  bool areEnough() const {
    const std::size_t found = others == nullptr ? 0 : others->load(std::memory_order_relaxed);
    return pairs.size() + found > enough;
  }
  /// Adds a pair if its boxes meet.
  void add(FaceId a, FaceId b) const {
    if (boxes[a].meets(boxes[b])) pairs.push_back(a < b ? FaceIds{a, b} : FaceIds{b, a});
  }
};

/// A quadtree whose leaves, buckets, are rectangles of about a cell in the material plane. Each
/// node knows a box around its faces in the world, and a ball around their gradients.
class MaterialTree {
 public:
  /// \param faces  of one cloth, ascending.
  void build(const Model& model, std::vector<FaceId> faces);

  /// Brings all nodes up to date; all count as changed.
  /// \param boxes      by face of the model.
  /// \param gradients  by face of the model.
  void refit(const std::vector<QuickBox>& boxes, const std::vector<GradientBall>& gradients);
  /// Brings the nodes above some faces up to date; only these count as changed.
  /// \param faces  of the model; those of other trees are passed over.
  void refit(const std::vector<FaceId>& faces, const std::vector<QuickBox>& boxes,
             const std::vector<GradientBall>& gradients);

  /// Adds the pairs of faces with boxes that meet, except for pairs in parts that are proven not to
  /// touch themselves; the smaller face first, in an order that depends on positions only. After a
  /// refit of some faces: only pairs that the changes may have brought in, among them some that are
  /// known already.
  void collectOwn(const NearPairs& near);
  /// The same for the faces of two trees.
  static void collectBetween(const MaterialTree& a, const MaterialTree& b, const NearPairs& near);

 private:
  /// The effect of the last refit of some faces on a node.
  enum class Mark : std::uint8_t {
    kSame,
    kExposed,  ///< it belongs to a square that has lost its proof, or lies above such a node
    kChanged,  ///< its box and ball were brought up to date
  };
  /// Nodes of one size, and what the last refit of some faces has changed.
  struct Level : MaterialLevel {
    std::vector<GradientBall> before;   ///< balls before it, of changed nodes
    std::vector<Mark> marks;            ///< by node
    std::vector<std::int32_t> changed;  ///< nodes with the mark kChanged
    std::vector<std::int32_t> exposed;  ///< nodes with the mark kExposed
    std::vector<std::uint8_t> isLost;   ///< by square of 2 x 2 nodes: 1 if its proof was lost
    std::vector<std::int32_t> lost;     ///< such squares
  };

  /// Two nodes of a level, or one with itself.
  struct NodePair {
    Place a;
    Place b;
    bool isNew = false;  ///< no pair of faces under them has been looked at before
    bool isOneNode() const { return a.i == b.i && a.j == b.j; }
  };

  void addLevel(int columns, int rows);
  void placeFaces(const Model& model);
  void findContributions(const Model& model);
  void blockOpenBorders(const Model& model);
  std::array<int, 4> bucketsNear(const Vec2& low, const Vec2& high, double tolerance) const;
  void refitBucket(std::int32_t bucket, const std::vector<QuickBox>& boxes,
                   const std::vector<GradientBall>& gradients);
  void unmark();
  static void markChanged(Level& level, std::int32_t node);
  static void markExposed(Level& level, std::int32_t node);
  static void exposeLost(Level& level);
  const QuickBox& boxAt(const Place& at) const;
  bool isNew(const Place& at) const;
  bool isChanged(const Place& a, const Place& b) const;
  bool wasSmooth(const Place& a, const Place& b) const;
  bool isOpen(const NodePair& pair) const;
  template <typename Visit>
  void forOpenChildren(const NodePair& pair, const Visit& visit) const;
  void collectPair(const NodePair& pair, const NearPairs& near) const;
  static void collectPairBetween(const MaterialTree& treeA, const Place& a,
                                 const MaterialTree& treeB, const Place& b, const NearPairs& near);
  int children(const Place& of, std::array<Place, 4>& out) const {
    return levels_[of.level - 1].partsOf(of, out);
  }
  const FaceId* begin(int bucket) const { return owned_.data() + ownedStart_[bucket]; }
  const FaceId* end(int bucket) const { return owned_.data() + ownedStart_[bucket + 1]; }

  std::vector<FaceId> faces_;   ///< ascending
  Vec2 origin_ = Vec2::Zero();  ///< of the buckets in the material plane [m]
  Vec2 size_ = Vec2::Ones();    ///< of a bucket [m]
  double overhang_ = 0.0;       ///< by which faces reach beyond the bucket that owns them [m]
  std::vector<Level> levels_;
  std::vector<std::int32_t> ownedStart_, gradientStart_;  ///< by bucket
  std::vector<std::int32_t> reachStart_;                  ///< by face of the model
  std::vector<std::int32_t> reach_;          ///< buckets by the faces that own or overlap them
  std::vector<FaceId> owned_;                ///< faces by the bucket that their centre lies in
  std::vector<FaceId> gradients_;            ///< faces by the buckets that they overlap
  std::vector<bool> isBlocked_;              ///< by bucket: the surface is not continuous in it
  bool areAllChanged_ = false;               ///< the last refit was one of all nodes
  std::vector<NodePair> parts_;              ///< scratch: pairs of nodes that threads take
  std::vector<NodePair> whole_;              ///< scratch: the pairs of nodes above these
  std::vector<std::vector<FaceIds>> found_;  ///< scratch: by part
};

}  // namespace cloth_sim
