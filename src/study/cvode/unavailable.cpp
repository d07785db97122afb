#include <stdexcept>

#include "study/exact.h"

namespace cloth_sim {

bool canIntegrateExactly() { return false; }

Reference integrateExactly(const StudyScene& /*study*/) {
  throw std::runtime_error(
      "built without SUNDIALS CVODE (Debian: libsundials-dev), which references of smooth scenes "
      "are made with");
}

}  // namespace cloth_sim
