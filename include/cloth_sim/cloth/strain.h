#pragma once
/// \file The definition of strain for figures, summaries, messages, markers and colours.

#include <algorithm>
#include <cmath>

namespace cloth_sim {

/// Returns the strain [-] of an edge of the surface: its length over its rest length, less one, and
/// zero if it is shorter than at rest (cloth buckles instead of being compressed).
///
/// The strain of a particle, a face or a whole cloth is the largest strain of its structural and
/// shear springs; a receiver of messages, which has no springs, takes the edges of the triangles,
/// whose rest lengths are distances in material coordinates.
/// \param squaredStretch  square of length over rest length [-], >= 0. The square, because the
///                        largest of many strains then takes a single root.
template <typename Real>
Real strainOf(Real squaredStretch) {
  return std::sqrt(std::max(Real(1), squaredStretch)) - Real(1);
}

/// The same from a stretch that is not squared: length over rest length [-].
inline double strainOfStretch(double stretch) { return std::max(1.0, stretch) - 1.0; }

}  // namespace cloth_sim
