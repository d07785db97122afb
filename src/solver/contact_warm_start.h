#pragma once
/// \file What obstacles did in the substep before, for methods that let them act after a solve.

#include "cloth_sim/contact/contacts.h"
#include "constraints/particles.h"

namespace cloth_sim {

/// A method that solves for the springs as if there were no obstacles, and then moves particles out
/// of them, strains the cloth where it stands on them: the weight that an obstacle bears has pulled
/// it in before it is pushed out. So the forces of the obstacles in the last substep take part in
/// the solve. What they do to a free particle is then taken back and they are found anew, as a
/// whole: pushing or not, sticking or slipping is decided for the sum, not for what has been added
/// (accumulated impulses: Catto, Iterative Dynamics with Temporal Coherence, 2005). At rest what is
/// taken back is what comes anew.
///
/// Of what is remembered a part is forgotten in each substep: a force that no longer acts dies out
/// although its own particle, tied to stiff springs, hardly moves by it.
class ContactWarmStart {
 public:
  /// To be called before the first substep, of length h, of a step: who may touch what in it. A
  /// step that begins when the last one began, but for rounding, replaces it.
  /// \param time  at the start of the step [s].
  void begin(const Contacts& contacts, const Particles& particles, double time, double h);

  /// Adds the forces of the last substep [N].
  void addForces(const ScalarArray& mass, VectorArray& force) const;

  /// Enforces the contacts of a substep that was solved with these forces. Particles near obstacles
  /// get the velocities that lead from `start` to where they are now.
  void enforce(double time, double h, Contacts& contacts, Particles& particles);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(now_.slots, now_.acceleration);
  }

 private:
  /// By particle.
  struct Forces {
    std::vector<std::int32_t> slots;
    std::vector<Vec3> acceleration;  ///< by the forces of obstacles alone [m/s^2]
  };

  void list(std::int32_t slot);

  Forces now_;
  Forces atStart_;                     ///< of the step
  Forces listed_;                      ///< while it begins
  std::vector<std::int32_t> indexOf_;  ///< in now_, by slot, while a step begins; kNone otherwise
  double startTime_ = -1.0;            ///< [s]
};

}  // namespace cloth_sim
