/// \file Saving a simulation, and going on from what was saved.

#include <sstream>

#include "archive.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

/// What a state belongs to: it is refused by any other scene.
struct Origin {
  std::string text;             ///< of the scene
  std::uint64_t startHash = 0;  ///< of its cloth before the first step
  std::string method;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(text, startHash, method);
  }
  bool operator==(const Origin& other) const {
    return text == other.text && startHash == other.startHash && method == other.method;
  }
};

/// Contact with a collider in the last step, which phases look at.
struct Touch {
  std::uint64_t collider = 0;
  std::uint64_t cloth = 0;
  std::vector<VertexId> vertices;
  Vec3 impulse = Vec3::Zero();

  template <class Archive>
  void serialize(Archive& archive) {
    archive(collider, cloth, vertices, impulse);
  }
};

}  // namespace

/// Not in the list: what the scene says, what is made anew in every step (`start_`, `report_`),
/// what `load` derives (`pieces_`, `topology_`), and the solver, which is asked itself.
template <class Archive>
void Simulation::serialize(Archive& archive) {
  archive(model_, state_, controls_, pins_, drag_, watch_);
  serializeItems(archive, clamps_, Clamp(ClampSpec()));
  serializeItems(archive, colliders_.all(), Collider(Obstacle(), 0.0));
  serializeContacts(archive);
  archive(grips_, gripEvents_, guides_);
  archive(script_, tearing_, broken_, failures_, dropped_, stepCount_, maxStretchSeen_, failure_);
  archive(sleep_);
  std::uint64_t told = told_;
  archive(told);
  told_ = told;
}

template <class Archive>
void Simulation::serializeContacts(Archive& archive) {
  std::vector<Collider>& colliders = colliders_.all();
  std::vector<Touch> touches;
  for (const ContactCandidates& near : contacts_.candidates) {
    const auto index = static_cast<std::uint64_t>(near.collider - colliders.data());
    touches.push_back({index, near.cloth, near.vertices, near.impulse});
  }
  archive(touches);
  contacts_.clear();
  for (Touch& touch : touches) {
    ContactCandidates& near = contacts_.add(&colliders.at(touch.collider), touch.cloth);
    near.vertices = std::move(touch.vertices);
    near.impulse = touch.impulse;
  }
}

std::string Simulation::save() const {
  std::ostringstream out(std::ios::binary);
  StateWriter archive(out);
  archive(Origin{scene_.text, startHash_, scene_.solver.method});
  const_cast<Simulation*>(this)->serialize(archive);  // which changes nothing when it writes
  solver_->save(archive);
  archive(stateHash(model_, state_));
  return sealState(out.str());
}

void Simulation::load(const std::string& bytes) {
  std::istringstream in(unsealState(bytes), std::ios::binary);
  Simulation loaded(scene_);
  try {
    StateReader archive(in);
    Origin origin;
    archive(origin);
    if (!(origin == Origin{scene_.text, startHash_, scene_.solver.method})) {
      throw StateError("the saved state is of another scene, or of this one with other overrides");
    }
    loaded.serialize(archive);
    loaded.solver_->load(archive, loaded.model_);
    std::uint64_t hash = 0;
    archive(hash);
    if (hash != stateHash(loaded.model_, loaded.state_)) {
      throw StateError("the saved state does not have the hash that it was saved with");
    }
  } catch (const cereal::Exception&) {
    throw StateError("the saved state ends too early");
  }
  loaded.pieces_ = connectedComponents(loaded.model_.mesh);
  *this = std::move(loaded);
}

}  // namespace cloth_sim
