#pragma once
/// \file Springs derived from a mesh: which there are, and how stiff each is.

#include <array>
#include <optional>
#include <set>

#include "cloth_sim/cloth/raw_spring_fractions.h"
#include "cloth_sim/cloth/spring_calibration.h"
#include "cloth_sim/mesh/material_strips.h"
#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Constants per spring instead of a fabric, for reproducing published mass-spring demos. Each
/// holds for a whole spring of the undamaged mesh; where the surface opens, the parts share it.
struct RawSprings {
  /// Per kind: [N/m] if `perStretch` is false; else force per stretch ratio, f = c (l/l0 - 1) [N].
  std::array<double, kSpringKinds> constant{0.0, 0.0, 0.0};
  bool perStretch = false;
  double dashpot = 0.0;  ///< along every spring [N s/m]
};

/// What the springs of one cloth are made from.
struct SpringRecipe {
  Fabric fabric;
  SpringSelection selection;
  std::optional<RawSprings> raw;  ///< instead of the fabric
};

/// How springs changed when the network followed an edit of its mesh. Slots are stable and are not
/// used again; a spring whose end was split goes on in its slot, as `modified`.
struct SpringChanges {
  std::vector<std::int32_t> added;     ///< slots that came to be, ascending
  std::vector<std::int32_t> modified;  ///< slots whose constants or ends changed, ascending
  std::vector<std::int32_t> removed;   ///< slots that are empty now, ascending
  std::vector<Spring> removedSprings;  ///< what was in `removed`, in the same order
};

/// Springs of a mesh: every edge, the other diagonal across every bias edge, and bend springs over
/// vertices that a thread passes straight through. On a grid this is the classic stencil of
/// 4 structural, 4 shear and 4 bend neighbours (Provot 1995).
class SpringNetwork {
 public:
  SpringNetwork() = default;
  SpringNetwork(const TriangleMesh& mesh, const Fabric& fabric, const SpringSelection& selection);
  SpringNetwork(const TriangleMesh& mesh, const RawSprings& raw, const SpringSelection& selection);
  /// \param recipes  one for each strip.
  SpringNetwork(const TriangleMesh& mesh, MaterialStrips strips,
                const std::vector<SpringRecipe>& recipes);

  /// All slots; some may be empty (`!exists()`) after edits.
  const SpringSlots& slots() const { return slots_; }
  /// As if every one of them had been modified: for who begins to follow a network that has been
  /// edited.
  SpringChanges allModified() const;
  Spring operator[](std::int32_t slot) const { return slots_[slot]; }
  /// Slots of the springs that stand on the faces around `v` (see Spring::support).
  IndexSpan springsOn(VertexId v) const;
  /// The same around any of `vertices`, ascending, unique. Vertices that the network does not know
  /// have none.
  std::vector<std::int32_t> springsOnAny(const std::vector<VertexId>& vertices) const;
  std::int32_t count() const { return count_[0] + count_[1] + count_[2]; }
  std::int32_t count(SpringKind kind) const { return count_[static_cast<int>(kind)]; }

  /// Rebuilds the springs around the vertices that an edit touched.
  SpringChanges applyChanges(const TriangleMesh& mesh, const MeshChanges& changes);

  /// Takes springs away for good: they do not come back when the network follows an opening (but
  /// refining the mesh there makes new ones).
  /// \param slots  ascending.
  SpringChanges clear(const std::vector<std::int32_t>& slots);

  /// Multiplies the stiffness of every spring, there now or made later, by `scale` against that of
  /// the fabric or the raw constants. Dashpots of a fabric keep their retardation time, raw ones
  /// their constant.
  /// \param mesh   what the springs stand on.
  /// \param scale  > 0; not on top of an earlier one.
  SpringChanges setScale(const TriangleMesh& mesh, double scale);
  double scale() const { return scale_; }

 private:
  /// A recipe, worked out.
  struct Cloth {
    SpringSelection selection;
    SpringCalibration calibration;  ///< of the fabric
    std::optional<RawSprings> raw;
    /// Usual rest lengths of raw bend springs along warp and weft at first [m].
    std::array<double, 2> rawBendLength{0.0, 0.0};
  };
  const Cloth& clothAt(const TriangleMesh& mesh, VertexId v) const {
    return cloths_[strips_.at(mesh.material(v))];
  }
  void build(const TriangleMesh& mesh);
  void measureRawBends(const TriangleMesh& mesh);
  void applyClearedEdges(const MeshChanges& changes);
  SpringChanges applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes);
  template <typename Sink>
  void deriveEdge(const TriangleMesh& mesh, VertexId a, VertexId b, const Sink& sink) const;
  template <typename Sink>
  void deriveBends(const TriangleMesh& mesh, VertexId v, const std::vector<VertexId>& neighbours,
                   const Sink& sink) const;
  void setConstants(const TriangleMesh& mesh, const IndexSpan& on, Spring& spring) const;
  RawSpringFraction rawShare(const TriangleMesh& mesh, const IndexSpan& on,
                             const Spring& spring) const;
  template <typename Sink>
  void deriveAroundAll(const TriangleMesh& mesh, const std::vector<VertexId>& vertices,
                       const Sink& sink) const;
  const IndexLists& standing() const;
  std::int32_t insert(const Spring& spring);
  void erase(std::int32_t slot);
  void replace(std::int32_t slot, const Spring& spring);

  friend class cereal::access;
  /// What edits change; the rest is as the scene has it.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(rawShares_, slots_, standing_, count_, cleared_, scale_);
  }

  MaterialStrips strips_;
  std::vector<Cloth> cloths_{Cloth()};  ///< by strip
  bool anyRaw_ = false;
  double scale_ = 1.0;            ///< of every stiffness
  RawSpringFractions rawShares_;  ///< kept if `anyRaw_`
  SpringSlots slots_;
  /// By vertex; made when it is first asked for: a cloth that nobody cuts does without.
  mutable IndexLists standing_;
  std::array<std::int32_t, kSpringKinds> count_{0, 0, 0};
  std::set<std::array<std::uint64_t, 2>> cleared_;  ///< keys of springs that were cleared
};

}  // namespace cloth_sim
