#include "cloth_sim/mesh/index_lists.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace cloth_sim {
namespace {

/// Capacity of a list when it grows first.
constexpr std::size_t kMinCapacity = 4;
constexpr std::size_t kMaxCapacity = std::numeric_limits<std::uint16_t>::max();
/// Number of abandoned entries below which the pool is not compacted.
constexpr std::size_t kCompactAbove = 4096;

}  // namespace

bool operator==(const IndexSpan& a, const IndexSpan& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}
bool operator==(const IndexSpan& a, const std::vector<std::int32_t>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}
bool operator==(const std::vector<std::int32_t>& a, const IndexSpan& b) { return b == a; }
bool operator!=(const IndexSpan& a, const std::vector<std::int32_t>& b) { return !(a == b); }

IndexLists::IndexLists(const std::vector<std::int32_t>& capacity) : lists_(capacity.size()) {
  std::size_t entries = 0;
  for (std::size_t k = 0; k < capacity.size(); ++k) {
    const auto own = static_cast<std::size_t>(capacity[k]);
    if (own > kMaxCapacity) throw std::length_error("a list of more than 65535 indices");
    lists_[k].first = static_cast<std::uint32_t>(entries);
    lists_[k].capacity = static_cast<std::uint16_t>(own);
    entries += own;
  }
  if (entries > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("lists of more than 2^32 indices");
  }
  pool_.resize(entries);
}

void IndexLists::insertSorted(std::int32_t list, std::int32_t value) {
  const IndexSpan now = (*this)[list];
  const auto* const at = std::upper_bound(now.begin(), now.end(), value);
  insert(list, static_cast<std::size_t>(at - now.begin()), value);
}

void IndexLists::insert(std::int32_t list, std::size_t index, std::int32_t value) {
  makeRoom(list);
  List& at = lists_[static_cast<std::size_t>(list)];
  const auto first = pool_.begin() + at.first;
  const auto here = first + static_cast<std::ptrdiff_t>(index);
  std::copy_backward(here, first + at.count, first + at.count + 1);
  *here = value;
  ++at.count;
}

void IndexLists::erase(std::int32_t list, std::int32_t value) {
  List& at = lists_[static_cast<std::size_t>(list)];
  const auto first = pool_.begin() + at.first;
  const auto end = first + at.count;
  const auto found = std::find(first, end, value);
  if (found == end) throw std::logic_error("a list has no such index to take out");
  std::copy(found + 1, end, found);
  --at.count;
}

/// Moves a full list to the end of the pool, with twice the capacity.
void IndexLists::makeRoom(std::int32_t full) {
  List& list = lists_[static_cast<std::size_t>(full)];
  if (list.count < list.capacity) return;
  if (abandoned_ > kCompactAbove && 2 * abandoned_ > pool_.size()) compact();
  if (list.capacity >= kMaxCapacity) throw std::length_error("a list of more than 65535 indices");
  const std::size_t capacity =
      std::min(kMaxCapacity, std::max<std::size_t>(kMinCapacity, 2U * list.capacity));
  const std::size_t first = pool_.size();
  pool_.resize(first + capacity);
  std::copy_n(pool_.begin() + list.first, list.count,
              pool_.begin() + static_cast<std::ptrdiff_t>(first));
  abandoned_ += list.capacity;
  list.first = static_cast<std::uint32_t>(first);
  list.capacity = static_cast<std::uint16_t>(capacity);
}

/// Removes the abandoned entries from the pool. Lists keep their numbers.
void IndexLists::compact() {
  std::vector<std::int32_t> packed;
  packed.reserve(pool_.size() - abandoned_);
  for (List& list : lists_) {
    const auto first = pool_.begin() + list.first;
    list.first = static_cast<std::uint32_t>(packed.size());
    list.capacity = list.count;
    packed.insert(packed.end(), first, first + list.count);
  }
  pool_ = std::move(packed);
  abandoned_ = 0;
}

void IndexLists::replaceByLast(std::int32_t list) {
  abandoned_ += lists_[static_cast<std::size_t>(list)].capacity;
  lists_[static_cast<std::size_t>(list)] = List(lists_.back());
  lists_.pop_back();
}

void IndexLists::flatten(std::vector<std::int32_t>& counts,
                         std::vector<std::int32_t>& values) const {
  counts.reserve(lists_.size());
  values.reserve(pool_.size() - abandoned_);
  for (const List& list : lists_) {
    counts.push_back(list.count);
    const auto first = pool_.begin() + list.first;
    values.insert(values.end(), first, first + list.count);
  }
}

void IndexLists::unflatten(const std::vector<std::int32_t>& counts,
                           const std::vector<std::int32_t>& values) {
  *this = IndexLists(counts);
  if (values.size() != pool_.size()) throw std::invalid_argument("lists that do not add up");
  pool_ = values;
  for (List& list : lists_) list.count = list.capacity;
}

}  // namespace cloth_sim
