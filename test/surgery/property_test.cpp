/// \file Random sequences of operations, drawn and shrunk by RapidCheck.
///
/// A failure prints its case in the form of regressions_test.cpp.

#include "surgery/cloth_fixture.h"
#include "surgery/sequences.h"

namespace cloth_sim {
namespace {

using namespace surgery_support;
namespace gen = rc::gen;

constexpr int kMostOperations = 6;

rc::Gen<ClothCase> anyCloth(int most) {
  return gen::resize(kFullSize,
                     gen::build<ClothCase>(
                         gen::set(&ClothCase::columns, gen::inRange(4, most + 1)),
                         gen::set(&ClothCase::rows, gen::inRange(4, most + 1)),
                         gen::set(&ClothCase::aspect, pick<int>({10, 10, 10, 5, 7, 23})),
                         gen::set(&ClothCase::shake, pick<int>({0, 0, 5, 20})),
                         gen::set(&ClothCase::crumple, pick<int>({0, 0, 1, 1, 1, 2})),
                         gen::set(&ClothCase::heldRadius, pick<int>({-1, -1, 0, 1})),
                         gen::set(&ClothCase::shear, pick<bool>({true, true, true, true, false})),
                         gen::set(&ClothCase::bend, pick<bool>({true, true, true, false})),
                         gen::set(&ClothCase::raw, pick<bool>({false, false, false, true})),
                         gen::set(&ClothCase::ownMasses, pick<bool>({false, false, false, true})),
                         gen::set(&ClothCase::seed, gen::inRange(0, 1000))));
}

rc::Gen<Operation> anyOperation(int most) {
  using Point = std::array<int, 2>;
  const int last = 4 * most;
  const auto point = gen::map(gen::pair(gen::inRange(-3, last), gen::inRange(-3, last)),
                              [](const std::pair<int, int>& p) {
                                return Point{p.first, p.second};
                              });
  const auto path = gen::suchThat(
      gen::resize(5, gen::container<std::vector<Point>>(gen::resize(kFullSize, point))),
      [](const std::vector<Point>& points) { return !points.empty(); });
  return gen::build<Operation>(
      gen::set(&Operation::kind,
               pick<Kind>({Kind::kStroke, Kind::kStroke, Kind::kStroke, Kind::kNotch, Kind::kNotch,
                           Kind::kRefine, Kind::kTear, Kind::kRemoveComponent})),
      gen::set(&Operation::path, path),
      gen::set(&Operation::skew, pick<int>({0, 0, 1, 7, 31, -17})),
      gen::set(&Operation::onVertices, pick<bool>({false, false, false, true})),
      gen::set(&Operation::closed, pick<bool>({false, false, true})),
      gen::set(&Operation::option, pick<bool>({false, false, true})),
      gen::set(&Operation::size, gen::inRange(0, 9)),
      gen::set(&Operation::generations, pick<int>({0, 0, 0, 1, 2, 3})),
      gen::set(&Operation::strip, pick<int>({0, 0, 0, 0, 0, 0, 0, 1, 3})));
}

rc::Gen<std::vector<Operation>> anyOperations(int most) {
  return gen::resize(kMostOperations, gen::container<std::vector<Operation>>(
                                          gen::resize(kFullSize, anyOperation(most))));
}

void checkOperations(const std::string& name, int count, int most, bool deep) {
  checkSequences(name, count, [=] {
    const ClothCase cloth = *anyCloth(most).as("cloth");
    const std::vector<Operation> operations = *anyOperations(most).as("operations");
    const std::string error = operateAll(cloth, operations, deep);
    if (!error.empty()) RC_FAIL(error);
  });
}

// 10,000 sequences in all. Three quarters of them check only what is cheap after every operation.
// The last quarter also compares spring networks with ones built from scratch, updates every
// method, and takes steps with it at the end.

TEST(Sequences, OfSmallClothsKeepWhatMustBeKept) { checkOperations("small", 6000, 6, false); }

TEST(Sequences, OfLargerClothsKeepWhatMustBeKept) { checkOperations("larger", 1500, 9, false); }

TEST(Sequences, LeaveNetworksAndMethodsAsIfBuiltFromScratch) {
  checkOperations("deep", 2000, 6, true);
}

TEST(Sequences, OfLargerClothsLeaveNetworksAndMethodsAsIfBuiltFromScratch) {
  checkOperations("deeper", 500, 9, true);
}

}  // namespace
}  // namespace cloth_sim
