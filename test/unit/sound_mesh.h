#pragma once
/// \file Expectation of a mesh that is in order and has kept its area.

#include <gtest/gtest.h>

#include "unit/core_support.h"

namespace cloth_sim::testing_support {

/// \param area  sum of the rest areas [m^2].
inline void expectSound(const TriangleMesh& mesh, double area) {
  EXPECT_EQ(validateMesh(mesh), "");
  EXPECT_NEAR(preciseArea(mesh), area, 1e-14 * area);
}

}  // namespace cloth_sim::testing_support
