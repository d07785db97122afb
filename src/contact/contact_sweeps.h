#pragma once
/// \file Sweeps over the contacts of layers that touch in a substep.

#include <array>
#include <cstdint>
#include <vector>

#include "pair_watch.h"

namespace cloth_sim {

/// A contact in a substep. The weighted sum of the positions of its vertices points from one side
/// to the other.
struct LayerPush {
  std::array<VertexId, 4> v{};
  std::array<double, 4> weight{};
  /// Displacement of each vertex per load, where all of them give way [1/kg].
  std::array<double, 4> share{};
  Vec3 normal = Vec3::Zero();
  Vec3 before = Vec3::Zero();  ///< from side to side at the start of the substep [m]
  double distance = 0.0;       ///< to keep along the normal [m]
  double aim = 0.0;            ///< distance to reach in this substep [m]
  double mobility = 0.0;       ///< displacement of the sides against each other per load [1/kg]
  double friction = 0.0;       ///< Coulomb coefficient [-]
  double load = 0.0;  ///< sum of pushes in this substep, mass times displacement [kg m], >= 0
  Vec3 drag = Vec3::Zero();  ///< sum of friction in this substep [kg m]
  std::int32_t corners = 0;  ///< vertices on the first side: 1 or 2
};

/// Projects contacts one after the other (projected Gauss-Seidel, Jean 1999), with Coulomb
/// friction: the sum of what a contact has pushed never pulls, and bounds the sum of its friction.
class ContactSweeps {
 public:
  void clear() { pushes_.clear(); }
  /// Adds a contact without load. Sets its aim and its mobility.
  /// \param h  length of the substep [s].
  void add(const LayerPush& push, double h);
  const std::vector<LayerPush>& pushes() const { return pushes_; }

  /// Sweeps once forwards and once backwards over all contacts.
  /// \return how many carry load.
  int project(const SubstepMotion& motion);
  /// Takes up what is left of the load, layer by layer away from what supports the cloth, with
  /// layers that are supported at rest (shock propagation: Guendelman et al. 2003). Without it a
  /// stack sinks into itself and creeps on slopes, because sweeps carry a load by one layer each.
  /// \param supported  by vertex: 1 if an obstacle or a holder has stopped it; vertices above are
  ///     added.
  void settle(const SubstepMotion& motion, std::vector<std::uint8_t>& supported);

 private:
  /// Motion of the vertices of a contact per load, where some stay [1/kg].
  struct Mobility {
    std::array<double, 4> share{};  ///< of each vertex
    double ofSides = 0.0;           ///< against each other
  };

  static void limit(Mobility& of);
  static bool projectOne(LayerPush& push, const Mobility& mobility, const SubstepMotion& motion);
  static bool isSideSupported(const LayerPush& push, bool first,
                              const std::vector<std::uint8_t>& supported);
  void settleLevel(const SubstepMotion& motion, const std::vector<std::uint8_t>& supported);
  void settleOne(LayerPush& push, const SubstepMotion& motion,
                 const std::vector<std::uint8_t>& supported);

  std::vector<LayerPush> pushes_;
  std::vector<std::uint32_t> pending_;  ///< scratch: contacts that wait for support
  std::vector<VertexId> raised_;        ///< scratch: vertices that a level of layers supports
};

}  // namespace cloth_sim
