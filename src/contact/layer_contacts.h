#pragma once
/// \file Contacts between layers of cloth: closest points and their projection, with friction.

#include <array>

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/contact/layers.h"
#include "face_pairs.h"

namespace cloth_sim {

/// Contacts between vertices and faces, and between edges, of layers near each other. Each substep
/// projects those that are too near, one after the other, with Coulomb friction as displacements,
/// as obstacles do (contact/contacts.h).
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
  void assign(const std::vector<FaceIds>& near, const std::vector<Vec3>& x,
              const std::vector<double>& allowance);
  /// Moves vertices apart that are nearer than the thickness at the end of the substep.
  /// \param mass  by vertex [kg]; 0: prescribed motion.
  void project(SubstepMotion motion, const std::vector<double>& mass, double h);

  /// Contacts that were too near in the last substep.
  int active() const { return active_; }
  /// Least distance of contacts at the last refreshing [m]; infinite without any.
  double leastDistance() const { return least_; }

 private:
  /// A vertex and a face, or two edges: (v, corners) or (ends, ends).
  struct Candidate {
    std::array<VertexId, 4> v{};
    FaceId face = kNone;     ///< kNone for two edges
    double thickness = 0.0;  ///< as in Layers [m]
    double friction = 0.0;
    bool areEdges() const { return face == kNone; }
  };
  /// The weighted sum of the positions of four vertices points from one side to the other.
  struct Contact {
    std::array<VertexId, 4> v{};
    std::array<double, 4> weight{};
    Vec3 normal = Vec3::Zero();
    double distance = 0.0;  ///< to keep along the normal [m]
    double friction = 0.0;
  };
  /// The closest points of a candidate.
  struct Closest {
    Contact contact;
    double apart = 0.0;     ///< [m]
    bool isInside = false;  ///< inside the face, or inside both edges
  };

  void addVertexFace(VertexId p, FaceId face, const std::vector<Vec3>& x, double reach,
                     const Layers& layers);
  void addEdges(const std::array<VertexId, 4>& v, const std::vector<Vec3>& x, double reach,
                const Layers& layers);
  void sortByVertex();
  void refresh(const std::vector<Vec3>& x);
  bool find(const Candidate& candidate, const std::vector<Vec3>& x, Closest& out) const;
  bool isClosestFace(std::size_t first, std::size_t last, std::size_t at) const;
  void projectOne(const Contact& contact, SubstepMotion motion, const std::vector<double>& mass,
                  double h);
  Layers layersOf(FaceId f, FaceId g) const;

  std::vector<Face> faces_;
  std::vector<Vec2> material_;                    ///< by vertex [m]
  std::vector<std::uint8_t> clothOfFace_;         ///< by face
  std::vector<FaceId> firstFace_;                 ///< by vertex
  std::vector<std::array<FaceId, 3>> edgeOwner_;  ///< by face: first face of each edge
  std::vector<LayerProperties> byCloth_;
  std::vector<Candidate> candidates_;
  std::vector<Candidate> sorted_;    ///< scratch
  std::vector<std::int32_t> first_;  ///< scratch: by vertex
  std::vector<Closest> closest_;     ///< by candidate
  std::vector<Contact> contacts_;
  int sinceRefresh_ = 0;
  int active_ = 0;
  double least_ = 0.0;
};

}  // namespace cloth_sim
