#pragma once
/// \file The springs of a mesh: where they are, and how stiff each is.

#include <array>
#include <optional>
#include <string>

#include "cloth_sim/cloth/raw_spring_fractions.h"
#include "cloth_sim/cloth/spring_calibration.h"
#include "cloth_sim/mesh/material_strips.h"
#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Constants per spring instead of a fabric, for reproducing published mass-spring demos. Each
/// applies to a whole spring of the undamaged mesh; where the surface opens, the parts of a spring
/// divide it among themselves.
struct RawSprings {
  /// Constants by kind: stiffness [N/m] if `perStretch` is false; otherwise force per stretch
  /// ratio, f = c (l / l0 - 1), c in [N].
  std::array<double, kSpringKinds> constant{};
  bool perStretch = false;
  double dashpot = 0.0;  ///< along every spring [N s/m]
};

/// The material from which the springs of one cloth are derived.
struct SpringRecipe {
  Fabric fabric;
  SpringSelection selection;
  std::optional<RawSprings> raw;  ///< instead of the fabric
};

/// The effect of an edit of the mesh on its springs. Slots are stable and never reused; a spring
/// one of whose ends was split continues in its slot, as `modified`.
struct SpringChanges {
  std::vector<std::int32_t> added;     ///< slots of new springs, ascending
  std::vector<std::int32_t> modified;  ///< slots whose constants or ends changed, ascending
  std::vector<std::int32_t> removed;   ///< slots that are empty now, ascending
  std::vector<Spring> removedSprings;  ///< the former contents of `removed`, in the same order
};

struct SpringMatch;

/// The springs of a mesh. Every edge has one (structural along a thread, shear otherwise), every
/// interior shear edge has a second one across it, and bend springs join the two neighbours of a
/// vertex through which a thread passes straight. On a grid this is the classic stencil of
/// 4 structural, 4 shear and 4 bend neighbours (Provot 1995).
///
/// The springs around a vertex are a function of the faces around it, so an edit of the mesh
/// derives only those around the vertices that it touched.
class SpringNetwork {
 public:
  SpringNetwork() = default;
  /// Derives the springs of one cloth from its fabric.
  SpringNetwork(const TriangleMesh& mesh, const Fabric& fabric, const SpringSelection& selection);
  /// Derives the springs of one cloth from constants per spring.
  SpringNetwork(const TriangleMesh& mesh, const RawSprings& raw, const SpringSelection& selection);
  /// Derives the springs of several cloths.
  /// \param recipes  one for each cloth.
  /// \throws std::invalid_argument if their number is not that of the cloths.
  SpringNetwork(const TriangleMesh& mesh, MaterialStrips strips,
                const std::vector<SpringRecipe>& recipes);

  /// All slots; some may be empty (`!exists()`) after edits.
  const SpringSlots& slots() const { return slots_; }
  /// The changes that modify every slot, for initialising what is otherwise updated by changes.
  SpringChanges allModified() const;
  Spring operator[](std::int32_t slot) const { return slots_[slot]; }
  /// Slots of the springs that have `v` as a support (see Spring::support), ascending.
  IndexSpan springsOn(VertexId v) const;
  /// Slots of the springs that have any of `vertices` as a support, ascending, unique. Vertices
  /// that are newer than the network have none.
  std::vector<std::int32_t> springsOnAny(const std::vector<VertexId>& vertices) const;
  /// Number of springs.
  std::int32_t count() const;
  std::int32_t count(SpringKind kind) const { return count_[static_cast<std::size_t>(kind)]; }

  /// Derives the springs around the touched vertices again after an edit of the mesh.
  /// \param mesh  after the edit.
  SpringChanges applyChanges(const TriangleMesh& mesh, const MeshChanges& changes);

  /// Sets a factor on the stiffness of every spring, present and future, relative to that of the
  /// fabric or the raw constants. Dashpots of a fabric keep their retardation time, raw ones their
  /// constant.
  /// \param scale  > 0; replaces an earlier factor.
  SpringChanges setScale(const TriangleMesh& mesh, double scale);
  /// Tells whether the springs of the cloth of vertex `v` have raw constants.
  bool isRaw(const TriangleMesh& mesh, VertexId v) const {
    return anyRaw_ && clothAt(mesh, v).raw.has_value();
  }
  double scale() const { return scale_; }

  /// Checks that every spring stands on the mesh as its kind says, once, and that the tables agree.
  /// For springs that were read from a file.
  /// \param mesh       valid.
  /// \param undamaged  the springs of the same cloths before any edit.
  /// \return one sentence about the first error; empty if there is none.
  std::string validationError(const TriangleMesh& mesh, const SpringNetwork& undamaged) const;

 private:
  /// The parameters that the springs of one cloth are computed from.
  struct Cloth {
    SpringSelection selection;
    SpringCalibration calibration;  ///< of the fabric
    std::optional<RawSprings> raw;
    /// Mean rest lengths of raw bend springs of the undamaged mesh, along warp and weft [m].
    std::array<double, 2> rawBendLength{0.0, 0.0};
  };
  const Cloth& clothAt(const TriangleMesh& mesh, VertexId v) const {
    return cloths_[strips_.at(mesh.material(v))];
  }
  void build(const TriangleMesh& mesh);
  void measureRawBends(const TriangleMesh& mesh);
  SpringChanges update(const std::vector<SpringMatch>& matches, const std::vector<Spring>& derived);
  SpringChanges applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes);
  // A sink is called with each derived spring.
  template <typename Sink>
  void deriveOnEdge(const TriangleMesh& mesh, VertexId a, VertexId b, const Sink& sink) const;
  template <typename Sink>
  void deriveBends(const TriangleMesh& mesh, VertexId v, const std::vector<VertexId>& neighbours,
                   const Sink& sink) const;
  template <typename Sink>
  void deriveAroundAll(const TriangleMesh& mesh, const std::vector<VertexId>& vertices,
                       const Sink& sink) const;
  void setConstants(const TriangleMesh& mesh, const IndexSpan& on, Spring& spring) const;
  RawSpringFraction rawFraction(const TriangleMesh& mesh, const IndexSpan& on,
                                const Spring& spring) const;
  const IndexLists& supported() const;
  std::string tableError(const TriangleMesh& mesh, const SpringNetwork& undamaged) const;
  std::int32_t insert(const Spring& spring);
  void erase(std::int32_t slot);
  void replace(std::int32_t slot, const Spring& spring);

  friend class cereal::access;
  /// Archives what edits and commands change; the rest follows from the scene.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(rawFractions_, slots_, supported_, count_, scale_);
  }

  MaterialStrips strips_;
  std::vector<Cloth> cloths_{Cloth()};  ///< by strip
  bool anyRaw_ = false;
  double scale_ = 1.0;               ///< factor on every stiffness
  RawSpringFractions rawFractions_;  ///< up to date only if `anyRaw_`
  SpringSlots slots_;
  /// Slots of supported springs, by vertex. Built at the first request: a cloth that is never cut
  /// does without the memory.
  mutable IndexLists supported_;
  std::array<std::int32_t, kSpringKinds> count_{};  ///< by kind
};

}  // namespace cloth_sim
