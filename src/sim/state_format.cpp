/// \file The contents of a saved state, in the order in which they are stored.

#include "state_format.h"

#include <algorithm>
#include <sstream>

#include "archive.h"
#include "cloth_sim/sim/saved_state.h"
#include "scene/yaml_tree.h"
#include "state_validation.h"

namespace cloth_sim {
namespace {

/// The simulation that a saved state belongs to; any other one refuses it.
struct Origin {
  std::string text;             ///< of the scene, without what a calibration said
  std::uint64_t startHash = 0;  ///< of the cloth before the first step
  std::string method;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(text, startHash, method);
  }
  bool isOfSameScene(const Origin& other) const {
    return text == other.text && startHash == other.startHash;
  }
};

/// Returns the text of a scene as it is on every machine. The budget that a calibration has led to
/// is part of the method's memory.
std::string textOnAnyMachine(const Scene& scene) {
  if (!scene.solver.realTimeBudget) return scene.text;
  YamlValue tree = parseYaml(scene.text, scene.name);
  applyOverride("solver.budget=real_time", scene.name, tree);
  return emitYaml(tree);
}

Origin originOf(const SimulationParts& parts) {
  return {textOnAnyMachine(parts.scene), parts.startHash, parts.scene.solver.method};
}

/// Contact with a collider in the last step, on which conditions of phases depend.
struct Touch {
  std::uint64_t collider = 0;  ///< index
  std::uint64_t cloth = 0;     ///< index
  std::vector<VertexId> vertices;
  Vec3 impulse = Vec3::Zero();  ///< [N s]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(collider, cloth, vertices, impulse);
  }
};

/// Facts of a scene about its cloths and obstacles, which a saved state cannot change.
struct Undamaged {
  Model model;
  ColliderSet colliders;
};

}  // namespace

/// Writes and reads the members of all components. To keep old files readable, the order stays as
/// it is; a change raises kStateVersion.
class StateFormat {
 public:
  /// Reads or writes the members that a saved state holds. It leaves out what the scene says,
  /// scratch memory of a step, what `loadParts` derives (pieces, topology), and the method, which
  /// writes itself.
  /// \tparam Parts  SimulationParts; const if the archive writes.
  template <class Archive, typename Parts>
  static void serialize(Archive& archive, Parts& parts) {
    auto& holders = parts.holders;
    auto& obstacles = parts.obstacles;
    auto& surgery = parts.surgery;
    archive(parts.model, parts.state, parts.controls);
    archive(holders.pins_, holders.drag_, parts.solver.watch_);
    serializeItems(archive, holders.clamps_, Clamp(ClampSpec()));
    serializeItems(archive, obstacles.colliders_.all(), Collider(Obstacle(), 0.0));
    serializeContacts(archive, obstacles);
    archive(holders.gripWatch_, holders.gripEvents_, obstacles.guides_);
    archive(parts.script, surgery.tearing_, surgery.failures_.counts_, surgery.failures_.events_);
    archive(surgery.dropped_, parts.stepCount, parts.measurements.maxStretchSeen_, parts.failure);
    archive(parts.sleep, surgery.strokeEnd_, surgery.strokeTips_);
    std::uint64_t taken = surgery.failures_.taken_;
    archive(taken);
    if constexpr (Archive::is_loading::value) surgery.failures_.taken_ = taken;
  }

  /// Checks what `serialize` has read, in an order in which no check follows a wrong index.
  /// \param parts      what was read.
  /// \throws StateError
  static void check(const SimulationParts& parts, const Undamaged& undamaged) {
    const Model& model = parts.model;
    const Surgery& surgery = parts.surgery;
    refuseIf(validationError(model, undamaged.model));
    refuseIf(validationError(parts.state, model));
    refuseIf(validationError(parts.controls, model));
    refuseIf(validationError(parts.holders.drag_, parts.holders.pins_, model));
    refuseIf(validationError(parts.holders.clamps_, model));
    refuseIf(validationError(parts.holders.gripEvents_));
    refuseIf(validationError(parts.obstacles.colliders_, undamaged.colliders));
    refuseIf(touchError(parts.obstacles.contacts_, model));
    refuseIf(parts.script.validationError());
    refuseIf(surgery.tearing_.validationError(model));
    refuseIf(historyError(surgery.failures_));
    refuseIf(isOneLine(parts.failure) ? "" : "the reason of its failure is no sentence");
  }

  /// Gives the colliders the shapes of the scene, which `check` has found to be the same.
  static void adoptShapes(const ColliderSet& ofScene, SimulationParts& parts) {
    std::vector<Collider>& colliders = parts.obstacles.colliders_.all();
    for (std::size_t k = 0; k < colliders.size(); ++k) colliders[k].shareShape(ofScene.all()[k]);
  }

  static const Solver& solverOf(const SimulationParts& parts) { return *parts.solver.solver_; }
  static Solver& solverOf(SimulationParts& parts) { return *parts.solver.solver_; }
  static void derive(SimulationParts& parts) {
    parts.surgery.pieces_ = connectedComponents(parts.model.mesh);
    if (parts.layers) parts.layers->onModelChanged(parts.model);
  }

 private:
  static void refuseIf(const std::string& error) {
    if (!error.empty()) throw StateError("the saved state contradicts itself: " + error);
  }

  static std::string touchError(const Contacts& contacts, const Model& model) {
    for (const ContactCandidates& near : contacts.candidates) {
      const auto isOutside = [&](VertexId v) { return v < 0 || v >= model.particleCount(); };
      const std::vector<VertexId>& vertices = near.vertices;
      if (near.cloth >= model.cloths.size()) return "a cloth touches that does not exist";
      if (std::any_of(vertices.begin(), vertices.end(), isOutside) ||
          !std::is_sorted(vertices.begin(), vertices.end())) {
        return "a particle touches that does not exist";
      }
    }
    return "";
  }

