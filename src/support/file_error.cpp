#include "file_error.h"

namespace cloth_sim {

void checkFileName(const std::string& path, const std::string& expected) {
  if (path.empty()) throw FileError("expected " + expected + " (got nothing)");
  if (path.find('\0') != std::string::npos) throw FileError(path + ": has a zero byte in it");
}

}  // namespace cloth_sim
