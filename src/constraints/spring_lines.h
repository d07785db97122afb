#pragma once
/// \file Springs in lines: chains of springs along the threads and across the cells of a cloth.

#include <array>

#include "cloth_sim/cloth/model.h"
#include "support/simd.h"

namespace cloth_sim {

/// All springs of a model as lines, eight lines to a SIMD block, for LineProjection.
///
/// A line is a chain of springs of one kind that continue each other nearly straight in the
/// material plane: along a thread (structural springs), across the cells (shear springs), or over
/// every second particle of a thread (bend springs). Lines are coloured greedily, kind by kind, so
/// that no two lines of a colour share a particle; on a grid that gives two colours for each kind.
/// Kinds are ordered bend, shear, structural: whatever is projected last ends a substep without an
/// error, and structural springs are the stiffest.
///
/// Lines follow from the springs of the model alone, whatever edits made them.
class SpringLines {
 public:
  static constexpr std::int32_t kWidth = kFloatLanes;  ///< lines in a SIMD block

  /// Lines that are solved at once. Line k has its spring number s at `springs()[firstStep + s]`,
  /// lane k, between the particles `slots()[firstPlace + s]` and `slots()[firstPlace + s + 1]`,
  /// lane k. A line that is shorter than `steps` repeats its last particle, with springs that pull
  /// nothing; a lane without a line does so with the particles of the lane before, which is to be
  /// written last.
  struct SimdBlock {
    std::int32_t steps = 0;       ///< springs of the longest line
    std::int32_t firstStep = 0;   ///< index in `springs`
    std::int32_t firstPlace = 0;  ///< index in `slots`
  };
  /// Consecutive blocks that share no particle.
  struct Colour {
    std::int32_t firstBlock = 0;
    std::int32_t endBlock = 0;
    SpringKind kind = SpringKind::kStructural;
  };
  using Slots = std::array<std::int32_t, kWidth>;

  /// \param slotOf  particle slot by vertex.
  void build(const Model& model, const std::vector<std::int32_t>& slotOf);

  const std::vector<Colour>& colours() const { return colours_; }  ///< in the order of a sweep
  const std::vector<SimdBlock>& blocks() const { return blocks_; }
  const std::vector<Slots>& slots() const { return slots_; }
  /// Slots of the network, shape (steps of all blocks, kWidth); kNone where a line has ended.
  const std::vector<Slots>& springs() const { return springs_; }
  std::int32_t longest() const { return longest_; }  ///< most steps of a block

 private:
  /// A line while it is built: indices into `lineSprings_`; its particles follow from these.
  struct Line {
    std::int32_t first = 0;
    std::int32_t count = 0;
    VertexId start = kNone;
  };

  void listSprings(const SpringNetwork& springs);
  /// \param ofKind  slots of the network of all springs of a kind, ascending.
  void findLines(const TriangleMesh& mesh, const std::vector<std::int32_t>& ofKind);
  void appendColours(SpringKind kind, const std::vector<std::int32_t>& slotOf);
  std::vector<std::vector<Line>> coloured(std::size_t vertices) const;
  void appendColour(SpringKind kind, const std::vector<std::int32_t>& slotOf,
                    std::vector<Line>& lines);
  void appendBlock(const std::vector<std::int32_t>& slotOf, const Line* lines, std::size_t count);
  /// Calls `visit(v)` for every particle of a line, from its start on.
  template <typename Visit>
  void forParticles(const Line& line, const Visit& visit) const;
  VertexId otherEnd(std::int32_t spring, VertexId v) const;

  std::vector<Colour> colours_;
  std::vector<SimdBlock> blocks_;
  std::vector<Slots> slots_;
  std::vector<Slots> springs_;
  std::int32_t longest_ = 0;
  std::vector<std::array<VertexId, 2>> ends_;  ///< a and b of springs, by slot of the network
  std::array<std::vector<std::int32_t>, kSpringKinds> ofKind_;  ///< slots of the network by kind
  std::vector<Line> lines_;                                     ///< of the kind that is being built
  std::vector<std::int32_t> lineSprings_;  ///< slots of the network, line after line
};

}  // namespace cloth_sim
