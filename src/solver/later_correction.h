#pragma once
/// \file Corrections along springs that edits made, which are in no run.

#include "spring_correction.h"

namespace cloth_sim {

/// Moves their ends, in the order of the schedule, to the same bits as along any other springs.
/// Their particles are copied side by side for that, so that each is loaded and stored at once and
/// not coordinate by coordinate.
void correctLaterSprings(const SpringSchedule& schedule, const Compliances& compliances,
                         PackedParticles& particles);

}  // namespace cloth_sim
