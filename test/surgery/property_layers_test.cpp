/// \file Random sequences of commands to cloths whose layers touch, drawn and shrunk by RapidCheck:
/// no step leaves an intersection, a number that is not finite or a failure.

#include "surgery/layer_sequence.h"
#include "surgery/sequences.h"

namespace cloth_sim {
namespace {

using namespace surgery_support;
namespace gen = rc::gen;

constexpr int kMostCommands = 8;

/// Whole numbers in [-most, most]; they shrink towards 0.
template <std::size_t kCount>
rc::Gen<std::array<int, kCount>> around(int most) {
  const auto number = gen::map(gen::inRange(0, 2 * most + 1),
                               [](int k) { return k % 2 == 0 ? k / 2 : -(k + 1) / 2; });
  return gen::container<std::array<int, kCount>>(number);
}

rc::Gen<LayerCase> anyCase() {
  return gen::resize(kFullSize,
                     gen::build<LayerCase>(gen::set(&LayerCase::particles, gen::inRange(13, 18)),
                                           gen::set(&LayerCase::cloths, pick<int>({1, 2})),
                                           gen::set(&LayerCase::fabric, gen::inRange(0, 3)),
                                           gen::set(&LayerCase::throwAt, around<3>(11)),
                                           gen::set(&LayerCase::throwOther, around<3>(11)),
                                           gen::set(&LayerCase::turn, around<4>(3)),
                                           gen::set(&LayerCase::tears, gen::arbitrary<bool>()),
                                           gen::set(&LayerCase::drops, gen::arbitrary<bool>())));
}

rc::Gen<std::vector<LayerCommand>> anyCommands() {
  const auto command = gen::build<LayerCommand>(
      gen::set(&LayerCommand::act, pick<Act>({Act::kWait, Act::kGrasp, Act::kMove, Act::kMove,
                                              Act::kMove, Act::kRelease, Act::kCut, Act::kCut,
                                              Act::kRefine, Act::kPull, Act::kTear})),
      gen::set(&LayerCommand::cloth, gen::inRange(0, 2)),
      gen::set(&LayerCommand::to, around<3>(30)),
      gen::set(&LayerCommand::from, gen::container<std::array<int, 2>>(gen::inRange(0, 1000))),
      gen::set(&LayerCommand::steps, gen::inRange(1, 6)));
  return gen::resize(kMostCommands,
                     gen::container<std::vector<LayerCommand>>(gen::resize(kFullSize, command)));
}

// Cases that once failed, shrunk where that kept them quick.

TEST(LayerSequences, ATearMovesNoVertexOutOfBentCloth) {
  EXPECT_EQ(
      commandAll({13, 1, 0, {-11, -11, -11}, {0, 0, 0}, {-3, -3, -3, -3}, false, false},
                 {{Act::kGrasp, 0, {0, 0, 0}, {0, 0}, 1}, {Act::kTear, 0, {0, 0, 0}, {397, 1}, 1}}),
      "");
}

TEST(LayerSequences, TheLipsOfATearInCrumpledClothArePartedAlongAllFaces) {
  EXPECT_EQ(commandAll({13, 2, 0, {6, 7, 0}, {10, -5, 7}, {0, -2, 1, 2}, false, false},
                       {{Act::kMove, 1, {14, 23, -9}, {546, 65}, 1},
                        {Act::kGrasp, 1, {23, -19, -3}, {914, 92}, 1},
                        {Act::kTear, 1, {-25, -5, 6}, {642, 734}, 4},
                        {Act::kTear, 1, {22, -29, -14}, {25, 639}, 3},
                        {Act::kCut, 1, {0, -1, -15}, {790, 775}, 3}}),
            "");
}

TEST(LayerSequences, ATearAfterACutOfFlyingClothLeavesNoIntersection) {
  EXPECT_EQ(commandAll({16, 2, 0, {-9, 4, 10}, {2, -9, -2}, {-2, -2, -3, 0}, true, false},
                       {{Act::kCut, 0, {-30, 20, -18}, {301, 966}, 3}}),
            "");
}

// RC_PARAMS="max_success=1000" runs a thousand.
TEST(LayerSequences, LeaveNoIntersection) {
  checkSequences("layers", 40, [] {
    const LayerCase with = *anyCase().as("cloths");
    const std::vector<LayerCommand> commands = *anyCommands().as("commands");
    const std::string error = commandAll(with, commands);
    if (!error.empty()) RC_FAIL(error);
  });
}

}  // namespace
}  // namespace cloth_sim
