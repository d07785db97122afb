#pragma once
/// \file Many short lists of indices in one array.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cloth_sim {

/// A read-only view of a list of indices; one of `IndexLists` is valid until the lists change.
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

/// Lists of indices in one pool, like the rows of a compressed sparse matrix, but growing. Each
/// takes four bytes per entry and eight per list. A list that outgrows its capacity moves to the
/// end of the pool.
class IndexLists {
 public:
  IndexLists() = default;
  /// Makes empty lists.
  /// \param capacity  number of entries that each will have; fewer than 2^16.
  /// \throws std::length_error if that is too many for one list or for the pool.
  explicit IndexLists(const std::vector<std::int32_t>& capacity);

  std::size_t size() const { return lists_.size(); }
  IndexSpan operator[](std::int32_t list) const {
    const List& at = lists_[static_cast<std::size_t>(list)];
    const std::int32_t* const first = pool_.data() + at.first;
    return {first, first + at.count};
  }

  /// Appends to a list.
  void append(std::int32_t list, std::int32_t value) { insert(list, (*this)[list].size(), value); }
  /// Inserts into an ascending list, which stays ascending.
  void insertSorted(std::int32_t list, std::int32_t value);
  /// Removes the first `value` of a list; later entries move up.
  /// \throws std::logic_error if the list does not have it.
  void erase(std::int32_t list, std::int32_t value);

  /// Appends an empty list.
  void addList() { lists_.emplace_back(); }
  /// Removes a list; the last list takes its place.
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
    std::uint32_t first = 0;  ///< index of its first entry in pool_
    std::uint16_t count = 0;
    std::uint16_t capacity = 0;
  };

  void insert(std::int32_t list, std::size_t index, std::int32_t value);
  void makeRoom(std::int32_t full);
  void compact();
  void flatten(std::vector<std::int32_t>& counts, std::vector<std::int32_t>& values) const;
  void unflatten(const std::vector<std::int32_t>& counts, const std::vector<std::int32_t>& values);

  std::vector<List> lists_;
  std::vector<std::int32_t> pool_;
  std::size_t abandoned_ = 0;  ///< entries of the pool that belong to no list any more
};

}  // namespace cloth_sim
