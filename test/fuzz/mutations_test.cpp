/// \file Good inputs with small changes are refused in one line, or run and stay finite. The
/// changes come from fixed seeds; libFuzzer finds others (scripts/fuzz.sh).

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "fewer_cases.h"
#include "fuzz/fuzz_targets.h"
#include "support/input_file.h"

namespace cloth_sim::fuzz {
namespace {

namespace fs = std::filesystem;

/// Number of mutations of each target here. CLOTH_SIM_FUZZ_RUNS multiplies it; see also
/// fewer_cases.h.
constexpr int kRuns = 600;
constexpr int kStateRuns = 2000;

/// Changes bytes in the ways in which damaged and forged files differ from good ones.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string change(std::string bytes) {
    for (int k = below(3); k >= 0 && !bytes.empty(); --k) changeOnce(bytes);
    return bytes;
  }

 private:
  int below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }
  std::size_t place(const std::string& bytes, std::size_t size) {
    return bytes.size() <= size ? 0 : random_() % (bytes.size() - size + 1);
  }
  template <typename T>
  void put(const T& value, std::string& bytes) {
    if (bytes.size() < sizeof value) return;
    std::memcpy(&bytes[place(bytes, sizeof value)], &value, sizeof value);
  }
  void changeOnce(std::string& bytes) {
    using Real = std::numeric_limits<double>;
    static const std::int32_t numbers[] = {-1,
                                           0,
                                           1,
                                           2,
                                           3,
                                           7,
                                           99,
                                           100,
                                           255,
                                           1000,
                                           1 << 20,
                                           1 << 30,
                                           std::numeric_limits<std::int32_t>::max(),
                                           std::numeric_limits<std::int32_t>::min()};
    static const double reals[] = {0.0,
                                   -0.0,
                                   1.0,
                                   -1.0,
                                   1e-300,
                                   1e300,
                                   -1e300,
                                   1e9,
                                   1e-9,
                                   Real::infinity(),
                                   Real::quiet_NaN(),
                                   Real::denorm_min()};
    switch (below(8)) {
      case 0:
        bytes[place(bytes, 1)] ^= static_cast<char>(1 << below(8));
        break;
      case 1:
        bytes[place(bytes, 1)] = static_cast<char>(below(256));
        break;
      case 2:
        put(numbers[below(std::size(numbers))], bytes);
        break;
      case 3:
        put(std::int64_t{numbers[below(std::size(numbers))]}, bytes);
        break;
      case 4:
        put(reals[below(std::size(reals))], bytes);
        break;
      case 5:
        put(below(200), bytes);
        break;
      case 6:
        swapWords(bytes);
        break;
      case 7:
        moveBytes(bytes);
        break;
    }
  }
  void swapWords(std::string& bytes) {
    if (bytes.size() < 8) return;
    const std::size_t a = place(bytes, 4);
    const std::size_t b = place(bytes, 4);
    for (std::size_t k = 0; k < 4; ++k) std::swap(bytes[a + k], bytes[b + k]);
  }
  void moveBytes(std::string& bytes) {
    const std::size_t from = place(bytes, 1);
    const std::size_t size = random_() % 40;
    const std::string part = bytes.substr(from, size);
    if (below(2) == 0) bytes.erase(from, size);
    if (below(2) == 0) bytes.insert(place(bytes, 1), part);
  }

  std::mt19937 random_;
};

int runsOf(const Target& target) {
  const char* factor = std::getenv("CLOTH_SIM_FUZZ_RUNS");
  const int runs = fewerCases(std::string(target.name) == "state" ? kStateRuns : kRuns);
  return runs * (factor != nullptr ? std::max(1, std::atoi(factor)) : 1);
}

class Fuzz : public testing::TestWithParam<std::string> {
 protected:
  const Target& target() const { return findTarget(GetParam()); }
  void SetUp() override {
    file_ =
        fs::temp_directory_path() / ("cloth_sim_fuzz_" + GetParam() + std::to_string(::getpid()));
  }
  void TearDown() override {
    if (!HasFailure()) fs::remove(file_);
  }
  /// Feeds the target. The bytes are in a file meanwhile, in case they end the process.
  bool feed(const std::string& bytes) {
    std::ofstream(file_, std::ios::binary) << bytes;
    try {
      return target().feed(bytes);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << " (" << file_ << ")";
      return false;
    }
  }

  fs::path file_;
};

std::vector<std::string> targetNames() {
  std::vector<std::string> names;
  for (const Target& target : targets()) names.push_back(target.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, testing::ValuesIn(targetNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Fuzz, TakesGoodInputs) {
  for (const std::string& seed : target().seeds()) EXPECT_TRUE(feed(seed));
}

TEST_P(Fuzz, RefusesOrSurvivesChangedInputs) {
  const std::vector<std::string> seeds = target().seeds();
  Mutator mutator(7);
  int accepted = 0;
  const int runs = runsOf(target());
  for (int k = 0; k < runs && !HasFailure(); ++k) {
    const std::string& seed = seeds[static_cast<std::size_t>(k) % seeds.size()];
    if (feed(mutator.change(seed))) ++accepted;
  }
  RecordProperty("accepted", accepted);
  RecordProperty("runs", runs);
  EXPECT_GT(accepted, 0) << "nothing came past the first check";
  EXPECT_LT(accepted, runs);
}

/// Inputs that were found to do harm once: test/fuzz/corpus/<target>/.
TEST_P(Fuzz, SurvivesWhatWasFoundBefore) {
  const fs::path folder = fs::path(CLOTH_SIM_SOURCE_DIR "/test/fuzz/corpus") / GetParam();
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    feed(readInputFile(entry.path().string(), {}));
  }
}

}  // namespace
}  // namespace cloth_sim::fuzz
