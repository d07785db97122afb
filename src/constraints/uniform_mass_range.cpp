#include "uniform_mass_range.h"

#include <algorithm>

#include "support/simd.h"

namespace cloth_sim {
namespace {

/// For each number the place after the last of those from it on that are equal to it.
std::vector<std::int32_t> endsOfEqual(const ScalarArray& numbers) {
  auto end = static_cast<std::int32_t>(numbers.size());
  std::vector<std::int32_t> ends(numbers.size());
  for (std::int32_t k = end - 1; k >= 0; --k) {
    if (numbers[k] != numbers[end - 1]) end = k + 1;
    ends[k] = end;
  }
  return ends;
}

}  // namespace

void findUniformMassRanges(const SpringSchedule& schedule, const ScalarArray& inverseMass,
                           std::vector<UniformMassRange>& stretches) {
  const std::vector<std::int32_t> equalUntil = endsOfEqual(inverseMass);
  const auto evenFrom = [&](const SpringSchedule::Span& run, std::int32_t k) {
    const std::int32_t a = run.ends.a + k;
    const std::int32_t b = run.ends.b + k;
    if (inverseMass[a] != inverseMass[b]) return 0;
    return std::min({equalUntil[a] - a, equalUntil[b] - b, run.count - k}) / kLanes * kLanes;
  };
  stretches.assign(schedule.spans().size(), {});
  for (std::size_t s = 0; s < stretches.size(); ++s) {
    const SpringSchedule::Span& span = schedule.spans()[s];
    UniformMassRange& longest = stretches[s];
    for (std::int32_t k = 0; span.isRun && k + kLanes <= span.count;) {
      const std::int32_t even = evenFrom(span, k);
      if (even > longest.end - longest.from) longest = {k, k + even};
      k += std::max(even, kLanes);
    }
  }
}

}  // namespace cloth_sim
