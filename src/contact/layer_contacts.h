#pragma once
/// \file Contacts between layers of cloth: closest points and their projection, with friction.

#include <array>

#include "cloth_sim/contact/layers.h"
#include "layer_candidates.h"

namespace cloth_sim {

/// Contacts between vertices and faces, and between edges, of layers near each other. Each substep
/// projects them one after the other (projected Gauss-Seidel, Jean 1999), with Coulomb friction:
/// the sum of what a contact has pushed never pulls, and bounds the sum of its friction.
class LayerContacts {
 public:
  /// Thickness and friction of the layers of a pair of faces.
  struct Layers {
    double thickness = 0.0;  ///< distance of their middle surfaces at contact [m]
    double friction = 0.0;   ///< Coulomb coefficient [-]
  };

  /// Follows the mesh.
  void build(const Model& model, const std::vector<LayerProperties>& byCloth);
  void clear();
  /// Lists what can come into contact, from pairs of faces near each other.
  void assign(const NearFaces& near);
  /// Follows a search around a part of the cloth.
  /// \param known  number of pairs that have been listed; the others are new.
  /// \param moved  vertices with new boxes, and faces with such corners.
  void extend(const NearFaces& near, std::size_t known, const Renewed& moved);
  /// Moves vertices apart that are nearer than the thickness at the end of the substep.
  /// \param near  that was listed last.
  void project(const SubstepMotion& motion, double h, const NearFaces& near);
  /// Takes up what is left of the load, layer by layer away from what supports the cloth, with
  /// layers that are supported at rest (shock propagation: Guendelman et al. 2003). Without it a
  /// stack sinks into itself and creeps on slopes, because sweeps carry a load by one layer each.
  /// \param supported  by vertex: 1 if an obstacle or a holder has stopped it; vertices above are
  ///     added.
  void settle(const SubstepMotion& motion, double h, std::vector<std::uint8_t>& supported);

  /// Contacts that were too near in the last substep.
  int active() const { return active_; }
  /// Least distance of the contacts that carried load in the last substep [m]; infinite without
  /// any. Contacts between points that are near each other in the cloth laid flat do not count.
  /// \param x  positions, by vertex [m].
  double leastDistance(const std::vector<Vec3>& x) const;
  /// Returns contacts that carried load in the last substep, `most` at most, evenly chosen.
  std::vector<LayerContactPoint> loadedPoints(const std::vector<Vec3>& x, std::size_t most) const;

 private:
  /// The weighted sum of the positions of four vertices points from one side to the other.
  struct Contact {
    std::array<VertexId, 4> v{};
    std::array<double, 4> weight{};
    Vec3 normal = Vec3::Zero();
    double distance = 0.0;  ///< to keep along the normal [m]
  };
  /// The rest of a contact, which is read only where it touches.
  struct Push {
    std::int32_t corners = 0;  ///< vertices on the first side: 1 or 2
    double friction = 0.0;     ///< Coulomb coefficient [-]
    double load = 0.0;  ///< sum of pushes in this substep, mass times displacement [kg m], >= 0
    Vec3 drag = Vec3::Zero();  ///< sum of friction in this substep [kg m]
  };
  void listContacts(const std::vector<Vec3>& x);
  static bool canCarry(const ClosestPoints& closest, const std::vector<Vec3>& x);
  Contact contactAt(const ClosestPoints& closest, const std::vector<Vec3>& x) const;
  void sortByVertex(const std::vector<Vec3>& x);
  const ClosestPoints& pointsAt(std::size_t at) const { return candidates_.found()[order_[at]]; }
  void findTouching(const std::vector<Vec3>& x);
  bool isListed(std::size_t first, std::size_t at) const;
  bool isClosestFace(std::size_t first, std::size_t last, std::size_t at) const;
  bool projectFreely(std::size_t k, const SubstepMotion& motion, double h);
  bool projectOne(std::size_t k, const SubstepMotion& motion, const std::array<double, 4>& share,
                  double mobility, double h);
  bool isSideSupported(std::size_t k, bool first, const std::vector<std::uint8_t>& supported) const;
  void settleLevel(const SubstepMotion& motion, double h,
                   const std::vector<std::uint8_t>& supported);
  void settleOne(std::size_t k, const SubstepMotion& motion, double h,
                 const std::vector<std::uint8_t>& supported);
  Layers layersOf(const Contact& contact) const;
  bool isBetweenLayers(const Contact& contact) const;
  std::vector<std::uint32_t> loaded() const;

  std::vector<Face> faces_;
  std::vector<Vec2> material_;  ///< by vertex [m]
  std::vector<std::uint8_t> clothOfVertex_;
  std::vector<LayerProperties> byCloth_;
  LayerCandidates candidates_;
  std::vector<double> inverseMass_;      ///< by vertex [1/kg]; 0: prescribed motion
  std::vector<std::uint32_t> carrying_;  ///< scratch: closest points that can carry a contact
  std::vector<std::uint32_t> order_;  ///< scratch: of closest points: faces by vertex, then edges
  std::vector<std::uint32_t> first_;  ///< scratch: by vertex of faces, and of edges
  std::vector<Contact> contacts_;
  std::vector<Push> pushes_;              ///< by contact
  std::vector<std::uint8_t> isTouching_;  ///< by contact: 1 if listed in touching_
  std::vector<std::uint32_t> touching_;   ///< contacts of the substep, ascending
  std::vector<std::uint32_t> pending_;    ///< scratch: contacts that wait for support
  std::vector<VertexId> raised_;          ///< scratch: vertices that a level of layers supports
  int active_ = 0;
  double substep_ = 0.0;  ///< length of the last substep [s]
};

}  // namespace cloth_sim
