#include "command_text.h"

#include <sstream>

#include "archive.h"
#include "cloth_sim/sim/saved_state.h"

namespace cloth_sim {
namespace {

struct Words {
  const char* kind = "";
  std::string text;
};

std::string words(const Vec3& v) {
  std::ostringstream out;
  out << "(" << v.x() << ", " << v.y() << ", " << v.z() << ")";
  return out.str();
}

Words wordsOf(const SetClampTarget& command) {
  return {"set_clamp_target", command.clamp + " to " + words(command.pose.position)};
}
Words wordsOf(const GuideClamp& command) {
  return {"guide_clamp", command.clamp + " to " + words(command.target.pose.position)};
}
Words wordsOf(const SetGripForce& command) {
  return {"set_grip_force",
          command.clamp + (command.force ? " " + std::to_string(*command.force) + " N" : " any")};
}
Words wordsOf(const SetGapWidth& command) {
  return {"set_gap_width", command.clamp + " " + std::to_string(command.width) + " m"};
}
Words wordsOf(const CreateClamp& command) { return {"create_clamp", command.spec.name}; }
Words wordsOf(const DeleteClamp& command) { return {"delete_clamp", command.clamp}; }
Words wordsOf(const GuideObstacle& command) {
  return {"guide_obstacle", command.obstacle + " to " + words(command.target.pose.position)};
}
Words wordsOf(const SetGrasp& command) {
  return {"set_grasp", command.clamp + (command.grasp ? " closes" : " lets go")};
}
Words wordsOf(const SetPhase& command) { return {"set_phase", command.phase}; }
Words wordsOf(const SetGravity& command) { return {"set_gravity", words(command.gravity)}; }
Words wordsOf(const MoveObstacle& command) {
  return {"move_obstacle", command.obstacle + " to " + words(command.pose.position)};
}
Words wordsOf(const SetTearing& command) {
  return {"set_tearing", command.enabled ? "enabled" : "disabled"};
}
Words wordsOf(const SetWind& command) {
  return {"set_wind", command.wind ? words(command.wind->velocity) : "none"};
}
Words wordsOf(const SetStiffness& command) {
  return {"set_stiffness", "times " + std::to_string(command.scale)};
}
Words wordsOf(const PullParticle& command) {
  return {"pull_particle", command.held ? "along " + words(command.ray.direction) : "let go"};
}
Words wordsOf(const CutAlong& command) {
  return {"cut_along", std::to_string(command.stroke.poses.size()) + " poses"};
}
Words wordsOf(const RefineNear& command) {
  return {"refine_near", std::to_string(command.path.size()) + " points"};
}
Words wordsOf(const Reset& command) {
  switch (command.scope) {
    case ResetScope::kBoth:
      return {"reset", "state and time"};
    case ResetScope::kState:
      return {"reset", "state"};
    case ResetScope::kTime:
      return {"reset", "time"};
  }
  return {"reset", ""};
}
Words wordsOf(const Restore& command) {
  return {"restore", std::to_string(command.bytes.size()) + " bytes"};
}

Words wordsOf(const Command& command) {
  return std::visit([](const auto& it) { return wordsOf(it); }, command);
}

}  // namespace

std::string packCommand(const Command& command) {
  std::ostringstream out(std::ios::binary);
  StateWriter archive(out);
  archive(kStateVersion, command);
  return out.str();
}

Command unpackCommand(const std::string& bytes) {
  std::istringstream in(bytes, std::ios::binary);
  try {
    StateReader archive(in);
    std::uint32_t version = 0;
    archive(version);
    if (version != kStateVersion) {
      throw StateError("the command is of version " + std::to_string(version) + " (expected " +
                       std::to_string(kStateVersion) + ")");
    }
    Command command;
    archive(command);
    return command;
  } catch (const cereal::Exception&) {
    throw StateError("the command is damaged");
  }
}

const char* commandKind(const Command& command) { return wordsOf(command).kind; }

std::string describeCommand(const Command& command) { return wordsOf(command).text; }

}  // namespace cloth_sim
