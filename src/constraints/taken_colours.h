#pragma once
/// \file Greedy colouring of elements that join several particles.

#include <cstdint>
#include <vector>

namespace cloth_sim {

/// The colours that elements at each particle have, 64 colours a word.
class TakenColours {
 public:
  /// \param slots  number of particle slots.
  explicit TakenColours(std::int32_t slots) : slots_(static_cast<std::size_t>(slots)) {}

  /// Returns the smallest colour that no element at the given particles has yet, and takes it.
  /// \param slots  of the particles; the first `count` of them.
  template <typename SlotList>
  std::size_t take(const SlotList& slots, std::size_t count) {
    for (std::size_t word = 0;; ++word) {
      if (word == words_.size()) words_.emplace_back(slots_, 0);
      std::uint64_t taken = 0;
      for (std::size_t k = 0; k < count; ++k) taken |= at(word, slots[k]);
      std::size_t bit = 0;
      while (bit < 64 && (taken >> bit & 1U) != 0) ++bit;
      if (bit == 64) continue;
      for (std::size_t k = 0; k < count; ++k) at(word, slots[k]) |= std::uint64_t{1} << bit;
      return 64 * word + bit;
    }
  }

 private:
  std::uint64_t& at(std::size_t word, std::int32_t slot) {
    return words_[word][static_cast<std::size_t>(slot)];
  }

  std::size_t slots_;
  std::vector<std::vector<std::uint64_t>> words_;  ///< by word, by slot
};

}  // namespace cloth_sim
