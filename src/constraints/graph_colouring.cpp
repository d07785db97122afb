#include "graph_colouring.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// Absorbs rounding in material coordinates when they are divided by a spacing.
constexpr double kGridTolerance = 1e-6;

/// On a grid two colours suffice for parallel springs of one kind. Colours that are to be joined
/// into a group are numbered one after the other: first those within rows, then those between rows
/// 2k and 2k + 1, then those between rows 2k + 1 and 2k + 2, then those over two rows.
int colourOf(const Model& model, const Spring& spring, int parity) {
  const bool bend = traitsOf(spring.kind).bridgesAVertex;
  const Vec2 d = model.mesh.material(spring.b) - model.mesh.material(spring.a);
  switch (spring.direction) {
    case ThreadDirection::kWarp:
      return (bend ? 2 : 0) + parity;
    case ThreadDirection::kWeft:
      return bend ? 10 + parity : 4 + 3 * parity;
    case ThreadDirection::kBias:
      return (d.x() * d.y() > 0.0 ? 5 : 6) + 3 * parity;
  }
  return 0;
}

/// The colour that a spring would have on a grid, from its place in material coordinates.
int gridColour(const Model& model, const Spring& spring) {
  const Vec2& p = model.mesh.material(spring.a);
  const Vec2& q = model.mesh.material(spring.b);
  const int axis = spring.direction == ThreadDirection::kWarp ? 0 : 1;
  const double origin = axis == 0 ? model.cloths[model.clothOf(spring.a)].materialOffset : 0.0;
  const double low = std::min(p[axis], q[axis]) - origin;
  const double extent = std::abs(q[axis] - p[axis]);
  const auto cell = static_cast<long>(std::floor(low / extent + kGridTolerance));
  return colourOf(model, spring, static_cast<int>(cell & 1));
}

/// Greedy colouring that prefers a given colour where it is free.
class Colouring {
 public:
  explicit Colouring(std::int32_t particles) : used_(static_cast<std::size_t>(particles), 0) {}

  int pick(const Spring& spring, int preferred) {
    if (take(spring, preferred)) return preferred;
    for (int colour = 0;; ++colour) {
      if (colour == kBits * static_cast<int>(words_)) widen();
      if (take(spring, colour)) return colour;
    }
  }

 private:
  using Word = std::uint64_t;
  static constexpr int kBits = 64;

  bool take(const Spring& spring, int colour) {
    Word& a = used_[words_ * static_cast<std::size_t>(spring.a) + colour / kBits];
    Word& b = used_[words_ * static_cast<std::size_t>(spring.b) + colour / kBits];
    const Word bit = Word{1} << colour % kBits;
    if (((a | b) & bit) != 0) return false;
    a |= bit;
    b |= bit;
    return true;
  }
  void widen() {
    std::vector<Word> wider(2 * used_.size(), 0);
    for (std::size_t k = 0; k < used_.size(); ++k) {
      wider[k / words_ * 2 * words_ + k % words_] = used_[k];
    }
    used_ = std::move(wider);
    words_ *= 2;
  }

  std::size_t words_ = 1;   ///< per particle
  std::vector<Word> used_;  ///< a bit per colour
};

}  // namespace

std::vector<std::vector<std::int32_t>> colourSprings(const Model& model,
                                                     const std::vector<std::int32_t>& slots) {
  std::vector<std::vector<std::int32_t>> colours;
  Colouring colouring(model.particleCount());
  for (std::int32_t slot : slots) {
    const Spring& spring = model.springs[slot];
    if (!spring.exists()) continue;
    const auto chosen = static_cast<std::size_t>(colouring.pick(spring, gridColour(model, spring)));
    if (colours.size() <= chosen) colours.resize(chosen + 1);
    colours[chosen].push_back(slot);
  }
  const auto isEmpty = [](const std::vector<std::int32_t>& colour) { return colour.empty(); };
  colours.erase(std::remove_if(colours.begin(), colours.end(), isEmpty), colours.end());
  return colours;
}

}  // namespace cloth_sim
