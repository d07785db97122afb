#pragma once
/// \file Contact between layers of cloth: of one cloth with itself, and of several cloths.

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/contact/contacts.h"

namespace cloth_sim {

/// Properties of a cloth that decide its contact with other layers.
struct LayerProperties {
  double thickness = 0.0;  ///< [m], > 0
  double friction = 0.3;   ///< Coulomb coefficient between layers [-], >= 0
};

/// Figures of layer contact over one step.
struct LayerReport {
  int pairs = 0;               ///< pairs of faces near each other at the end
  int contacts = 0;            ///< contacts that carried load in the last substep
  int detections = 0;          ///< searches of all faces for pairs
  std::int64_t truncated = 0;  ///< motions of vertices that were shortened, over all substeps
  std::int64_t moves = 0;      ///< motions of vertices, over all substeps
  std::int64_t unproven = 0;   ///< pairs that touched or intersected at the start of a substep
  int blocked = 0;             ///< held vertices whose motion was shortened in the last substep
  /// Least distance of two layers among the contacts that carried load in the last substep, at its
  /// end [m]; infinite without any. Contacts across the lips of a cut do not count.
  double leastDistance = std::numeric_limits<double>::infinity();

  /// Share of the motions of vertices that were shortened, in [0, 1].
  double truncatedShare() const {
    return moves > 0 ? static_cast<double>(truncated) / static_cast<double>(moves) : 0.0;
  }
};

/// Most contacts that `LayerContact::contactPoints` lists.
constexpr std::size_t kMostContactPoints = 5000;

/// A contact between layers that carried load in the last substep.
struct LayerContactPoint {
  Vec3 place = Vec3::Zero();   ///< in the middle between the layers [m]
  Vec3 normal = Vec3::Zero();  ///< across the layers, of unit length
  double force = 0.0;          ///< along the normal, mean over the substep [N], > 0
};

/// Pairs of faces that touch or intersect.
using FacePairList = std::vector<std::array<FaceId, 2>>;

/// Faces that touch or intersect each other.
struct LayerOverlap {
  FacePairList pairs;
  Vec3 place = Vec3::Zero();  ///< of the first of them [m]
};

/// The part of a step that is to be done.
enum class StepPart {
  kWhole,
  kRest,   ///< what is left after a failure
  kAgain,  ///< a whole step or a rest, once more, because the cloth has come near itself in it
};

/// Keeps layers of cloth a thickness apart, with friction, and certifies that no two faces
/// intersect at the end of any substep or on the way there.
///
/// Where the cloth is nowhere near itself, that is checked every few substeps (clearance.h), and
/// nothing else is done. If it comes near itself all the same, the step is to be done again. Else
/// faces are searched for pairs near each other at the start of a step (material_tree.h), and
/// around vertices and faces that leave the boxes and balls of gradients that it allowed
/// (allowance.h). In each substep pairs nearer than the thickness are projected apart, then once
/// more from what supports them upwards (layer_contacts.h); at its end the motion of vertices is
/// shortened where two faces would lose the plane between them (face_pairs.h). docs/layers.md has
/// the proof.
///
/// It keeps no memory from one step to the next.
class LayerContact {
 public:
  /// \param byCloth  properties by cloth.
  LayerContact(const Model& model, std::vector<LayerProperties> byCloth);
  ~LayerContact();
  LayerContact(const LayerContact&) = delete;
  LayerContact& operator=(const LayerContact&) = delete;

  /// Follows an edit of the mesh.
  void onModelChanged(const Model& model);
  /// Finds faces that touch or intersect each other.
  /// \param model  that was followed last.
  /// \param x      positions, by vertex [m].
  LayerOverlap findOverlap(const Model& model, const std::vector<Vec3>& x);
  /// The same, but only pairs with one of `faces`: those that have changed since no faces touched.
  LayerOverlap findOverlap(const Model& model, const std::vector<Vec3>& x,
                           const std::vector<FaceId>& faces);
  /// Prepares for a step. In a rest, pairs are searched again only if the mesh was edited or the
  /// cloth is not where it was.
  /// \param model  that was followed last; it has to stay in its place during the step.
  void beginStep(const Model& model, StepPart part);
  /// Reads where a substep leads before obstacles stop it.
  void load(const ParticleView& particles);
  /// Moves layers apart, as displacements at the end of a substep of `h` [s].
  void project(const ParticleView& particles, double h);
  /// Takes up the load that is left, from the particles that obstacles have moved since `load`
  /// upwards.
  void settle(const ParticleView& particles, double h);
  /// Shortens motions that would make faces intersect. Nothing may move particles afterwards in the
  /// same substep.
  void certify(const ParticleView& particles);
  /// Tells, before the first substep, whether the step may have to be done again.
  bool mayComeNear() const;
  /// Ends a step after any number of substeps.
  /// \return whether it holds; if not, it is to be done again from its start.
  bool endStep(const ParticleView& particles);
  /// Tells whether the step is to be done again: the cloth has come near itself unexpectedly.
  bool hasComeNear() const;

  /// Figures of the step so far. Takes a pass over the contacts.
  LayerReport report() const;
  /// Tells whether a held vertex was kept from following its holder at the end of the last step.
  bool isBlocked(VertexId v) const;
  /// Tells whether contacts carried load in the last substep.
  bool carriesLoad() const;
  /// Vertices that contacts have pushed in the last `project`, ascending, if they carried load.
  const std::vector<VertexId>& pushed() const;
  /// Returns the contacts that carried load in the last substep, at its end; of more than
  /// kMostContactPoints, as many that are evenly spread over the list of all. Computed at each
  /// call.
  std::vector<LayerContactPoint> contactPoints() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cloth_sim
