#include "bend_projection.h"

#include <algorithm>
#include <numeric>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

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

/// Elements with the same stencil, joined.
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

}  // namespace

void BendProjection::build(const PlateBending& bending, const Particles& particles) {
  const std::vector<PlateElement> all = joined(bending);
  // Greedily, the smallest colour that no particle of the element has yet.
  std::vector<std::vector<bool>> seen;  // by colour, by slot
  std::vector<std::vector<std::size_t>> ofColour;
  const auto isFree = [&](std::size_t colour, const PlateElement& element) {
    for (int k = 0; k < element.count; ++k) {
      const VertexId v = element.vertex[static_cast<std::size_t>(k)];
      if (seen[colour][static_cast<std::size_t>(particles.slotOf[v])]) return false;
    }
    return true;
  };
  for (std::size_t e = 0; e < all.size(); ++e) {
    std::size_t colour = 0;
    while (colour < seen.size() && !isFree(colour, all[e])) ++colour;
    if (colour == seen.size()) {
      seen.emplace_back(static_cast<std::size_t>(particles.slots), false);
      ofColour.emplace_back();
    }
    ofColour[colour].push_back(e);
    for (int k = 0; k < all[e].count; ++k) {
      const VertexId v = all[e].vertex[static_cast<std::size_t>(k)];
      seen[colour][static_cast<std::size_t>(particles.slotOf[v])] = true;
    }
  }
  elements_.clear();
  firstOfColour_.assign(1, 0);
  for (const std::vector<std::size_t>& colour : ofColour) {
    for (const std::size_t e : colour) {
      Element element{};
      element.weight = all[e].weight;
      element.stiffness = all[e].stiffness;
      element.count = all[e].count;
      for (int k = 0; k < element.count; ++k) {
        const auto i = static_cast<std::size_t>(k);
        element.slot[i] = particles.slotOf[all[e].vertex[i]];
      }
      elements_.push_back(element);
    }
    firstOfColour_.push_back(static_cast<std::int32_t>(elements_.size()));
  }
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
    element.gain = 1.0 / ((1.0 + gamma_) * sum + 1.0 / (element.stiffness * h * h));
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
  const Vec3 multiplier = -element.gain * curvature;
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
