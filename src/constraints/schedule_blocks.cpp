#include "schedule_blocks.h"

#include <algorithm>

#include "disjoint_sets.h"

namespace cloth_sim {
namespace {

/// Springs in a block, if there are as many. Shorter blocks make a colour load what the colour
/// before it has hardly stored.
constexpr std::size_t kBlockSprings = 4096;
/// Blocks in a group. With more, tests of which blocks share particles cost more than they save.
constexpr std::size_t kMostBlocks = 64;
/// Components that a group keeps, if its first colour has as many.
constexpr std::int32_t kFewestComponents = 16;
/// Springs from which on a cloth is worth a second thread.
constexpr std::size_t kSharedSprings = 16384;

using Colours = std::vector<std::vector<std::int32_t>>::const_iterator;

std::size_t springCount(Colours begin, Colours end) {
  std::size_t count = 0;
  for (; begin != end; ++begin) count += begin->size();
  return count;
}

/// Number of blocks of a group. Where threads share a cloth it is one or a multiple of four: then
/// two threads divide every group at about the same row, and have work while the blocks at that row
/// wait for each other.
std::size_t blockCount(std::size_t springs, bool isShared) {
  const std::size_t blocks = (springs + kBlockSprings - 1) / kBlockSprings;
  if (!isShared) return blocks;
  if (springs <= kBlockSprings / 4) return 1;
  return std::min((blocks + 3) / 4 * 4, kMostBlocks);
}

void joinEnds(const std::vector<std::int32_t>& slots, const std::vector<SpringEnds>& ends,
              DisjointSets& sets) {
  for (const std::int32_t slot : slots) sets.join(ends[slot].a, ends[slot].b);
}

/// The end of the longest sequence of colours from `begin` on that may form one group.
/// \param sets  out: the connected components of the group.
Colours endOfGroup(Colours begin, Colours end, const std::vector<SpringEnds>& ends,
                   std::int32_t particles, DisjointSets& sets) {
  joinEnds(*begin, ends, sets);
  for (++begin; begin != end; ++begin) {
    DisjointSets joined = sets;
    joinEnds(*begin, ends, joined);
    const bool isTooFew = joined.count() < std::min(kFewestComponents, sets.count());
    const bool isTooWide = joined.widest() > particles / kFewestComponents;
    if (isTooFew || isTooWide) break;
    sets = std::move(joined);
  }
  return begin;
}

/// The block of each component, by its root: components in ascending order fill blocks of about
/// the same number of springs.
/// \param springsOf  number of springs, by root.
std::vector<std::size_t> assignBlocks(const std::vector<std::size_t>& springsOf, std::size_t all,
                                      std::size_t blocks) {
  std::vector<std::size_t> blockOf(springsOf.size());
  std::size_t block = 0;
  std::size_t taken = 0;
  std::size_t before = 0;  // in earlier blocks
  for (std::size_t root = 0; root < springsOf.size(); ++root) {
    const bool isFull = (taken + springsOf[root]) * blocks > all * (block + 1);
    if (isFull && taken > before) {
      before = taken;
      ++block;
    }
    blockOf[root] = block;
    taken += springsOf[root];
  }
  return blockOf;
}

ColourGroupBlocks divide(Colours begin, Colours end, const std::vector<SpringEnds>& ends,
                         const DisjointSets& sets, bool isShared) {
  const auto rootOf = [&](std::int32_t slot) {
    return static_cast<std::size_t>(sets.rootOf(ends[slot].a));
  };
  std::vector<std::size_t> springsOf;
  for (Colours colour = begin; colour != end; ++colour) {
    for (const std::int32_t slot : *colour) {
      const std::size_t root = rootOf(slot);
      if (springsOf.size() <= root) springsOf.resize(root + 1, 0);
      ++springsOf[root];
    }
  }
  const std::size_t all = springCount(begin, end);
  const std::vector<std::size_t> blockOf = assignBlocks(springsOf, all, blockCount(all, isShared));
  ColourGroupBlocks blocks(blockOf.back() + 1, Coloured(static_cast<std::size_t>(end - begin)));
  for (Colours colour = begin; colour != end; ++colour) {
    for (const std::int32_t slot : *colour) {
      blocks[blockOf[rootOf(slot)]][static_cast<std::size_t>(colour - begin)].push_back(slot);
    }
  }
  return blocks;
}

}  // namespace

void forColourGroups(const Coloured& colours, const std::vector<SpringEnds>& ends,
                     std::int32_t particles,
                     const std::function<void(const ColourGroupBlocks&)>& visit) {
  const bool isShared = springCount(colours.begin(), colours.end()) >= kSharedSprings;
  for (Colours begin = colours.begin(); begin != colours.end();) {
    DisjointSets sets(particles);
    const Colours end = endOfGroup(begin, colours.end(), ends, particles, sets);
    visit(divide(begin, end, ends, sets, isShared));
    begin = end;
  }
}

}  // namespace cloth_sim
