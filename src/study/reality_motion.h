#pragma once
/// \file Friction between layers on a slope, and the decay of a swing in still air.

#include <string>

namespace cloth_sim {

/// Distance by which a cloth slides over another that lies on a slope, from 0.05 s to 0.3 s [m].
/// \param friction  between the layers [-]
/// \param degrees   of the slope
double slideOnSlope(double friction, double degrees);

/// A swing of a strip that hangs from its upper edge in still air.
struct SwingDecay {
  double period = 0.0;  ///< [s]
  double rate = 0.0;    ///< at which the inverse of the amplitude of the tip grows [1/(m s)]
  double first = 0.0;   ///< amplitude after the first period [m]
  double last = 0.0;    ///< amplitude at the end [m]
};

constexpr double kSwingLength = 0.5;  ///< of the strip [m]
constexpr double kSwingTime = 10.0;   ///< of the simulation [s]

/// Simulates a strip of a preset, released in the shape of its first mode with a tenth of its
/// length at the tip. \param air  whether there is air, of the density and with the drag
/// coefficient that scenes have by default (Wind).
SwingDecay simulateSwing(const std::string& preset, bool air);

/// The same by theory. A heavy string that hangs freely has the first mode J0(2 omega sqrt(z / g))
/// over the height z from its lower end, with omega = 1.2024 sqrt(g / L) (Bernoulli; Lamb,
/// Dynamics, 1923). Air of density a pushes with a C |u| u / 2 per area against the normal velocity
/// u. With the areal density m, the mean loss over a period gives d(1/amplitude)/dt = 2 a C omega
/// I3 / (3 pi m I2), with In the mean of the nth power of the mode's magnitude.
SwingDecay swingByTheory(const std::string& preset);

/// Period of the same swing if the air that moves with the strip is counted as mass, pi a w / 4 per
/// area for a width w (potential flow across a flat plate; Lamb, Hydrodynamics, 1932, section 71)
/// [s]. The model has no such mass.
double periodWithMovedAir(const std::string& preset, double width);

}  // namespace cloth_sim
