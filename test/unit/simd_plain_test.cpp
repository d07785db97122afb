/// \file The shuffles of SIMD registers for GCC before 12 (that of ROS Noetic is 9).

#define CLOTH_SIM_PLAIN_SHUFFLES
#include "unit/simd_support.h"

namespace cloth_sim {
namespace {

TEST(SimdOfOldCompilers, JoinsHalves) { expectHalvesAreJoined(); }
TEST(SimdOfOldCompilers, TakesNumbersFromAnyPlace) { expectAnyPlaceWillDo(); }
TEST(SimdOfOldCompilers, Transposes) { expectMatrixIsTransposed(); }
TEST(SimdOfOldCompilers, TransposesHalves) { expectHalvesAreTransposed(); }

}  // namespace
}  // namespace cloth_sim
