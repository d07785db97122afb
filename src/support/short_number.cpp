#include "short_number.h"

#include <locale>
#include <sstream>

namespace cloth_sim {

std::string shortNumber(double value, int digits) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

}  // namespace cloth_sim
