#pragma once
/// \file Edits of the cloth's mesh in a simulation: tears, cuts, refinement, loose scraps.

#include "cloth_sim/sim/failure_history.h"
#include "cloth_sim/sim/guarded_solver.h"
#include "cloth_sim/surgery/operation.h"

namespace cloth_sim {

/// The cloth under surgery, and everything that keeps data about its mesh.
struct EditedCloth {
  Model& model;
  State& state;
  Holders& holders;
  GuardedSolver& solver;
  LayerContact* layers;  ///< null if layers of cloth do not touch
};

/// Plans edits of the mesh, has surgery/operation.h carry them out, and brings everything that
/// keeps data about the mesh up to date. Operations keep mass and momentum (see `cut` and `refine`
/// there).
class Surgery {
 public:
  Surgery(const SurgerySettings& settings, const TearingSettings& tearing, const Model& model);

  /// Cuts along the line in which the stroke meets the cloth; nothing if it misses. Where it begins
  /// or ends within half an edge of the tip of an earlier cut or tear, it continues from there. A
  /// stroke that begins where the last one ended also continues from the tips of that, within eight
  /// edges (surgery/tip_joint.h). If the scene asks for it, the strip within the half-width of
  /// the stroke is removed.
  /// \throws OperationRefused, and nothing has changed.
  SurgeryResult cutAlong(const Stroke& stroke, const EditedCloth& cloth);
  /// Cuts along a path in material coordinates; near tips as `cutAlong`.
  /// \throws OperationRefused, and nothing has changed.
  SurgeryResult cutNotch(const MaterialPath& notch, const EditedCloth& cloth);
  /// Refines the mesh near points in the world.
  /// \throws TooManyParticles, and nothing has changed.
  void refine(const RefineNear& request, const EditedCloth& cloth);
  /// Opens the surface where springs are overloaded, stride by stride until nothing more tears or
  /// layers of cloth are in the way; then it tears later.
  /// \param dt  how long the springs may have been overloaded [s].
  /// \throws TooManyParticles; the strides before have been made.
  void tear(double dt, const EditedCloth& cloth);

  const Tearing& tearing() const { return tearing_; }
  Tearing& tearing() { return tearing_; }
  /// The connected pieces of cloth.
  const ConnectedComponents& pieces() const { return pieces_; }
  const DroppedScraps& dropped() const { return dropped_; }
  const FailureHistory& failures() const { return failures_; }
  FailureHistory& failures() { return failures_; }
  /// Number of edits so far: grows whenever faces or springs change.
  std::uint64_t edits() const { return edits_; }

 private:
  friend class StateFormat;

  bool continuesLast(const Stroke& stroke) const;
  void noteTips(const SurgeryResult& result, const TriangleMesh& mesh);
  SurgeryResult operate(const CutPlan& plan, const EditedCloth& cloth);
  void applyChanges(const SurgeryResult& result, const EditedCloth& cloth);
  void removeStrip(double halfWidth, const EditedCloth& cloth, SurgeryResult& result);
  void dropScraps(const EditedCloth& cloth);
  void drop(const std::vector<FaceId>& faces, const EditedCloth& cloth);
  std::vector<double> areaUnlessKept(const EditedCloth& cloth) const;
  std::vector<std::int32_t> largestPieces(const Model& model,
                                          const std::vector<double>& area) const;

  SurgerySettings settings_;
  SurgeryLimits limits_;
  double edge_ = 0.0;  ///< shortest of the original mesh [m]
  Tearing tearing_;
  ConnectedComponents pieces_;
  DroppedScraps dropped_;
  FailureHistory failures_;
  Blade strokeEnd_;               ///< last pose of the last stroke
  std::vector<Vec2> strokeTips_;  ///< where its cuts end, material coordinates [m]
  std::uint64_t edits_ = 0;
};

}  // namespace cloth_sim
