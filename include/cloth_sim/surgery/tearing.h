#pragma once
/// \file The tearing criterion: finds the springs that fail and the lines along which the surface
/// opens. It only plans; `cut` in surgery/operation.h edits the mesh.

#include <limits>
#include <map>
#include <optional>
#include <set>

#include "cloth_sim/surgery/material_path.h"
#include "cloth_sim/surgery/operation.h"
#include "cloth_sim/surgery/spring_length_monitor.h"

namespace cloth_sim {

/// A seam: the cloth tears only at springs that cross `path`, end on it, or have a midpoint within
/// `halfWidth` of it.
struct Seam {
  MaterialPath path;       ///< at least two points
  double halfWidth = 0.0;  ///< [m], >= 0
};

/// Length over rest length from which on a spring of each kind fails; infinity: never.
using TearRatios = std::array<double, kSpringKinds>;

/// Returns ratios at which no spring fails.
inline TearRatios infiniteRatios() {
  TearRatios ratio;
  ratio.fill(std::numeric_limits<double>::infinity());
  return ratio;
}

/// The tearing parameters of a scene.
struct TearingSettings {
  bool enabled = false;
  TearRatios ratio = infiniteRatios();
  /// Energies by cloth. With any, tears advance from tips where that pays, and no spring fails for
  /// its stretch; empty: springs fail by their ratios.
  std::vector<TearEnergy> energy;
  std::optional<Seam> seam;             ///< absent: the cloth may tear everywhere
  double tipSpeed = 5.0;                ///< largest speed of a tear through the material [m/s], > 0
  std::optional<Refinement> refineTip;  ///< around the next advance of a tear
};

/// Finds where cloth tears, and the line along which the surface opens there. There are two
/// criteria: the stretch of springs, or the energy that the advance of a tip releases.
///
/// A spring that crosses the seam opens the seam across the faces that the spring represents. Any
/// other spring lets the nearest tip within three edges advance. If there is no tip, a new tear
/// begins at the border or at the midpoint of the spring, unless it is near a tear that has just
/// advanced and will unload it. A tear advances across the faces around its tip, at right angles to
/// the direction of largest tension there, whatever the directions of the mesh.
///
/// By energy, a tip advances when the energy release rate there (see materialForce) reaches the
/// energy of the fabric in the direction of the tear (Griffith 1921). Force and time then do not
/// depend on the mesh. Tears begin only at the ends of cuts.
///
/// A tip advances at `tipSpeed` at most and carries the unused part of a step over to the next. The
/// stress at a tip should not be older than the time in which the tip crosses an edge, so steps
/// should end where a spring exceeds its limit: see `listLimits`.
class Tearing {
 public:
  Tearing(TearingSettings settings, const Model& model);

  const TearingSettings& settings() const { return settings_; }
  void setEnabled(bool enabled) { settings_.enabled = enabled; }
  void setRatio(const TearRatios& ratio);

  /// Lists the failure lengths of the springs that bear more than half of their failure strain; by
  /// energy, lengths at which a tip may come near its limit. When one is exceeded, call `plan`.
  /// \param limits  replaced by the list.
  void listLimits(const Model& model, const State& state, std::vector<LengthLimit>& limits);

  /// Tells whether the last plan found a spring beyond its limit that has not failed yet, because
  /// it waits for a tip or is near a tear that has just advanced.
  bool isOverloaded() const { return settings_.enabled && worst_ > 1.0; }
  /// Tells whether tears are decided by energy.
  bool isByEnergy() const { return !settings_.energy.empty(); }

  /// Plans the next advances, most overloaded springs first (by stretch over limit, then by slot),
  /// with at most one line near each tip. After the cut and `noteOpened`, call it again until it
  /// returns no paths: a fast tip advances several times in a step.
  /// \param dt  time for which springs may have been overloaded [s].
  CutPlan plan(const Model& model, const State& state, double dt);

  /// Notes the result of cutting along the last plan.
  void noteOpened(const SurgeryResult& result);
  /// Notes the result of another operation: tears may advance from the ends of cuts.
  void noteTips(const SurgeryResult& result);

  /// Shifts all stored times by `by` [s], for a simulation whose clock is set.
  void shiftTime(double by);