  static std::string historyError(const FailureHistory& failures) {
    if (failures.taken_ > failures.events_.size()) return "more springs were told of than failed";
    for (const FailureEvent& event : failures.events_) {
      if (static_cast<int>(event.kind) >= kSpringKinds || event.cause > FailureCause::kCut) {
        return "a spring has failed that is of no kind";
      }
    }
    const BrokenCounts& counts = failures.counts_;
    const bool areCounts = counts.total >= 0 && counts.torn >= 0 && counts.cut >= 0 &&
                           *std::min_element(counts.byKind.begin(), counts.byKind.end()) >= 0;
    return areCounts ? "" : "fewer than no springs have failed";
  }

  template <class Archive, typename SomeObstacles>
  static void serializeContacts(Archive& archive, SomeObstacles& obstacles) {
    std::vector<Touch> touches;
    for (const ContactCandidates& near : obstacles.contacts_.candidates) {
      const auto index = near.collider - obstacles.colliders_.all().data();
      touches.push_back(
          {static_cast<std::uint64_t>(index), near.cloth, near.vertices, near.impulse.linear});
    }
    archive(touches);
    if constexpr (Archive::is_loading::value) setTouches(touches, obstacles);
  }

  static void setTouches(std::vector<Touch>& touches, Obstacles& obstacles) {
    obstacles.contacts_.clear();
    std::vector<Collider>& colliders = obstacles.colliders_.all();
    for (Touch& touch : touches) {
      if (touch.collider >= colliders.size()) {
        throw StateError(
            "the saved state contradicts itself: an obstacle is touched that does "
            "not exist");
      }
      ContactCandidates& near = obstacles.contacts_.add(&colliders[touch.collider], touch.cloth);
      near.vertices = std::move(touch.vertices);
      near.impulse.linear = touch.impulse;
    }
  }
};

std::string saveParts(const SimulationParts& parts) {
  std::ostringstream out(std::ios::binary);
  StateWriter archive(out);
  archive(originOf(parts));
  StateFormat::serialize(archive, parts);
  StateFormat::solverOf(parts).save(archive);
  archive(stateHash(parts.model, parts.state));
  return sealState(out.str());
}

namespace {

/// Reads the contents of a saved state in the order in which saveParts writes them.
class StateContents {
 public:
  /// \throws StateError unless `payload` is that of a saved state of the scene of `like`.
  StateContents(std::string payload, const SimulationParts& like) : archive_(std::move(payload)) {
    Origin origin;
    archive_(origin);
    const Origin own = originOf(like);
    if (!origin.isOfSameScene(own)) refuse();
    sameMethod_ = origin.method == own.method;
  }

  void readAllButMethod(const Undamaged& undamaged, SimulationParts& parts) {
    StateFormat::serialize(archive_, parts);
    StateFormat::check(parts, undamaged);
    StateFormat::adoptShapes(undamaged.colliders, parts);
  }

  void readMethod(StateHash stateHash, SimulationParts& parts) {
    if (!sameMethod_) refuse();
    StateFormat::solverOf(parts).load(archive_, parts.model);
    std::uint64_t hash = 0;
    archive_(hash);
    if (stateHash == StateHash::kIgnored) return;
    if (hash != cloth_sim::stateHash(parts.model, parts.state)) {
      throw StateError("the saved state does not have the hash that it was saved with");
    }
  }

  void expectEnd() const {
    if (archive_.left() > 0) throw StateError("the saved state goes on after its end");
  }

 private:
  [[noreturn]] static void refuse() {
    throw StateError("the saved state is of another scene, or of this one with other overrides");
  }

  StateReader archive_;
  bool sameMethod_ = false;
};

/// Reads a saved state with `read(contents, undamaged, parts)`. Nothing of it is used before it has
/// been checked, and `like` stays as it is.
template <typename Read>
SimulationParts readParts(const std::string& payload, const SimulationParts& like,
                          const Read& read) {
  SimulationParts loaded(like.scene);
  const Undamaged undamaged{loaded.model, loaded.obstacles.colliders()};
  try {
    StateContents contents(payload, like);
    read(contents, undamaged, loaded);
  } catch (const StateError&) {
    throw;
  } catch (const cereal::Exception& error) {
    throw StateError(std::string("the saved state cannot be read: ") + error.what());
  } catch (const std::exception& error) {  // of a list that is too long, for example
    throw StateError(std::string("the saved state contradicts itself: ") + error.what());
  }
  StateFormat::derive(loaded);
  return loaded;
}

}  // namespace

SimulationParts loadPayload(const std::string& payload, const SimulationParts& like,
                            StateHash stateHash) {
  return readParts(payload, like, [stateHash](auto& contents, const auto& undamaged, auto& loaded) {
    contents.readAllButMethod(undamaged, loaded);
    contents.readMethod(stateHash, loaded);
    contents.expectEnd();
  });
}

SimulationParts loadParts(const std::string& bytes, const SimulationParts& like) {
  return loadPayload(unsealState(bytes), like, StateHash::kChecked);
}

SimulationParts adoptParts(const std::string& bytes, const SimulationParts& like) {
  return readParts(unsealState(bytes), like,
                   [](auto& contents, const auto& undamaged, auto& loaded) {
                     contents.readAllButMethod(undamaged, loaded);
                     loaded.solver = GuardedSolver(loaded.scene.solver, loaded.model, loaded.state);
                   });
}

}  // namespace cloth_sim
