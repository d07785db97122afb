#pragma once
/// \file The error that a method expects of its own results.

#include <string>

namespace cloth_sim {

/// Estimates after a step; see docs/model.md ("Errors on the label") for what they rest on.
struct ErrorEstimate {
  double strain = 0.0;    ///< error of the largest strain [-]
  double position = 0.0;  ///< rms over the particles, of about the last second, over the side [-]
  double largestStrain = 0.0;    ///< largest `strain` so far
  double largestPosition = 0.0;  ///< largest `position` so far
  double asked = 0.0;            ///< bound on both that the scene asks for; 0: fixed substeps
  int budget = 0;                ///< substeps of a step that it may take for that; 0: fixed
  /// Tells whether the budget sufficed in every step so far. True without a bound.
  bool sufficed = true;
};

/// A line for users about a budget that did not suffice; "" if it did.
std::string shortfallText(const ErrorEstimate& error);

}  // namespace cloth_sim
