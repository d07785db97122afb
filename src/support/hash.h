#pragma once
/// \file A hash to tell whether two runs, or a file and what was written, are the same to the bit.

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace cloth_sim {

/// 64-bit FNV-1a (Fowler, Noll & Vo) that takes eight bytes at a time, each followed by a shift
/// that brings what happened in the high bits down. Not meant against people who want a collision.
class Hash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (; bytes > 0;) {
      std::uint64_t word = 0;
      const std::size_t part = bytes < sizeof word ? bytes : sizeof word;
      std::memcpy(&word, p, part);
      mix(word);
      p += part;
      bytes -= part;
    }
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x100000001b3ULL;
    hash_ ^= hash_ >> 32U;
  }

  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

/// 16 hexadecimal digits, as summaries and messages write a hash.
std::string hashText(std::uint64_t hash);

}  // namespace cloth_sim
