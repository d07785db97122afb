#include "cloth_sim/sim/command_basics.h"

#include <sstream>

#include "scene/names.h"

namespace cloth_sim {

CommandResult refuseUnknown(const std::string& kind, const std::string& name,
                            const std::vector<std::string>& known) {
  return refuse(unknownName(kind, name, known));
}

std::string toText(const Vec3& v) {
  std::ostringstream out;
  out << "(" << v.x() << ", " << v.y() << ", " << v.z() << ")";
  return out.str();
}

}  // namespace cloth_sim
