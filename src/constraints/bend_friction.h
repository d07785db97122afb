#pragma once
/// \file Friction in bending, as a force and as a projection.

#include "cloth_sim/cloth/bend_friction.h"
#include "cloth_sim/cloth/model.h"
#include "particles.h"

namespace cloth_sim {

/// The slip elements of a model. `particles.bendOffset` says where their sliders are.
class BendFriction {
 public:
  void build(const Model& model, const Particles& particles);

  bool empty() const { return elements_.empty(); }

  // ---- for implicit methods: a step from sliders that move at its end

  /// Adds the forces of a step that began with the sliders where they are [N].
  void addForces(const Particles& particles, VectorArray& force) const;
  /// The potential of these forces [J]: see SlipElement::potential.
  double potential(const Particles& particles) const;
  /// Moves the sliders as far as the curvatures at the end of a step make them slip.
  void slip(Particles& particles) const;

  // ---- for position-based methods

  /// Projects every element once, colour by colour, and moves its slider: the update of XPBD, of
  /// three constraints whose multipliers are limited together by the moment of friction.
  /// \param square          n h^2, of an element that acts in every n-th substep of length h [s^2].
  /// \param inverseInertia  by particle slot [1/kg]; 0: held.
  /// \param onHeld          onHeld(slot, impulse * h) is called, in order, for held particles.
  template <typename OnHeld>
  void project(double square, const ScalarArray& inverseInertia, Particles& particles,
               const OnHeld& onHeld) const {
    projectColours(square, inverseInertia, particles);
    for (const std::size_t e : border_) {
      const Element& element = elements_[e];
      const Impulse impulse = projectOne(element, square, inverseInertia, particles);
      for (std::size_t i = 0; i < element.slip.count; ++i) {
        const auto slot = static_cast<std::size_t>(element.slip.vertex[i]);
        if (inverseInertia[slot] == 0.0) onHeld(slot, impulse.at(i));
      }
    }
  }
  /// Tells which elements have held particles. \param inverseMass  by particle slot; 0: held.
  void findHeld(const ScalarArray& inverseMass);

 private:
  struct Element {
    SlipElement slip;     ///< of particle slots
    std::size_t face;     ///< index in `Particles::bendOffset`
    bool isHeld = false;  ///< whether a particle of it has prescribed motion
  };
  /// The impulses of a projection on the particles of an element.
  struct Impulse {
    SignedCurvature curvature;
    Vec3 multiplier = Vec3::Zero();  ///< [kg m^3]
    /// Mass times displacement of a particle [kg m].
    Vec3 at(std::size_t i) const {
      return curvature.gradient[i].dot(multiplier) * curvature.normal;
    }
  };

  static SignedCurvature curvatureOf(const Element& element, const Particles& particles);
  /// Projects the elements without held particles.
  void projectColours(double square, const ScalarArray& inverseInertia, Particles& particles) const;
  static Impulse projectOne(const Element& element, double square,
                            const ScalarArray& inverseInertia, Particles& particles);

  std::vector<Element> elements_;            ///< in order of their colours
  std::vector<std::int32_t> firstOfColour_;  ///< and one more
  std::vector<std::size_t> border_;          ///< elements with held particles
};

}  // namespace cloth_sim
