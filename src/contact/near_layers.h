#pragma once
/// \file Layers of cloth near each other: what a substep does about them.

#include "cloth_sim/contact/layers.h"
#include "face_pairs.h"
#include "layer_contacts.h"

namespace cloth_sim {

/// Half of the largest thickness [m].
double marginOf(const std::vector<LayerProperties>& byCloth);

/// Searches for pairs of faces near each other, projects layers apart, and certifies that no two
/// faces intersect. See `LayerContact`, which asks for it in the steps in which cloth is not known
/// to be far from itself.
class NearLayers {
 public:
  /// Follows the mesh. A step has to begin before anything else.
  void build(const Model& model, const std::vector<LayerProperties>& byCloth);
  /// Finds faces that touch or intersect each other.
  /// \param isAsked  by face: 1 if pairs with it matter.
  LayerOverlap overlapOf(const std::vector<Vec3>& x, const std::vector<std::uint8_t>& isAsked);

  void beginStep(StepPart part);
  /// Tells whether a step begins with the pairs of its first part.
  bool mayGoOn() const { return mayGoOn_; }
  void load(const ParticleView& particles);
  void project(const ParticleView& particles, double h);
  void settle(const ParticleView& particles, double h);
  void certify(const ParticleView& particles);

  bool isBlocked(std::size_t v) const { return report_.blocked > 0 && isHeldBack(v); }
  bool carriesLoad() const { return report_.contacts > 0; }
  /// Figures of the step so far, but for `LayerReport::moves`.
  LayerReport report() const;
  std::vector<LayerContactPoint> contactPoints() const;
  /// Vertices that the last `project` which found contacts has pushed, ascending.
  const std::vector<VertexId>& pushed() const { return pushed_; }

 private:
  bool goesOn(const ParticleView& particles) const;
  void forgetPairs();
  void loadMotion(const ParticleView& particles);
  void loadSupported(const ParticleView& particles);
  void loadAll(const ParticleView& particles);
  void loadPairs(const ParticleView& particles);
  void store(const ParticleView& particles) const;
  void storePushed(const ParticleView& particles);
  void storeOne(VertexId v, const ParticleView& particles) const;
  double farthestMotion();
  void giveUp(const ParticleView& particles);
  void stop(const ParticleView& particles);
  NearFaces nearFaces() const { return {search_.near(), pairs_.faces(), search_.boxes()}; }
  SubstepMotion motion() { return {start_, end_, mass_, vertices_}; }
  bool isHeldBack(std::size_t v) const { return truncated_[v] != 0 && mass_[v] == 0.0; }
  void search();
  bool searchAroundLeft(const ParticleView& particles);
  void searchAll(const ParticleView& particles);
  void listVertices();

  std::vector<Face> faces_;
  double margin_ = 0.0;  ///< half of the largest thickness [m]
  FacePairSearch search_;
  FacePairs pairs_;
  LayerContacts contacts_;
  LayerReport report_;              ///< but for `moves` and `leastDistance`
  std::vector<VertexId> pushed_;    ///< see `pushed`
  double most_ = 0.0;               ///< most motion in a substep [m]
  bool isFresh_ = false;            ///< pairs are those of this step
  bool mayGoOn_ = false;            ///< pairs are those of an earlier part of this step
  bool isBrief_ = false;            ///< the next search is that of the rest of a step
  std::vector<VertexId> all_;       ///< all vertices
  std::vector<VertexId> vertices_;  ///< those that arrays of the substep are loaded for, ascending
  std::vector<Vec3> start_, end_;   ///< of the substep, by vertex [m]
  std::vector<double> mass_;        ///< by vertex [kg]; 0: prescribed motion
  std::vector<std::uint8_t> truncated_;  ///< by vertex
  std::vector<std::uint8_t> supported_;  ///< by vertex; see LayerContacts::settle
  std::vector<std::uint8_t> isListed_;   ///< by vertex: 1 if it belongs to a pair
  std::size_t listed_ = 0;               ///< faces of pairs whose vertices have that mark
};

}  // namespace cloth_sim
