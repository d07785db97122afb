#include "bend_projection.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "support/vector_clones.h"
#include "taken_colours.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Fewer elements are not worth a second thread.
constexpr std::int32_t kGrainElements = 512;

using Slots = std::array<std::int32_t, PlateElement::kMostVertices>;

bool sameStencil(const PlateElement& a, const PlateElement& b) {
  if (a.vertex != b.vertex) return false;
  // Families of a face may share their vertices: then the weights tell them apart.
  const double scale = std::abs(a.weight[0]) + std::abs(a.weight[1]);
  for (std::size_t k = 0; k < a.weight.size(); ++k) {
    if (std::abs(a.weight[k] - b.weight[k]) > 1e-9 * scale) return false;
  }
  return true;
}

/// The elements of a part, those with the same stencil joined into one.
std::vector<PlateElement> joined(const PlateBending& bending,
                                 const std::function<bool(std::size_t)>& isIn) {
  std::vector<std::size_t> order;
  for (std::size_t e = 0; e < bending.elements().size(); ++e) {
    if (isIn(e) && bending.elements()[e].count > 0) order.push_back(e);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return bending.elements()[a].vertex < bending.elements()[b].vertex;
  });
  std::vector<PlateElement> result;
  for (const std::size_t e : order) {
    const PlateElement& element = bending.elements()[e];
    if (!result.empty() && sameStencil(result.back(), element)) {
      result.back().stiffness += element.stiffness;
    } else {
      result.push_back(element);
    }
  }
  return result;
}

Slots slotsOf(const PlateElement& element, const Particles& particles) {
  Slots slot{};
  for (int k = 0; k < element.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    slot[i] = particles.slotOf[element.vertex[i]];
  }
  return slot;
}

/// An element in the order of colouring: those with equal distances between their slots follow each
/// other, so that they get into one colour and stand in runs.
struct Placed {
  std::size_t element = 0;
  std::int32_t first = 0;  ///< slot of the first vertex
  Slots distance{};        ///< from there to the slot of each vertex

  bool operator<(const Placed& other) const {
    return std::tie(distance, first, element) <
           std::tie(other.distance, other.first, other.element);
  }
};

