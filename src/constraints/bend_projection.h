#pragma once
/// \file Gauss-Seidel projection of bending elements.

#include "cloth_sim/cloth/model.h"
#include "particles.h"

namespace cloth_sim {

/// The elements of a plate bending energy as constraints with compliance, coloured so that no two
/// of a colour share a particle. An element's constraint is its curvature, C = sum of weight_i x_i
/// = 0, a 3-vector. Elements with the same stencil are one constraint. The order depends on the
/// elements alone, not on the history of edits.
class BendProjection {
 public:
  void build(const PlateBending& bending, const Particles& particles);

  bool empty() const { return elements_.empty(); }

  /// Finds the factors of the XPBD update (Macklin et al. 2016, eq. 26) for substeps of length h
  /// [s]. \param retardation  dashpot over stiffness [s].
  void setStep(double h, double retardation, const ScalarArray& inverseMass);

  /// Projects every element once.
  /// \param onHeld  onHeld(slot, impulse * h) is called, in order, for each held particle (inverse
  ///                mass zero) of an element that has a free one, too.
  template <typename OnHeld>
  void project(Particles& particles, const OnHeld& onHeld) const {
    projectFree(particles);
    for (const std::size_t e : held_) {
      const Vec3 multiplier = apply(elements_[e], particles);
      for (int k = 0; k < elements_[e].count; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const auto slot = static_cast<std::size_t>(elements_[e].slot[i]);
        if (particles.inverseMass[slot] == 0.0) onHeld(slot, elements_[e].weight[i] * multiplier);
      }
    }
  }

 private:
  struct Element {
    std::array<std::int32_t, PlateElement::kMostVertices> slot;
    std::array<double, PlateElement::kMostVertices> weight;  ///< [1/m^2]
    double stiffness;                                        ///< [N m^3]
    double factor;       ///< 1 / ((1 + gamma) sum of w weight^2 + 1 / (k h^2)) [kg m^4]
    std::int32_t count;  ///< of vertices
    bool held;           ///< whether a particle of it has prescribed motion
  };

  static Element packed(const PlateElement& element, const Particles& particles);
  /// Projects all elements without held particles.
  void projectFree(Particles& particles) const;
  /// Projects an element.
  /// \return the multiplier [kg m^3]: times a weight, the mass times displacement of that particle.
  Vec3 apply(const Element& element, Particles& particles) const;

  std::vector<Element> elements_;            ///< in order of their colours
  std::vector<std::int32_t> firstOfColour_;  ///< and one more
  std::vector<std::size_t> held_;            ///< elements with held and free particles
  double gamma_ = 0.0;                       ///< damping ratio: retardation over h
};

}  // namespace cloth_sim
