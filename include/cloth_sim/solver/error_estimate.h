#pragma once
/// \file The error that a method expects of its own results.

namespace cloth_sim {

/// Estimates after a step; see docs/model.md ("Errors on the label") for what they rest on.
struct ErrorEstimate {
  double strain = 0.0;    ///< error of the largest strain [-]
  double position = 0.0;  ///< rms over the particles, of about the last second, over the side [-]
  double largestStrain = 0.0;    ///< largest `strain` so far
  double largestPosition = 0.0;  ///< largest `position` so far
  double asked = 0.0;            ///< bound on both that the scene asks for; 0: fixed substeps
  /// Whether the budget sufficed in every step so far. True without a bound.
  bool sufficed = true;
};

}  // namespace cloth_sim
