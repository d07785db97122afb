#include "cloth_sim/contact/box_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace cloth_sim {
namespace {

constexpr std::int32_t kItemsOfLeaf = 4;

/// Builds one hierarchy.
class BoxTreeBuilder {
 public:
  BoxTreeBuilder(const std::vector<BoxedItem>& items, std::vector<std::int32_t>& order)
      : items_(items), order_(order) {}

  /// Appends the node of a range of the order and those below. \return its number.
  std::int32_t build(std::int32_t first, std::int32_t last) {
    const auto index = static_cast<std::int32_t>(nodes_.size());
    nodes_.emplace_back();
    BoxNode node = boxOf(first, last);
    if (last - first <= kItemsOfLeaf) {
      node.first = first;
      node.count = last - first;
    } else {
      const std::int32_t middle = first + (last - first) / 2;
      split(first, middle, last);
      build(first, middle);
      node.right = build(middle, last);
    }
    nodes_[index] = node;
    return index;
  }

  std::vector<BoxNode> takeNodes() { return std::move(nodes_); }

 private:
  BoxNode boxOf(std::int32_t first, std::int32_t last) const {
    BoxNode node;
    node.low = items_[order_[first]].low;
    node.high = items_[order_[first]].high;
    for (std::int32_t k = first + 1; k < last; ++k) {
      node.low = node.low.cwiseMin(items_[order_[k]].low);
      node.high = node.high.cwiseMax(items_[order_[k]].high);
    }
    return node;
  }

  /// Moves the items of a range with the lower centres before the middle.
  void split(std::int32_t first, std::int32_t middle, std::int32_t last) {
    Vec3 least = items_[order_[first]].centre;
    Vec3 most = least;
    for (std::int32_t k = first + 1; k < last; ++k) {
      least = least.cwiseMin(items_[order_[k]].centre);
      most = most.cwiseMax(items_[order_[k]].centre);
    }
    int axis = 0;
    (most - least).maxCoeff(&axis);
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](std::int32_t a, std::int32_t b) {
                       return std::make_pair(items_[a].centre[axis], a) <
                              std::make_pair(items_[b].centre[axis], b);
                     });
  }

  const std::vector<BoxedItem>& items_;
  std::vector<std::int32_t>& order_;
  std::vector<BoxNode> nodes_;
};

}  // namespace

std::vector<BoxNode> buildBoxTree(const std::vector<BoxedItem>& items,
                                  std::vector<std::int32_t>& order) {
  order.resize(items.size());
  std::iota(order.begin(), order.end(), 0);
  BoxTreeBuilder builder(items, order);
  builder.build(0, static_cast<std::int32_t>(items.size()));
  return builder.takeNodes();
}

}  // namespace cloth_sim
