#include "packed.h"

#include <algorithm>
#include <numeric>

namespace cloth_sim::bench {
namespace {

/// The bits of two numbers in turn.
std::uint64_t interleaved(std::uint32_t row, std::uint32_t column) {
  std::uint64_t result = 0;
  for (int bit = 0; bit < 32; ++bit) {
    result |= std::uint64_t{(column >> bit) & 1U} << (2 * bit);
    result |= std::uint64_t{(row >> bit) & 1U} << (2 * bit + 1);
  }
  return result;
}

/// Slots of n x n particles, row by row, along a Z curve (Morton 1966).
std::vector<std::int32_t> alongZ(int n) {
  const auto count = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  const auto key = [n](std::int32_t v) {
    return interleaved(static_cast<std::uint32_t>(v / n), static_cast<std::uint32_t>(v % n));
  };
  std::vector<std::int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  std::vector<std::int32_t> slotOf(count);
  for (std::size_t k = 0; k < count; ++k) {
    slotOf[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
  }
  return slotOf;
}

}  // namespace

Packed::Packed(int n, Order order, const std::string& bending)
    : simulation(refinedWhenCut(hanging(n, "xpbd", bending))) {
  const Model& model = simulation.model();
  particles.layOut(model);
  if (order == Order::kAny) {
    particles.slotOf = alongZ(n);
    particles.slots = n * n;
  }
  schedule.build(model, particles.slotOf);
  load();
}

/// The slits take no particle away.
void Packed::slit() {
  cutSlits(simulation);
  const Model& model = simulation.model();
  while (particles.count() < model.particleCount()) particles.slotOf.push_back(particles.slots++);
  schedule.applyChanges(model, model.springs.allModified(), particles.slotOf);
  load();
}

void Packed::load() {
  particles.resize();
  particles.load(simulation.state());
  particles.loadMasses(simulation.model(), {});
  particles.start = particles.x;
  force.resize(static_cast<std::size_t>(particles.slots));
}

}  // namespace cloth_sim::bench
