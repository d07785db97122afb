#pragma once
/// \file Everything that holds particles of the cloth: pins, clamps and the pull of a pointer.

#include <string>
#include <vector>

#include "cloth_sim/clamp/drag.h"
#include "cloth_sim/clamp/grip_event.h"

namespace cloth_sim {

/// The pins and clamps of a simulation and the pull at a particle, in this order of precedence:
/// where several hold the same particle, the first one keeps it.
class Holders {
 public:
  /// \param pins    where the pinned particles stay, ascending by vertex.
  /// \param clamps  the scene's clamps.
  Holders(std::vector<KinematicTarget> pins, const std::vector<ClampSpec>& clamps);

  const std::vector<Clamp>& clamps() const { return clamps_; }
  std::vector<Clamp>& clamps() { return clamps_; }
  const Drag& drag() const { return drag_; }
  Drag& drag() { return drag_; }

  /// Returns the clamp of that name, or nullptr if there is none.
  Clamp* find(const std::string& clamp);
  std::vector<std::string> clampNames() const;
  /// Adds a clamp.
  /// \throws std::invalid_argument if the specification is invalid, or names a patch that `model`
  ///         does not have.
  void add(const ClampSpec& spec, const Model& model);
  /// Removes the clamp of that name, if there is one; what it held is free.
  /// \return whether there was one.
  bool remove(const std::string& clamp);

  /// Remembers clamps and pull as they are before a step, for `takeBack`.
  void remember();
  /// Puts clamps and pull back to where they were at the last `remember`. No edit of the mesh may
  /// have been made since.
  void takeBack();

  /// Clears the wrenches of the clamps, and moves clamps and the pull by one step.
  /// \param state   before the step.
  /// \param layers  null if layers of cloth do not touch.
  void advance(const Model& model, const State& state, double dt, const LayerContact* layers);

  /// Fills in `controls.kinematic` (each held particle once, ascending by vertex) and
  /// `controls.forces` (friction of clamps that slip).
  void gatherControls(const Model& model, Controls& controls);

  /// Tells whether some clamp has a limited grip force, so that a step may have to be solved again.
  bool mayYield() const;
  /// Lets every clamp slip whose grip force is less than what it would have to bear.
  /// \param controls, report  of the step as it was solved with all of them holding.
  /// \return whether some clamp has begun to slip: then the step must be solved again.
  bool yield(const Controls& controls, const StepReport& report);

  /// Adds the forces of the cloth during a part of the step to the wrenches of the clamps.
  /// \param state     after that part.
  /// \param fraction  of the step that it took, in (0, 1].
  void addReactions(const Controls& controls, const StepReport& report, const Model& model,
                    const State& state, double fraction);

  /// Lets clamps whose cloth other layers have stopped wait for it.
  /// \param state   after a step of `dt` [s].
  /// \param layers  null if layers of cloth do not touch.
  void holdBack(const State& state, double dt, const LayerContact* layers);

  /// Records what has happened to the grips during the step.
  /// \param layers  null if layers of cloth do not touch.
  void recordGripEvents(const Model& model, const State& state, const ColliderSet& colliders,
                        const LayerContact* layers);
  /// Returns the recorded events since the last call, in order.
  std::vector<GripEvent> takeGripEvents();

  /// Returns the held particles, ascending.
  std::vector<VertexId> heldVertices() const;

  /// Tells whether the next steps leave every clamp exactly as it is, and nothing is pulled.
  bool areStill() const;
  /// Tells whether every clamp stands at its target.
  bool areAtTarget() const;
  /// Tells whether no clamp is still closing.
  bool haveClosed() const;

  /// Updates pins, clamps and the pull for an edit of the mesh.
  void applyChanges(const MeshChanges& changes);

 private:
  friend class StateFormat;

  std::vector<KinematicTarget> pins_;  ///< ascending by vertex
  std::vector<Clamp> clamps_;
  Drag drag_;
  std::vector<Clamp> clampsBefore_;  ///< before the step
  Drag dragBefore_;                  ///< before the step
  GripWatch gripWatch_;
  std::vector<GripEvent> gripEvents_;
  std::vector<KinematicTarget> targets_;  ///< scratch: of all holders, in order of precedence
  std::vector<std::size_t> order_;        ///< scratch: indices into targets_, by vertex
};

}  // namespace cloth_sim
