#pragma once
/// \file Warm starting of contact forces, for methods that enforce contacts after a global solve.

#include "cloth_sim/contact/contacts.h"
#include "particles.h"

namespace cloth_sim {

/// Contact forces of the last substep, which take part in the solve of the next one.
///
/// Without them the solve would pull the cloth into an obstacle by the weight that the obstacle
/// bears, and pushing it out afterwards would strain it there. After the solve the displacement by
/// the remembered forces is taken back from each particle near an obstacle, and its whole contact
/// force is found anew: contact or not, sticking or slipping is decided for the accumulated
/// impulse, not for the increment (Catto, Iterative Dynamics with Temporal Coherence, 2005).
///
/// Each substep forgets 5 % of a force (half of it, near an obstacle with a friction above 1), so
/// that a force whose contact has ended dies out even where stiff springs keep its particle from
/// moving.
class ContactWarmStart {
 public:
  /// Begins a step: keeps the forces on particles that may touch an obstacle in it. A step that
  /// begins at the same time as the last one, but for rounding, is that step done again.
  /// \param time  at the start of the step [s].
  /// \param h     length of its substeps [s].
  void begin(const Contacts& contacts, const Particles& particles, double time, double h);

  /// Adds the forces of the last substep [N].
  void addForces(const ScalarArray& mass, VectorArray& force) const;

  /// Enforces the contacts of a substep that was solved with these forces, and remembers the forces
  /// that result. Velocities of particles near obstacles become (x - start) / h.
  void enforce(double time, double h, Contacts& contacts, Particles& particles);

  /// Tells whether all forces act on slots below `slots`, once each. For what was read from a file.
  bool fits(std::size_t slots) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(now_.slots, now_.acceleration);
  }

 private:
  /// Contact forces by particle, arrays of one size.
  struct Forces {
    std::vector<std::int32_t> slots;
    std::vector<Vec3> acceleration;  ///< force over mass [m/s^2]
  };

  void list(std::int32_t slot);

  Forces now_;
  Forces atStart_;  ///< forces at the start of the step
  Forces listed_;   ///< forces while a step begins
  std::vector<std::int32_t>
      indexOf_;              ///< index in now_ by slot, while a step begins; otherwise kNone
  double startTime_ = -1.0;  ///< [s]
  double keep_ = 1.0;        ///< fraction of a force that the next substep begins with [-]
};

}  // namespace cloth_sim
