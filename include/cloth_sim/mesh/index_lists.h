#pragma once
/// \file Many short lists of indices in one piece of memory.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cloth_sim {

/// One of IndexLists, to be looked at: until lists change.
class IndexSpan {
 public:
  using value_type = std::int32_t;
  using const_iterator = const std::int32_t*;

  IndexSpan(const std::int32_t* begin, const std::int32_t* end) : begin_(begin), end_(end) {}

  const std::int32_t* begin() const { return begin_; }
  const std::int32_t* end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  bool empty() const { return begin_ == end_; }
  std::int32_t front() const { return *begin_; }
  std::int32_t operator[](std::size_t k) const { return begin_[k]; }
  // NOLINTNEXTLINE(google-explicit-constructor): a copy reads like that of a vector
  operator std::vector<std::int32_t>() const { return {begin_, end_}; }

 private:
  const std::int32_t* begin_;
  const std::int32_t* end_;
};
bool operator==(const IndexSpan& a, const IndexSpan& b);
bool operator==(const IndexSpan& a, const std::vector<std::int32_t>& b);
bool operator==(const std::vector<std::int32_t>& a, const IndexSpan& b);
bool operator!=(const IndexSpan& a, const std::vector<std::int32_t>& b);

/// A list of indices for each of a number of items. Where none of them grew they take four bytes an
/// entry and eight a list; a list that grows moves to the end.
class IndexLists {
 public:
  IndexLists() = default;
  /// Empty lists.
  /// \param room  entries that there will be in each.
  explicit IndexLists(const std::vector<std::int32_t>& room);

  std::size_t size() const { return lists_.size(); }
  IndexSpan operator[](std::int32_t list) const {
    const List& at = lists_[static_cast<std::size_t>(list)];
    const std::int32_t* const first = pool_.data() + at.first;
    return {first, first + at.count};
  }

  /// At the end of a list.
  void append(std::int32_t list, std::int32_t value) { insert(list, (*this)[list].size(), value); }
  /// Into a list that is ascending, and stays so.
  void insertSorted(std::int32_t list, std::int32_t value);
  /// The first `value` of a list that has it; what is behind it moves up.
  void erase(std::int32_t list, std::int32_t value);

  /// One more list, which is empty.
  void addList() { lists_.emplace_back(); }
  /// The last list goes into the place of this one (which may be itself).
  void replaceByLast(std::int32_t list);

  template <class Archive>
  void save(Archive& archive) const {
    std::vector<std::int32_t> counts;
    std::vector<std::int32_t> values;
    flatten(counts, values);
    archive(counts, values);
  }
  template <class Archive>
  void load(Archive& archive) {
    std::vector<std::int32_t> counts;
    std::vector<std::int32_t> values;
    archive(counts, values);
    unflatten(counts, values);
  }

 private:
  struct List {
    std::uint32_t first = 0;  ///< in pool_
    std::uint16_t count = 0;
    std::uint16_t room = 0;
  };

  void insert(std::int32_t list, std::size_t place, std::int32_t value);
  void grow(std::int32_t which);
  void compact();
  void flatten(std::vector<std::int32_t>& counts, std::vector<std::int32_t>& values) const;
  void unflatten(const std::vector<std::int32_t>& counts, const std::vector<std::int32_t>& values);

  std::vector<List> lists_;
  std::vector<std::int32_t> pool_;
  std::size_t left_ = 0;  ///< entries of the pool that no list has any more
};

}  // namespace cloth_sim
