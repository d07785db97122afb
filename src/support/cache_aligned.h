#pragma once
/// \file Arrays that begin with a cache line.

#include <cstddef>
#include <new>
#include <vector>

namespace cloth_sim {

/// An allocator. Of the vectors of four numbers that sweeps read and write, half would otherwise
/// lie in two cache lines: new begins arrays 16 bytes after one.
template <typename T>
struct CacheAligned {
  using value_type = T;

  CacheAligned() = default;
  template <typename U>
  explicit CacheAligned(const CacheAligned<U>& /*other*/) {}

  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t /*n*/) { ::operator delete(p, kAlignment); }

  friend bool operator==(const CacheAligned&, const CacheAligned&) { return true; }
  friend bool operator!=(const CacheAligned&, const CacheAligned&) { return false; }

 private:
  static constexpr std::align_val_t kAlignment{64};
};

template <typename T>
using CacheAlignedVector = std::vector<T, CacheAligned<T>>;

}  // namespace cloth_sim
