/// \file A target of libFuzzer; CLOTH_SIM_FUZZ_TARGET is its name. With the environment variable
/// CLOTH_SIM_FUZZ_SEEDS=DIR it writes the good inputs to that folder and ends.

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "fuzz/fuzz_targets.h"

using cloth_sim::fuzz::findTarget;

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  // In any case, so that what a target prepares does not count for the time of the first input.
  const std::vector<std::string> seeds = findTarget(CLOTH_SIM_FUZZ_TARGET).seeds();
  const char* folder = std::getenv("CLOTH_SIM_FUZZ_SEEDS");
  if (folder == nullptr) return 0;
  int number = 0;
  for (const std::string& seed : seeds) {
    std::ofstream(std::string(folder) + "/seed" + std::to_string(number++), std::ios::binary)
        << seed;
  }
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  findTarget(CLOTH_SIM_FUZZ_TARGET).feed({reinterpret_cast<const char*>(data), size});
  return 0;
}
