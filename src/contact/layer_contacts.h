#pragma once
/// \file Contacts between layers of cloth: closest points and their projection, with friction.

#include <array>

#include "contact_sweeps.h"
#include "layer_candidates.h"

namespace cloth_sim {

/// Contacts between vertices and faces, and between edges, of layers near each other. In each
/// substep those that touch are projected (`ContactSweeps`).
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
  /// \param boxes  around the places that vertices may take until the next search, half of the
  ///     thickness larger, by vertex.
  void assign(const std::vector<FaceIds>& near, const std::vector<QuickBox>& boxes);
  /// Follows a search around a part of the cloth.
  /// \param near   all pairs.
  /// \param known  number of those that have been listed; the others are new.
  /// \param moved  vertices with new boxes, and faces with such corners.
  void extend(const std::vector<FaceIds>& near, std::size_t known, const Renewed& moved,
              const std::vector<QuickBox>& boxes);
  /// Moves vertices apart that are nearer than the thickness at the end of the substep.
  void project(const SubstepMotion& motion, double h);
  /// Takes up what is left of the load, from supported vertices on (`ContactSweeps::settle`).
  void settle(const SubstepMotion& motion, std::vector<std::uint8_t>& supported) {
    sweeps_.settle(motion, supported);
  }

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
    double distance = 0.0;     ///< to keep along the normal [m]
    std::int32_t corners = 0;  ///< vertices on the first side: 1 or 2
  };
  void listContacts(const std::vector<Vec3>& x);
  static bool canCarry(const ClosestPoints& closest, const std::vector<Vec3>& x);
  Contact contactAt(const ClosestPoints& closest, const std::vector<Vec3>& x) const;
  void sortByVertex(const std::vector<Vec3>& x);
  const ClosestPoints& pointsAt(std::size_t at) const { return candidates_.found()[order_[at]]; }
  void findTouching(const SubstepMotion& motion);
  static bool mayTouch(const Contact& contact, const SubstepMotion& motion);
  bool isListed(std::size_t first, std::size_t at) const;
  bool isClosestFace(std::size_t first, std::size_t last, std::size_t at) const;
  LayerPush pushOf(const Contact& contact, const std::vector<Vec3>& start) const;
  Layers layersOf(const std::array<VertexId, 4>& v) const;
  bool isBetweenLayers(const LayerPush& push) const;
  std::vector<LayerPush> loaded() const;

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
  std::vector<std::uint8_t> isTouching_;  ///< by contact: 1 if it touches or nearly so
  ContactSweeps sweeps_;                  ///< over the contacts that touch, ascending
  int active_ = 0;
  double substep_ = 0.0;  ///< length of the last substep [s]
};

}  // namespace cloth_sim