std::vector<Placed> placed(const std::vector<PlateElement>& elements, const Particles& particles) {
  std::vector<Placed> result(elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Slots slot = slotsOf(elements[e], particles);
    result[e].element = e;
    result[e].first = slot[0];
    for (int k = 0; k < elements[e].count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      result[e].distance[i] = slot[i] - slot[0];
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Colours elements greedily: each gets the smallest colour that none of its particles has yet.
/// \return indices of elements by colour.
std::vector<std::vector<std::size_t>> coloured(const std::vector<PlateElement>& elements,
                                               const Particles& particles) {
  TakenColours taken(particles.slots);
  std::vector<std::vector<std::size_t>> colours;
  for (const Placed& place : placed(elements, particles)) {
    const PlateElement& element = elements[place.element];
    const std::size_t colour =
        taken.take(slotsOf(element, particles), static_cast<std::size_t>(element.count));
    if (colour >= colours.size()) colours.resize(colour + 1);
    colours[colour].push_back(place.element);
  }
  return colours;
}

/// Elements of a run, for the kernel.
struct Part {
  const double* weight;
  const double* factor;
  const double* inverseInertia;                               ///< by slot
  std::array<std::size_t, PlateElement::kMostVertices> slot;  ///< of the first element
  std::size_t length;                                         ///< number of elements
  double gamma;
};

template <std::size_t kCount, bool kDamped>
__attribute__((always_inline)) inline void projectElements(const Part& part, const double* start,
                                                           double* x) {
  CLOTH_SIM_NO_ALIAS_LOOP
  for (std::size_t e = 0; e < part.length; ++e) {
    std::array<double, kCount> at;
    double curvature = 0.0;
    for (std::size_t k = 0; k < kCount; ++k) {
      at[k] = x[part.slot[k] + e];
      curvature += part.weight[k] * at[k];
    }
    if (kDamped) {
      double before = 0.0;
      for (std::size_t k = 0; k < kCount; ++k) before += part.weight[k] * start[part.slot[k] + e];
      curvature += part.gamma * (curvature - before);
    }
    const double multiplier = -part.factor[e] * curvature;
    for (std::size_t k = 0; k < kCount; ++k) {
      x[part.slot[k] + e] =
          at[k] + part.inverseInertia[part.slot[k] + e] * part.weight[k] * multiplier;
    }
  }
}

template <std::size_t kCount>
__attribute__((always_inline)) inline void projectElements(const Part& part, const double* start,
                                                           double* x) {
  if (part.gamma > 0.0) {
    projectElements<kCount, true>(part, start, x);
  } else {
    projectElements<kCount, false>(part, start, x);
  }
}

template <std::size_t kCount>
__attribute__((always_inline)) inline void projectElements(const Part& part, const ConstAxes& start,
                                                           const Axes& at) {
  projectElements<kCount>(part, start.x, at.x);
  projectElements<kCount>(part, start.y, at.y);
  projectElements<kCount>(part, start.z, at.z);
}

/// Projects elements of a run.
/// \param count  of vertices of an element.
/// \param at     positions by slot, which are changed.
CLOTH_SIM_VECTOR_CLONES
void projectAll(std::size_t count, const Part& part, const ConstAxes& start, const Axes& at) {
  switch (count) {
    case 3:
      return projectElements<3>(part, start, at);
    case 4:
      return projectElements<4>(part, start, at);
    case 5:
      return projectElements<5>(part, start, at);
    default:
      return projectElements<6>(part, start, at);
  }
}

}  // namespace

void BendProjection::build(const PlateBending& bending, const Particles& particles) {
  build(bending, particles, [](std::size_t /*e*/) { return true; });
}

void BendProjection::build(const PlateBending& bending, const Particles& particles,
                           const std::function<bool(std::size_t)>& isIn) {
  const std::vector<PlateElement> elements = joined(bending, isIn);
  runs_.clear();
  stiffness_.clear();
  firstOfColour_.assign(1, 0);
  for (const std::vector<std::size_t>& colour : coloured(elements, particles)) {
    for (const std::size_t e : colour) append(elements[e], particles);
    firstOfColour_.push_back(static_cast<std::int32_t>(stiffness_.size()));
  }
  factor_.assign(stiffness_.size(), 0.0);
}

/// Appends an element to the last run, or begins one with it.
void BendProjection::append(const PlateElement& element, const Particles& particles) {
  Run run{slotsOf(element, particles), element.weight, static_cast<std::size_t>(element.count),
          static_cast<std::int32_t>(stiffness_.size()), 1};
  stiffness_.push_back(element.stiffness);
  const bool beginsColour = run.first == firstOfColour_.back();
  if (!beginsColour && runs_.back().count == run.count && runs_.back().weight == run.weight) {
    Run& last = runs_.back();
    bool follows = true;
    for (std::size_t k = 0; k < run.count; ++k) {
      follows = follows && run.slot[k] == last.slot[k] + last.length;
    }
    if (follows) {
      ++last.length;
      return;
    }
  }
  runs_.push_back(run);
}

double BendProjection::mobility(const Run& run, std::int32_t k, const ScalarArray& inverseMass) {
  double sum = 0.0;
  for (std::size_t i = 0; i < run.count; ++i) {
    sum += inverseMass[static_cast<std::size_t>(run.slot[i] + k)] * run.weight[i] * run.weight[i];
  }
  return sum;
}

/// \param k  index of an element in the run.
double BendProjection::factorOf(const Run& run, std::int32_t k,
                                const ScalarArray& inverseMass) const {
  const double sum = mobility(run, k, inverseMass);
  if (sum == 0.0) return 0.0;
  const double stiffness = stiffness_[static_cast<std::size_t>(run.first + k)];
  return 1.0 / ((1.0 + gamma_) * sum + inverseSquare_ / stiffness);
}

void BendProjection::setStep(const BendStep& step, const ScalarArray& inverseMass) {
  gamma_ = step.retardation / step.h;
  inverseSquare_ = 1.0 / step.square();
  held_.clear();
  for (const Run& run : runs_) {
    for (std::int32_t k = 0; k < run.length; ++k) {
      const double factor = factorOf(run, k, inverseMass);
      Single element{run.slot, run.weight, run.count, factor};
      bool isHeld = false;
      for (std::size_t i = 0; i < run.count; ++i) {
        element.slot[i] += k;
        isHeld = isHeld || inverseMass[static_cast<std::size_t>(element.slot[i])] == 0.0;
      }
      if (isHeld && factor > 0.0) held_.push_back(element);
      factor_[static_cast<std::size_t>(run.first + k)] = isHeld ? 0.0 : factor;
    }
  }
}

void BendProjection::projectFree(Particles& particles, const ScalarArray& inverseInertia) const {
  for (std::size_t colour = 0; colour + 1 < firstOfColour_.size(); ++colour) {
    const std::int32_t first = firstOfColour_[colour];
    parallelFor(firstOfColour_[colour + 1] - first, kGrainElements,
                [&](std::int32_t begin, std::int32_t end) {
                  projectPart(first + begin, first + end, inverseInertia, particles);
                });
  }
}

void BendProjection::projectPart(std::int32_t first, std::int32_t last,
                                 const ScalarArray& inverseInertia, Particles& particles) const {
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), first,
                                      [](std::int32_t e, const Run& run) { return e < run.first; });
  for (auto run = after - 1; run != runs_.end() && run->first < last; ++run) {
    const std::int32_t begin = std::max(first, run->first);
    if (run->length == 1) {  // on meshes that are no grid
      const double factor = factor_[static_cast<std::size_t>(begin)];
      apply({run->slot, run->weight, run->count, factor}, inverseInertia, particles);
      continue;
    }
    const std::int32_t end = std::min(last, run->first + run->length);
    Part part{run->weight.data(),
              factor_.data() + begin,
              inverseInertia.data(),
              {},
              static_cast<std::size_t>(end - begin),
              gamma_};
    for (std::size_t k = 0; k < run->count; ++k) {
      part.slot[k] = static_cast<std::size_t>(run->slot[k] + begin - run->first);
    }
    projectAll(run->count, part, axesAt(std::as_const(particles.start), 0), axesAt(particles.x, 0));
  }
}

Vec3 BendProjection::apply(const Single& element, const ScalarArray& inverseInertia,
                           Particles& p) const {
  const auto curvatureOf = [&](const VectorArray& x) {
    Vec3 curvature = Vec3::Zero();
    for (std::size_t k = 0; k < element.count; ++k) {
      curvature += element.weight[k] * x.at(static_cast<std::size_t>(element.slot[k]));
    }
    return curvature;
  };
  Vec3 curvature = curvatureOf(p.x);
  if (gamma_ > 0.0) curvature += gamma_ * (curvature - curvatureOf(p.start));
  const Vec3 multiplier = -element.factor * curvature;
  for (std::size_t k = 0; k < element.count; ++k) {
    const auto slot = static_cast<std::size_t>(element.slot[k]);
    p.x.set(slot, p.x.at(slot) + inverseInertia[slot] * element.weight[k] * multiplier);
  }
  return multiplier;
}

}  // namespace cloth_sim
