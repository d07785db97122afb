#pragma once
/// \file Gauss-Seidel over bending elements, for methods that project constraints.

#include "cloth_sim/cloth/model.h"
#include "particles.h"

namespace cloth_sim {

/// The elements of a PlateBending as constraints with compliance: those with the same stencil
/// joined into one, and coloured, so that no two of a colour share a particle. A function of the
/// network alone.
class BendProjection {
 public:
  void build(const PlateBending& bending, const Particles& particles);

  bool empty() const { return elements_.empty(); }

  /// Gains for substeps of length h, as the XPBD update of Macklin et al. 2016, eq. 26, has them.
  /// \param retardation  dashpot over stiffness [s].
  void setStep(double h, double retardation, const ScalarArray& inverseMass);

  /// Projects every element once. `onHeld(slot, impulse * h)` is called, in order, for particles of
  /// no inverse mass.
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
    double gain;         ///< 1 / ((1 + gamma) sum of w weight^2 + 1 / (k h^2)) [kg m^4]
    std::int32_t count;  ///< of vertices
    bool held;           ///< some particle of it has prescribed motion
  };

  void projectFree(Particles& particles) const;
  /// Moves the particles of an element; returns the multiplier: times a weight, what mass times
  /// displacement that particle gets [kg m^3].
  Vec3 apply(const Element& element, Particles& particles) const;

  std::vector<Element> elements_;            ///< colour by colour
  std::vector<std::int32_t> firstOfColour_;  ///< and one more
  std::vector<std::size_t> held_;            ///< held elements that have a free particle, too
  double gamma_ = 0.0;                         ///< retardation over h
};

}  // namespace cloth_sim
