/// \file The contents of a saved state, in the order in which they are stored.

#include <sstream>

#include "archive.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation_parts.h"
#include "scene/yaml_tree.h"

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
    archive(parts.sleep);
    std::uint64_t taken = surgery.failures_.taken_;
    archive(taken);
    if constexpr (Archive::is_loading::value) surgery.failures_.taken_ = taken;
  }

  static const Solver& solverOf(const SimulationParts& parts) { return *parts.solver.solver_; }
  static Solver& solverOf(SimulationParts& parts) { return *parts.solver.solver_; }
  static void derive(SimulationParts& parts) {
    parts.surgery.pieces_ = connectedComponents(parts.model.mesh);
    if (parts.layers) parts.layers->onModelChanged(parts.model);
  }

 private:
  template <class Archive, typename SomeObstacles>
  static void serializeContacts(Archive& archive, SomeObstacles& obstacles) {
    std::vector<Touch> touches;
    for (const ContactCandidates& near : obstacles.contacts_.candidates) {
      const auto index = near.collider - obstacles.colliders_.all().data();
      touches.push_back(
          {static_cast<std::uint64_t>(index), near.cloth, near.vertices, near.impulse});
    }
    archive(touches);
    if constexpr (Archive::is_loading::value) setTouches(touches, obstacles);
  }

  static void setTouches(std::vector<Touch>& touches, Obstacles& obstacles) {
    obstacles.contacts_.clear();
    for (Touch& touch : touches) {
      Collider& collider = obstacles.colliders_.all().at(touch.collider);
      ContactCandidates& near = obstacles.contacts_.add(&collider, touch.cloth);
      near.vertices = std::move(touch.vertices);
      near.impulse = touch.impulse;
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
  /// \throws StateError unless `bytes` are a saved state of the scene of `like`.
  StateContents(const std::string& bytes, const SimulationParts& like)
      : in_(unsealState(bytes), std::ios::binary), archive_(in_) {
    Origin origin;
    archive_(origin);
    const Origin own = originOf(like);
    if (!origin.isOfSameScene(own)) refuse();
    sameMethod_ = origin.method == own.method;
  }

  void readAllButMethod(SimulationParts& parts) { StateFormat::serialize(archive_, parts); }

  void readMethod(SimulationParts& parts) {
    if (!sameMethod_) refuse();
    StateFormat::solverOf(parts).load(archive_, parts.model);
    std::uint64_t hash = 0;
    archive_(hash);
    if (hash != stateHash(parts.model, parts.state)) {
      throw StateError("the saved state does not have the hash that it was saved with");
    }
  }

 private:
  [[noreturn]] static void refuse() {
    throw StateError("the saved state is of another scene, or of this one with other overrides");
  }

  std::istringstream in_;
  StateReader archive_;
  bool sameMethod_ = false;
};

/// Reads a saved state with `read(contents, parts)`.
template <typename Read>
SimulationParts readParts(const std::string& bytes, const SimulationParts& like, const Read& read) {
  SimulationParts loaded(like.scene);
  try {
    StateContents contents(bytes, like);
    read(contents, loaded);
  } catch (const cereal::Exception&) {
    throw StateError("the saved state ends too early");
  }
  StateFormat::derive(loaded);
  return loaded;
}

}  // namespace

SimulationParts loadParts(const std::string& bytes, const SimulationParts& like) {
  return readParts(bytes, like, [](StateContents& contents, SimulationParts& loaded) {
    contents.readAllButMethod(loaded);
    contents.readMethod(loaded);
  });
}

SimulationParts adoptParts(const std::string& bytes, const SimulationParts& like) {
  return readParts(bytes, like, [](StateContents& contents, SimulationParts& loaded) {
    contents.readAllButMethod(loaded);
    loaded.solver = GuardedSolver(loaded.scene.solver, loaded.model, loaded.state);
  });
}

}  // namespace cloth_sim
