#include "one_line.h"

#include <algorithm>
#include <cctype>

namespace cloth_sim {

std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text;
}

}  // namespace cloth_sim
