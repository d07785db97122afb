#include "bend_friction.h"

#include "taken_colours.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Fewer elements are not worth a second thread.
constexpr std::int32_t kGrainSlips = 128;

}  // namespace

void BendFriction::build(const Model& model, const Particles& particles) {
  elements_.clear();
  firstOfColour_.assign(1, 0);
  if (!model.bending.hasFriction()) return;
  TakenColours taken(particles.slots);
  std::vector<std::vector<Element>> colours;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    Element element{slipElement(model.bending, model.mesh, f), static_cast<std::size_t>(f)};
    SlipElement& slip = element.slip;
    if (slip.count == 0) continue;
    for (std::size_t i = 0; i < slip.count; ++i) slip.vertex[i] = particles.slotOf[slip.vertex[i]];
    const std::size_t colour = taken.take(slip.vertex, slip.count);
    if (colour >= colours.size()) colours.resize(colour + 1);
    colours[colour].push_back(element);
  }
  for (const std::vector<Element>& colour : colours) {
    elements_.insert(elements_.end(), colour.begin(), colour.end());
    firstOfColour_.push_back(static_cast<std::int32_t>(elements_.size()));
  }
}

void BendFriction::findHeld(const ScalarArray& inverseMass) {
  border_.clear();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    Element& element = elements_[e];
    element.isHeld = false;
    for (std::size_t i = 0; i < element.slip.count; ++i) {
      const auto slot = static_cast<std::size_t>(element.slip.vertex[i]);
      element.isHeld = element.isHeld || inverseMass[slot] == 0.0;
    }
    if (element.isHeld) border_.push_back(e);
  }
}

SignedCurvature BendFriction::curvatureOf(const Element& element, const Particles& particles) {
  return signedCurvature(element.slip, [&](std::int32_t slot) {
    return particles.x.at(static_cast<std::size_t>(slot));
  });
}

void BendFriction::addForces(const Particles& particles, VectorArray& force) const {
  for (const Element& element : elements_) {
    const SignedCurvature curvature = curvatureOf(element, particles);
    const Vec3 moment =
        element.slip.stiffness *
        SlipElement::withoutSlip(curvature.value - particles.bendOffset[element.face]);
    for (std::size_t i = 0; i < element.slip.count; ++i) {
      const auto slot = static_cast<std::size_t>(element.slip.vertex[i]);
      force.set(slot, force.at(slot) - curvature.gradient[i].dot(moment) * curvature.normal);
    }
  }
}

double BendFriction::potential(const Particles& particles) const {
  double sum = 0.0;
  for (const Element& element : elements_) {
    const Vec3 stretched =
        curvatureOf(element, particles).value - particles.bendOffset[element.face];
    sum += element.slip.potential(stretched);
  }
  return sum;
}

void BendFriction::slip(Particles& particles) const {
  for (const Element& element : elements_) {
    Vec3& z = particles.bendOffset[element.face];
    z = SlipElement::slipped(curvatureOf(element, particles).value, z);
  }
}

/// With the compliance 1 / (k n h^2) of the spring, a constraint C = c - z has the multiplier
/// -C / (sum of w gradient^2 + compliance), and leaves the spring stretched by -compliance times
/// that. Where the three would be stretched by more than the slider bears, they are reduced alike.
BendFriction::Impulse BendFriction::projectOne(const Element& element, double square,
                                               const ScalarArray& inverseInertia,
                                               Particles& particles) {
  const SlipElement& slip = element.slip;
  Impulse impulse{curvatureOf(element, particles)};
  const double compliance = 1.0 / (slip.stiffness * square);
  Vec3& z = particles.bendOffset[element.face];
  Vec3 softness = Vec3::Zero();
  for (std::size_t i = 0; i < slip.count; ++i) {
    const double w = inverseInertia[static_cast<std::size_t>(slip.vertex[i])];
    softness += w * impulse.curvature.gradient[i].cwiseAbs2();
  }
  const Vec3 all = softness + Vec3::Constant(compliance);
  const Vec3 trial = (impulse.curvature.value - z).cwiseQuotient(all);
  const double stretched = compliance * trial.norm();
  const bool slips = stretched > SlipElement::kSlipCurvature;
  impulse.multiplier =
      slips ? Vec3(-SlipElement::kSlipCurvature / stretched * trial) : Vec3(-trial);
  if (slips) z = impulse.curvature.value + all.cwiseProduct(impulse.multiplier);
  for (std::size_t i = 0; i < slip.count; ++i) {
    const auto slot = static_cast<std::size_t>(slip.vertex[i]);
    particles.x.set(slot, particles.x.at(slot) + inverseInertia[slot] * impulse.at(i));
  }
  return impulse;
}

void BendFriction::projectColours(double square, const ScalarArray& inverseInertia,
                                  Particles& particles) const {
  for (std::size_t colour = 0; colour + 1 < firstOfColour_.size(); ++colour) {
    const std::int32_t first = firstOfColour_[colour];
    parallelFor(firstOfColour_[colour + 1] - first, kGrainSlips,
                [&](std::int32_t begin, std::int32_t end) {
                  for (std::int32_t e = first + begin; e < first + end; ++e) {
                    const Element& element = elements_[static_cast<std::size_t>(e)];
                    if (!element.isHeld) projectOne(element, square, inverseInertia, particles);
                  }
                });
  }
}

}  // namespace cloth_sim
