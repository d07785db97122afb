#include "bend_projection.h"

#include <algorithm>
#include <numeric>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Fewer elements are not worth a second thread.
constexpr std::int32_t kGrainElements = 512;

bool sameStencil(const PlateElement& a, const PlateElement& b) {
  if (a.vertex != b.vertex) return false;
  // Families of a face may share their vertices: then the weights tell them apart.
  const double scale = std::abs(a.weight[0]) + std::abs(a.weight[1]);
  for (std::size_t k = 0; k < a.weight.size(); ++k) {
    if (std::abs(a.weight[k] - b.weight[k]) > 1e-9 * scale) return false;
  }
  return true;
}

/// The elements, those with the same stencil joined into one.
std::vector<PlateElement> joined(const PlateBending& bending) {
  std::vector<std::size_t> order;
  for (std::size_t e = 0; e < bending.elements().size(); ++e) {
    if (bending.elements()[e].count > 0) order.push_back(e);
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

/// Colours elements greedily: each gets the smallest colour that none of its particles has yet.
/// \return indices of elements by colour.
std::vector<std::vector<std::size_t>> coloured(const std::vector<PlateElement>& elements,
                                               const Particles& particles) {
  std::vector<std::vector<bool>> isTaken;  // by colour, by slot
  std::vector<std::vector<std::size_t>> colours;
  const auto forSlots = [&](const PlateElement& element, const auto& visit) {
    for (int k = 0; k < element.count; ++k) {
      visit(
          static_cast<std::size_t>(particles.slotOf[element.vertex[static_cast<std::size_t>(k)]]));
    }
  };
  const auto isFree = [&](std::size_t colour, const PlateElement& element) {
    bool isAny = false;
    forSlots(element, [&](std::size_t slot) { isAny = isAny || isTaken[colour][slot]; });
    return !isAny;
  };
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::size_t colour = 0;
    while (colour < isTaken.size() && !isFree(colour, elements[e])) ++colour;
    if (colour == isTaken.size()) {
      isTaken.emplace_back(static_cast<std::size_t>(particles.slots), false);
      colours.emplace_back();
    }
    colours[colour].push_back(e);
    forSlots(elements[e], [&](std::size_t slot) { isTaken[colour][slot] = true; });
  }
  return colours;
}

}  // namespace

void BendProjection::build(const PlateBending& bending, const Particles& particles) {
  const std::vector<PlateElement> elements = joined(bending);
  elements_.clear();
  firstOfColour_.assign(1, 0);
  for (const std::vector<std::size_t>& colour : coloured(elements, particles)) {
    for (const std::size_t e : colour) elements_.push_back(packed(elements[e], particles));
    firstOfColour_.push_back(static_cast<std::int32_t>(elements_.size()));
  }
}

BendProjection::Element BendProjection::packed(const PlateElement& element,
                                               const Particles& particles) {
  Element result{};
  result.weight = element.weight;
  result.stiffness = element.stiffness;
  result.count = element.count;
  for (int k = 0; k < element.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    result.slot[i] = particles.slotOf[element.vertex[i]];
  }
  return result;
}

void BendProjection::setStep(double h, double retardation, const ScalarArray& inverseMass) {
  gamma_ = retardation / h;
  held_.clear();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    Element& element = elements_[e];
    double sum = 0.0;
    element.held = false;
    for (int k = 0; k < element.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double w = inverseMass[static_cast<std::size_t>(element.slot[i])];
      sum += w * element.weight[i] * element.weight[i];
      element.held = element.held || w == 0.0;
    }
    element.factor = 1.0 / ((1.0 + gamma_) * sum + 1.0 / (element.stiffness * h * h));
    if (element.held && sum > 0.0) held_.push_back(e);
  }
}

Vec3 BendProjection::apply(const Element& element, Particles& p) const {
  Vec3 curvature = Vec3::Zero();
  for (int k = 0; k < element.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    curvature += element.weight[i] * p.x.at(static_cast<std::size_t>(element.slot[i]));
  }
  if (gamma_ > 0.0) {
    Vec3 before = Vec3::Zero();
    for (int k = 0; k < element.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      before += element.weight[i] * p.start.at(static_cast<std::size_t>(element.slot[i]));
    }
    curvature += gamma_ * (curvature - before);
  }
  const Vec3 multiplier = -element.factor * curvature;
  for (int k = 0; k < element.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto slot = static_cast<std::size_t>(element.slot[i]);
    p.x.set(slot, p.x.at(slot) + p.inverseMass[slot] * element.weight[i] * multiplier);
  }
  return multiplier;
}

void BendProjection::projectFree(Particles& particles) const {
  for (std::size_t colour = 0; colour + 1 < firstOfColour_.size(); ++colour) {
    const std::int32_t first = firstOfColour_[colour];
    parallelFor(firstOfColour_[colour + 1] - first, kGrainElements,
                [&](std::int32_t begin, std::int32_t end) {
                  for (std::int32_t e = first + begin; e < first + end; ++e) {
                    const Element& element = elements_[static_cast<std::size_t>(e)];
                    if (!element.held) apply(element, particles);
                  }
                });
  }
}

}  // namespace cloth_sim
