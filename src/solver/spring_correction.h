#pragma once
/// \file One pass of corrections along springs, one after the other.

#include <functional>

#include "cloth_sim/solver/packed_particles.h"
#include "cloth_sim/solver/spring_schedule.h"

namespace cloth_sim {

/// What springs give way in a substep, by their place in the laws of the schedule: f along a spring
/// moves its ends until C + alpha f = 0, or with damping C + lag dC + alpha f = 0, where dC is what
/// C has changed by in this substep. The update of Macklin et al. 2016, eqs. 18 and 26, with one
/// iteration.
struct Compliances {
  std::vector<double> alpha;  ///< 1 / (k h^2) [1/kg]; infinite where the spring is gone
  std::vector<double> lag;    ///< c / (k h) [-]; nothing where no spring is damped
};

/// Of one spring.
struct Compliance {
  double alpha = 0.0;
  double lag = 0.0;
};
/// \param h  length of the substep [s].
Compliance complianceOf(const SpringLaw& law, double h);

void setCompliances(const SpringLaws& laws, double h, Compliances& compliances);

/// What is to be done with particles before their springs: `prepare(first, last)` for slots.
using Prepare = std::function<void(std::size_t first, std::size_t last)>;

/// Moves the ends of every spring, in the order of the schedule.
/// \param prepare  if any: called for all slots, part by part, each as late as may be, so that what
///                 it has written is still in the cache.
void correctSprings(const SpringSchedule& schedule, const Compliances& compliances,
                    PackedParticles& particles, const Prepare& prepare = {});

}  // namespace cloth_sim
