#pragma once
/// \file A bounding volume hierarchy over things that do not move relative to each other.

#include <array>
#include <cstdint>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A thing as the hierarchy sees it.
struct BoxedItem {
  Vec3 low;  ///< corners of its bounding box [m]
  Vec3 high;
  Vec3 centre;  ///< by which items are split, in any unit
};

/// A node of the hierarchy. The root comes first, and the first child of a node after it.
struct BoxNode {
  Vec3 low;
  Vec3 high;
  std::int32_t right = 0;  ///< second child
  std::int32_t first = 0;  ///< item of a leaf
  std::int32_t count = 0;  ///< items of a leaf; 0: no leaf
};

constexpr std::size_t kDeepestBox = 64;  ///< more levels than there are, as each halves the items

/// Builds a hierarchy, splitting at the median of the centres along their longest extent.
/// \param items  at least one.
/// \param order  set to the items in the order of the leaves.
std::vector<BoxNode> buildBoxTree(const std::vector<BoxedItem>& items,
                                  std::vector<std::int32_t>& order);

/// Tells whether two boxes have a point in common.
inline bool boxesMeet(const Vec3& low, const Vec3& high, const Vec3& otherLow,
                      const Vec3& otherHigh) {
  return (low - otherHigh).maxCoeff() <= 0.0 && (otherLow - high).maxCoeff() <= 0.0;
}

/// Calls `function(item)` for the items of the leaves that `isNear(node)` leads to, in their order.
template <class IsNear, class Function>
void visitLeaves(const std::vector<BoxNode>& nodes, IsNear&& isNear, Function&& function) {
  std::array<std::int32_t, kDeepestBox> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::int32_t k = stack[--size];
    const BoxNode& node = nodes[k];
    if (!isNear(node)) continue;
    for (std::int32_t t = node.first; t < node.first + node.count; ++t) function(t);
    if (node.count > 0) continue;
    stack[size++] = node.right;
    stack[size++] = k + 1;
  }
}

}  // namespace cloth_sim
