/// \file The shuffles of SIMD registers, as this compiler makes them.

#include "unit/simd_support.h"

namespace cloth_sim {
namespace {

TEST(Simd, JoinsHalves) { expectHalvesAreJoined(); }
TEST(Simd, TakesNumbersFromAnyPlace) { expectAnyPlaceWillDo(); }
TEST(Simd, Transposes) { expectMatrixIsTransposed(); }
TEST(Simd, TransposesHalves) { expectHalvesAreTransposed(); }

}  // namespace
}  // namespace cloth_sim
