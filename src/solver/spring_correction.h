#pragma once
/// \file One pass of corrections along springs, one after the other.

#include "cloth_sim/solver/packed_particles.h"
#include "cloth_sim/solver/spring_schedule.h"

namespace cloth_sim {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;

/// Per spring, by position in the schedule. A correction along the spring by
/// gain * (C + lag * dC), where dC is what C has changed by in this substep, is the damped XPBD
/// update of Macklin et al. 2016, eqs. 18 and 26, with one iteration.
struct SpringGains {
  std::vector<double> gain;  ///< 1 / ((1 + lag) (w_a + w_b) + 1 / (k h^2)) [kg]
  std::vector<double> lag;   ///< c / (k h) [-]; nothing where no spring is damped
  double lagAt(std::int32_t p) const { return lag.empty() ? 0.0 : lag[p]; }
};

/// \param h  length of the substep [s].
void setGains(const SpringSchedule& schedule, const std::vector<double>& inverseMass, double h,
              SpringGains& gains);

/// Moves the ends of every spring, in the order of the schedule.
void correctSprings(const SpringSchedule& schedule, const SpringGains& gains,
                    PackedParticles& particles);

}  // namespace cloth_sim
