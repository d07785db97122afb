#pragma once
/// \file Expectations of the shuffles of support/simd.h, by index. Included by two files of tests,
/// one for each way in which simd.h has them.

#include <gtest/gtest.h>

#include <array>

#include "support/simd.h"

namespace cloth_sim {
namespace {

/// Eight different numbers from `first` on.
inline std::array<float, kFloatLanes> row(float first) {
  std::array<float, kFloatLanes> numbers{};
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = first + static_cast<float>(k);
  return numbers;
}

inline void expectHalvesAreJoined() {
  const std::array<float, kFloatLanes> numbers = row(1.0f);
  const FloatLanes all = floatLanesAt(numbers.data());
  const FloatHalf low = lowHalf(all);
  const FloatHalf high = highHalf(all);
  const FloatLanes joined = join(low, high);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(low[k], numbers[static_cast<std::size_t>(k)]);
    EXPECT_EQ(high[k], numbers[static_cast<std::size_t>(k + 4)]);
  }
  for (int k = 0; k < 8; ++k) EXPECT_EQ(joined[k], numbers[static_cast<std::size_t>(k)]);
}

/// Registers may begin at any number in memory: an aligned move would fault.
inline void expectAnyPlaceWillDo() {
  alignas(64) std::array<double, 16> doubles{};
  alignas(64) std::array<float, 16> floats{};
  for (std::size_t k = 0; k < 16; ++k) floats[k] = static_cast<float>(doubles[k] = k);
  lanesAt(&doubles[1]) = lanesAt(&doubles[1]) + lanesAt(&doubles[7]);
  floatHalfAt(&floats[1]) = floatHalfAt(&floats[1]) + lowHalf(floatLanesAt(&floats[7]));
  for (std::size_t k = 1; k < 5; ++k) {
    EXPECT_EQ(doubles[k], static_cast<double>(2 * k + 6));
    EXPECT_EQ(floats[k], static_cast<float>(2 * k + 6));
  }
}

inline void expectMatrixIsTransposed() {
  std::array<std::array<double, kLanes>, kLanes> before{};
  Lanes rows[kLanes] = {};
  for (int r = 0; r < kLanes; ++r) {
    for (int c = 0; c < kLanes; ++c) {
      before[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = 10.0 * r + c;
    }
    rows[r] = lanesAt(before[static_cast<std::size_t>(r)].data());
  }
  transpose(rows[0], rows[1], rows[2], rows[3]);
  for (int r = 0; r < kLanes; ++r) {
    for (int c = 0; c < kLanes; ++c) EXPECT_EQ(rows[r][c], 10.0 * c + r);
  }
}

inline void expectHalvesAreTransposed() {
  std::array<std::array<float, kFloatLanes>, 4> before{};
  FloatLanes rows[4] = {};  // a template would forget their alignment
  for (std::size_t r = 0; r < 4; ++r) {
    before[r] = row(10.0f * static_cast<float>(r));
    rows[r] = floatLanesAt(before[r].data());
  }
  transposeHalves(rows[0], rows[1], rows[2], rows[3]);
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_EQ(rows[r][static_cast<int>(c)], before[c][r]);
      EXPECT_EQ(rows[r][static_cast<int>(c + 4)], before[c][r + 4]);
    }
  }
}

}  // namespace
}  // namespace cloth_sim
