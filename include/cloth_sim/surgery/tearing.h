#pragma once
/// \file Tearing: which springs fail, and along which lines the surface opens for them. Plans only;
/// see surgery/operation.h for the edit.

#include <limits>
#include <map>
#include <optional>
#include <set>

#include "cloth_sim/surgery/material_path.h"
#include "cloth_sim/surgery/operation.h"
#include "cloth_sim/surgery/spring_length_monitor.h"

namespace cloth_sim {

/// Where the cloth may tear: only at springs that cross `path` or end on it, or whose middle is
/// within `halfWidth` of it.
struct Seam {
  MaterialPath path;       ///< at least two points
  double halfWidth = 0.0;  ///< [m], >= 0
};

/// Length over rest length at which a spring of each kind fails; infinity: never.
using TearRatios = std::array<double, kSpringKinds>;

/// Returns ratios at which no spring fails.
inline TearRatios infiniteRatios() {
  TearRatios ratios;
  ratios.fill(std::numeric_limits<double>::infinity());
  return ratios;
}

struct TearingSettings {
  bool enabled = false;
  TearRatios ratio = infiniteRatios();
  std::optional<Seam> seam;  ///< absent: the cloth may tear everywhere
  double tipSpeed = 5.0;  ///< fastest that the tip of a tear runs through the material [m/s], > 0
  std::optional<Refinement> refineTip;  ///< around where it tears next
};

/// Finds the springs that fail, and the line along which the surface opens for each.
///
/// A spring that crosses the seam opens the seam across the faces that it stands on. Any other one
/// makes the nearest tip within three edges run on, or, if there is none, a new tear begins: at the
/// border, or in the middle of the spring; but not near a tear that runs, which will unload it. A
/// tear runs at right angles to the direction of largest tension around its tip, whatever way the
/// mesh runs, across the faces around the tip.
///
/// A tip runs at `tipSpeed` at most, and keeps account of what is left over of a step. How far it
/// gets depends on the step where the stress is older than the time that it needs for an edge: end
/// steps where one of the limits is passed.
class Tearing {
 public:
  Tearing(TearingSettings settings, const Model& model);

  const TearingSettings& settings() const { return settings_; }
  void setEnabled(bool enabled) { settings_.enabled = enabled; }
  void setRatio(const TearRatios& ratio);

  /// The lengths at which those springs fail that are near it now: from half of the strain that
  /// tears on. Once one is passed, `plan` should be asked.
  void listLimits(const Model& model, const State& state, std::vector<LengthLimit>& limits);

  /// Whether a spring is beyond its limit, as the last plan saw it, and has yet to fail: it waits
  /// for a tip, or for a tear that runs beside it.
  bool isOverloaded() const { return settings_.enabled && worst_ > 1.0; }

  /// What tears now, most overloaded first (by stretch over limit; ties by slot); at most one line
  /// through each face. Visits only springs that the gate allows. To be asked again after the cut
  /// and `noteOpened`, until it has no paths: a fast tip takes several strides in a step.
  /// \param dt  how long it may have been overloaded [s].
  CutPlan plan(const Model& model, const State& state, double dt);

  /// Tells that the last plan was carried out.
  void noteOpened(const SurgeryResult& result);
  /// Tells of another operation: tears may go on where cuts end.
  void noteTips(const SurgeryResult& result);

  /// Whatever has happened so far happened `by` later [s].
  void shiftTime(double by);

  /// To be called after every edit of the model.
  void applyChanges(const Model& model, const ModelChanges& changes);

 private:
  /// A line that the last plan had.
  struct Stride {
    double start = 0.0;   ///< [s]
    double length = 0.0;  ///< [m]
    std::int32_t slot = kNone;
    std::vector<Vec2> places;  ///< corners of the line, material coordinates [m]

    template <class Archive>
    void serialize(Archive& archive) {
      archive(start, length, slot, places);
    }
  };
  /// Where a tear has run.
  struct Run {
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

  friend class cereal::access;
  /// What commands, steps and edits change; the rest is as the scene has it, or derived from that.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(settings_.enabled, settings_.ratio);
    archive(onSeam_, tips_, runs_, idle_, worst_, plannedAt_, strides_);
  }

  bool mayOpenSeam(const Model& model, const Spring& spring) const;
  /// Slot of the k-th spring that may fail; without a seam all may.
  std::int32_t candidate(std::size_t k) const {
    return settings_.seam ? onSeam_[k] : static_cast<std::int32_t>(k);
  }
  /// Length over rest length at which it fails.
  double ratioOf(const Spring& spring) const {
    return settings_.ratio[static_cast<std::size_t>(spring.kind)];
  }
  double nearLength(const Spring& spring) const;
  void applyChangesNear(const Model& model, const ModelChanges& changes);
  void watch(const Model& model);
  void watchFrom(std::size_t first, const Model& model);
  std::vector<Overload> findOverloads(const Model& model, const State& state);
  bool isInBand(const TriangleMesh& mesh, const Spring& spring) const;
  /// \param faces  that the spring stands on; of `lineFor` too.
  std::optional<SurfacePath> seamLine(const TriangleMesh& mesh, const Spring& spring,
                                      const std::vector<FaceId>& faces) const;
  std::optional<SurfacePath> lineFor(const Model& model, const State& state, const Spring& spring,
                                     const std::vector<FaceId>& faces, VertexId tip) const;
  VertexId nearestTip(const TriangleMesh& mesh, const Vec2& p, double within) const;
  bool isShaded(const Vec2& p, double edge, double time) const;
  void forget(const TriangleMesh& mesh, double time);

  TearingSettings settings_;
  /// With a seam, slots that may open it, ascending; some may be gone.
  std::vector<std::int32_t> onSeam_;
  std::map<VertexId, double> tips_;  ///< when each may go on [s]
  std::vector<Run> runs_;
  std::set<std::int32_t> idle_;  ///< slots whose lines opened nothing, since they last changed
  SpringLengthMonitor near_;     ///< by candidate; empty: not known for springs as they are now
  double worst_ = 0.0;           ///< largest strain over the strain that tears, if it is near 1
  double plannedAt_ = 0.0;       ///< time of the state of the last plan [s]
  std::vector<Stride> strides_;  ///< of the last plan, by path
};

}  // namespace cloth_sim
