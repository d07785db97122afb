#include "command_text.h"

#include <sstream>

#include "archive.h"
#include "cloth_sim/sim/saved_state.h"

namespace cloth_sim {

std::string packCommand(const Command& command) {
  std::ostringstream out(std::ios::binary);
  StateWriter archive(out);
  archive(kStateVersion, command);
  return out.str();
}

Command unpackCommand(const std::string& bytes) {
  try {
    StateReader archive(bytes);
    std::uint32_t version = 0;
    archive(version);
    if (version != kStateVersion) {
      throw StateError("the command is of version " + std::to_string(version) + " (expected " +
                       std::to_string(kStateVersion) + ")");
    }
    Command command;
    archive(command);
    if (archive.left() > 0) throw StateError("the command is damaged");
    return command;
  } catch (const cereal::Exception&) {
    throw StateError("the command is damaged");
  }
}

const char* commandKind(const Command& command) {
  return std::visit([](const auto& it) { return it.kKind; }, command);
}

std::string describeCommand(const Command& command) {
  return std::visit([](const auto& it) { return it.describe(); }, command);
}

}  // namespace cloth_sim
