#pragma once
/// \file A pull of a patch: the force of the model beside that of a fit to measured cloth.

#include <array>
#include <string>
#include <vector>

namespace cloth_sim {

enum class PullKind { kWarp, kWeft, kBias, kBiaxial };
/// Names a pull: "warp", "weft", "bias" or "biaxial".
const char* toString(PullKind kind);

/// The stiffness that Wang, O'Brien & Ramamoorthi (2011) fitted to their measurements of a fabric:
/// without strain, and at a largest stretch of 1/6 in five directions. Each has C11, C12, C22 and
/// C33 as in the files of the authors, whose second direction is the warp of the presets; the
/// energy per area is C11 e11^2 + 2 C12 e11 e22 + C22 e22^2 + C33 e12^2 of the Green strain e
/// [N/m].
struct StretchFit {
  using Tensor = std::array<double, 4>;
  std::string preset;  ///< of this package, made from the same file
  std::string file;
  Tensor unstrained;
  std::array<Tensor, 5> strained;
};

/// The fits that presets of this package were made from.
const std::vector<StretchFit>& stretchFits();

/// Force per width of the undeformed cloth by the fit, at a strain along the pull (of both
/// directions, if it is biaxial: the force along the warp) [N/m].
double fittedPull(const StretchFit& fit, PullKind kind, double strain);

/// The same by the model: a strip four times as long as wide between rigid grips, at rest; a square
/// patch if the pull is biaxial. In a bias pull the threads lie at 45 degrees. NaN if the patch did
/// not come to rest.
double simulatedPull(const std::string& preset, PullKind kind, double strain);

}  // namespace cloth_sim
