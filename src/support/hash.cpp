#include "hash.h"

#include <cinttypes>
#include <cstdio>

namespace cloth_sim {

std::string hashText(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, hash);
  return text;
}

}  // namespace cloth_sim
