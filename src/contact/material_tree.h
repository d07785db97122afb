#pragma once
/// \file The faces of one cloth in a tree over the material plane, and the pairs of faces in it
/// that nothing rules out from touching.

#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>

#include "closest_points.h"
#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// An axis-aligned box in the world [m]; empty by default.
struct Box {
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);

  void add(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  bool contains(const Vec3& p) const {
    return (low.array() <= p.array()).all() && (p.array() <= high.array()).all();
  }
  bool meets(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// A box for quick tests: of single precision, never smaller than what it stands for.
struct QuickBox {
  /// x, y, z and 0.
  using Corner = float __attribute__((vector_size(16)));

  Corner low = Corner{} + 1e30F;
  Corner high = Corner{} - 1e30F;

  QuickBox() = default;
  explicit QuickBox(const Box& box) {
    constexpr double kRounding = 1e-7;  // above half of a unit in the last place of a float
    low[3] = high[3] = 0.0F;
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<float>(box.low[k] - kRounding * std::abs(box.low[k]));
      high[k] = static_cast<float>(box.high[k] + kRounding * std::abs(box.high[k]));
    }
  }
  void add(const QuickBox& other) {
    low = low < other.low ? low : other.low;
    high = high > other.high ? high : other.high;
  }
  bool meets(const QuickBox& other) const {
    const auto meet = (low <= other.high) & (other.low <= high);
    return (meet[0] & meet[1] & meet[2]) != 0;
  }
};

/// A deformation gradient, (3, 2): derivatives of the position by the two material coordinates.
struct Gradient {
  Vec3 u = Vec3::Zero();
  Vec3 v = Vec3::Zero();

  /// Edges of a triangle in the world, multiplied by the inverse of its edges at rest (2, 2).
  static Gradient of(const Vec3& first, const Vec3& second, const Eigen::Matrix2d& inverseRest) {
    return {inverseRest(0, 0) * first + inverseRest(1, 0) * second,
            inverseRest(0, 1) * first + inverseRest(1, 1) * second};
  }
  /// Frobenius norm.
  double norm() const { return std::sqrt(u.squaredNorm() + v.squaredNorm()); }
  Gradient operator-(const Gradient& other) const { return {u - other.u, v - other.v}; }
};

/// A ball in the space of deformation gradients, by the Frobenius norm.
///
/// If the gradients of all faces of a convex part of the material plane lie in a ball around G with
/// a radius below the smaller singular value of G, that part does not intersect itself: for two of
/// its points u and w, x(u) - x(w) is the integral of the gradient along the segment between them,
/// and so at least (sigma - radius) |u - w| long.
struct GradientBall {
  Gradient centre;
  double radius = -1.0;  ///< below 0: no gradients; infinite: nothing is known

  static GradientBall unknown();
  bool isEmpty() const { return radius < 0.0; }
  /// Grows to the least ball that contains both.
  void add(const GradientBall& other);
  /// Tells whether a convex part of the material plane with these gradients cannot intersect
  /// itself.
  bool provesInjective() const;
};

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
  /// \param cloth  whose faces these are.
  void build(const Model& model, std::size_t cloth);
  bool isEmpty() const { return faces_.empty(); }

  /// Brings all nodes up to date; all count as changed.
  /// \param boxes      by face of the model.
  /// \param gradients  by face of the model.
  void refit(const std::vector<QuickBox>& boxes, const std::vector<GradientBall>& gradients);
  /// Brings the nodes above some faces up to date; only these count as changed.
  /// \param faces  of the model; those of other cloths are passed over.
  void refit(const std::vector<FaceId>& faces, const std::vector<QuickBox>& boxes,
             const std::vector<GradientBall>& gradients);

  /// Adds the pairs of faces with boxes that meet, except for pairs in parts that are proven not to
  /// touch themselves; the smaller face first, in an order that depends on positions only. After a
  /// refit of some faces: only pairs that the changes may have brought in, among them some that are
  /// known already.
  void collectOwn(const NearPairs& near);
  /// The same for the faces of two cloths.
  static void collectBetween(const MaterialTree& a, const MaterialTree& b, const NearPairs& near);

 private:
  /// Tells whether a part of the material plane is proven not to touch itself.
  enum class Proof : std::uint8_t { kUnknown, kYes, kNo };
  /// Nodes of one size, (columns * rows,), row by row.
  struct Level {
    int columns = 0;
    int rows = 0;
    std::vector<QuickBox> boxes;
    std::vector<GradientBall> balls;
    std::vector<GradientBall> before;     ///< balls before the last refit, of changed nodes
    std::vector<std::uint8_t> isChanged;  ///< 1 if the last refit brought the node up to date
    std::vector<std::int32_t> changed;    ///< nodes with that mark, unless all were brought
    /// By node: whether the square of 2 x 2 nodes from it on is proven; found when asked for.
    mutable std::vector<Proof> squares;
    int node(int i, int j) const { return j * columns + i; }
  };
  /// A node's place.
  struct Place {
    int level = 0;  ///< 0: buckets
    int i = 0;
    int j = 0;
  };

  /// Two nodes of a level, or one with itself.
  struct NodePair {
    Place a;
    Place b;
    bool isNew = false;  ///< no pair of faces under them has been looked at before
    bool isOneNode() const { return a.i == b.i && a.j == b.j; }
  };

  void placeFaces(const Model& model);
  void findContributions(const Model& model);
  void blockOpenBorders(const Model& model);
  std::array<int, 4> bucketsNear(const Vec2& low, const Vec2& high, double tolerance) const;
  void refitBucket(std::int32_t bucket, const std::vector<QuickBox>& boxes,
                   const std::vector<GradientBall>& gradients);
  void refitNode(int level, std::int32_t node);
  void unmark();
  static void mark(Level& level, std::int32_t node);
  const QuickBox& boxAt(const Place& at) const;
  bool isNew(const Place& at) const;
  bool isChanged(const Place& a, const Place& b) const;
  bool isSmooth(const Place& a, const Place& b) const;
  bool isSquareProven(const Level& level, int i, int j) const;
  bool wasSmooth(const Place& a, const Place& b) const;
  template <typename Ball>
  static bool isProven(const Place& a, const Place& b, const Ball& ballAt);
  bool isOpen(const NodePair& pair) const;
  template <typename Visit>
  void forOpenChildren(const NodePair& pair, const Visit& visit) const;
  void collectPair(const NodePair& pair, const NearPairs& near) const;
  static void collectPairBetween(const MaterialTree& treeA, const Place& a,
                                 const MaterialTree& treeB, const Place& b, const NearPairs& near);
  int children(const Place& of, std::array<Place, 4>& out) const;
  const FaceId* begin(int bucket) const { return owned_.data() + ownedStart_[bucket]; }
  const FaceId* end(int bucket) const { return owned_.data() + ownedStart_[bucket + 1]; }

  std::vector<FaceId> faces_;   ///< of the cloth, ascending
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
