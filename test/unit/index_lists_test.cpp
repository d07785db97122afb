/// \file IndexLists behave like a vector of vectors.

#include "cloth_sim/mesh/index_lists.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "sim/archive.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Reference = std::vector<std::vector<std::int32_t>>;

void expectEqual(const IndexLists& lists, const Reference& reference) {
  ASSERT_EQ(lists.size(), reference.size());
  for (std::size_t k = 0; k < reference.size(); ++k) {
    ASSERT_EQ(lists[static_cast<std::int32_t>(k)], reference[k]) << "list " << k;
  }
}

TEST(IndexLists, KeepWhatIsPutInAtTheEndOrInOrder) {
  IndexLists lists({2, 0, 3});
  lists.append(0, 7);
  lists.append(0, 5);
  lists.append(0, 6);  // more than there was room for
  lists.insertSorted(1, 4);
  lists.insertSorted(1, 2);
  lists.insertSorted(1, 3);
  EXPECT_THAT(lists[0], ElementsAre(7, 5, 6));
  EXPECT_THAT(lists[1], ElementsAre(2, 3, 4));
  EXPECT_THAT(lists[2], IsEmpty());
  lists.erase(0, 5);
  EXPECT_THAT(lists[0], ElementsAre(7, 6));
}

TEST(IndexLists, RefuseToTakeOutWhatIsNotThere) {
  IndexLists lists({1});
  EXPECT_THROW(lists.erase(0, 1), std::logic_error);
}

TEST(IndexLists, RefuseMoreThanTheyCanCount) {
  IndexLists lists({65535});
  for (std::int32_t k = 0; k < 65535; ++k) lists.append(0, k);
  EXPECT_THROW(lists.append(0, 1), std::length_error);
  EXPECT_EQ(lists[0].size(), 65535U);
  EXPECT_THROW(IndexLists({65536}), std::length_error);
}

/// Makes so many edits that lists grow, move and are compacted.
TEST(IndexLists, AreAVectorOfVectorsUnderAnyEdits) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return static_cast<std::int32_t>(random() % n); };
    IndexLists lists(std::vector<std::int32_t>(50, 3));
    Reference reference(50);
    for (int edit = 0; edit < 40000; ++edit) {
      const std::int32_t list = below(reference.size());
      std::vector<std::int32_t>& own = reference[static_cast<std::size_t>(list)];
      const std::int32_t value = below(1000);
      switch (random() % 16) {
        case 0:
          lists.addList();
          reference.emplace_back();
          break;
        case 1:
          if (reference.size() < 20) break;
          lists.replaceByLast(list);
          std::swap(own, reference.back());
          reference.pop_back();
          break;
        case 2:
        case 3:
        case 4:
        case 5:
        case 6:
          if (own.empty()) break;
          lists.erase(list, own[own.size() / 2]);
          own.erase(std::find(own.begin(), own.end(), own[own.size() / 2]));
          break;
        case 7:
        case 8:
        case 9:
          if (!std::is_sorted(own.begin(), own.end())) break;
          lists.insertSorted(list, value);
          own.insert(std::upper_bound(own.begin(), own.end(), value), value);
          break;
        default:
          lists.append(list, value);
          own.push_back(value);
      }
      if (edit % 1000 == 0) expectEqual(lists, reference);
    }
    expectEqual(lists, reference);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(IndexLists, ComeBackFromBytes) {
  IndexLists lists({1, 0, 2});
  for (std::int32_t k = 0; k < 9; ++k) lists.append(k % 3, k);
  std::stringstream bytes;
  {
    StateWriter writer(bytes);
    writer(lists);
  }
  IndexLists read;
  StateReader reader(bytes.str());
  reader(read);
  ASSERT_EQ(read.size(), lists.size());
  for (std::int32_t k = 0; k < 3; ++k) {
    EXPECT_EQ(read[k], lists[k]);
    read.append(k, 100);  // and can grow
    EXPECT_EQ(read[k].size(), 4U);
  }
}

}  // namespace
}  // namespace cloth_sim