  /// Updates the data about springs and vertices after an edit of the model.
  void applyChanges(const Model& model, const ModelChanges& changes);

  /// Checks what was read from a file.
  /// \return one sentence about the first error; empty if there is none.
  std::string validationError(const Model& model) const;

 private:
  /// An advance of a tear in the last plan.
  struct Advance {
    double start = 0.0;         ///< time at which the tip leaves [s]
    double length = 0.0;        ///< of the line [m]
    std::int32_t slot = kNone;  ///< of the overloaded spring; kNone by energy
    VertexId tip = kNone;       ///< that advances, if any
    std::vector<Vec2> points;   ///< corners of the line, material coordinates [m]

    template <class Archive>
    void serialize(Archive& archive) {
      archive(start, length, slot, tip, points);
    }
  };
  /// A point through which a tear has run recently.
  struct TornPoint {
    Vec2 at = Vec2::Zero();  ///< material coordinates [m]
    double time = 0.0;       ///< [s]

    template <class Archive>
    void serialize(Archive& archive) {
      archive(at, time);
    }
  };
  struct Overload {
    double excess = 0.0;  ///< stretch over limit
    std::int32_t slot = kNone;
  };
  struct OverloadedSpring;
  struct TipLoad;

  friend class cereal::access;
  /// Archives what commands, steps and edits change; the rest follows from that and from the scene.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(settings_.enabled, settings_.ratio);
    archive(seamSlots_, tips_, recent_, ineffective_, worst_, plannedAt_, advances_);
  }

  bool mayOpenSeam(const Model& model, const Spring& spring) const;
  /// Slot of the k-th spring of the monitor: all that may open the seam, or all without a seam.
  std::int32_t monitoredSlot(std::size_t k) const {
    return settings_.seam ? seamSlots_[k] : static_cast<std::int32_t>(k);
  }
  /// Length over rest length at which a spring fails.
  double ratioOf(const Spring& spring) const {
    return settings_.ratio[static_cast<std::size_t>(spring.kind)];
  }
  double monitoredLength(const Spring& spring) const;
  void updateMonitor(const Model& model, const ModelChanges& changes);
  void fillMonitor(const Model& model);
  void monitorFrom(std::size_t first, const Model& model);
  std::vector<Overload> findOverloads(const Model& model, const State& state);
  bool isInBand(const TriangleMesh& mesh, const Spring& spring) const;
  void planByStretch(const Model& model, const State& state, double dt, CutPlan& plan);
  void planByEnergy(const Model& model, const State& state, double dt, CutPlan& plan);
  void listTipLimits(const Model& model, const State& state,
                     std::vector<LengthLimit>& limits) const;
  std::vector<TipLoad> tipLoads(const Model& model, const State& state) const;
  std::optional<SurfacePath> lineFrom(const TriangleMesh& mesh, const TipLoad& at) const;
  std::optional<SurfacePath> planLine(const Model& model, const State& state,
                                      const OverloadedSpring& at) const;
  std::optional<SurfacePath> seamLine(const TriangleMesh& mesh, const OverloadedSpring& at) const;
  std::optional<SurfacePath> freeLine(const Model& model, const State& state,
                                      const OverloadedSpring& at) const;
  VertexId nearestTip(const TriangleMesh& mesh, const Vec2& p, double within) const;
  bool isUnloaded(const Vec2& p, double edge, double time) const;
  void forgetOld(const TriangleMesh& mesh, double time);

  TearingSettings settings_;
  /// Slots of springs that may open the seam, ascending; none without a seam. Some may have become
  /// empty.
  std::vector<std::int32_t> seamSlots_;
  std::map<VertexId, double> tips_;  ///< tips, and the time from which each may advance [s]
  std::vector<TornPoint> recent_;
  std::set<std::int32_t> ineffective_;  ///< slots of unchanged springs whose lines opened nothing
  SpringLengthMonitor monitor_;         ///< empty: to be filled for the present springs
  double worst_ = 0.0;                  ///< largest strain over failure strain, if one is near 1
  double plannedAt_ = 0.0;              ///< time of the state of the last plan [s]
  std::vector<Advance> advances_;       ///< of the last plan, by path
};

}  // namespace cloth_sim
