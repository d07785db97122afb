#pragma once
/// \file Gauss-Seidel projection of bending elements.

#include <functional>

#include "cloth_sim/cloth/model.h"
#include "particles.h"

namespace cloth_sim {

/// The substeps in which bending elements are projected.
struct BendStep {
  double h = 0.0;            ///< length of a substep [s]
  double retardation = 0.0;  ///< dashpot over stiffness [s]

  /// Displacement over acceleration that an impulse gives [s^2].
  double square() const { return h * h; }
};

/// The elements of a plate bending energy as constraints with compliance, coloured so that no two
/// of a colour share a particle. An element's constraint is its curvature, C = sum of weight_i x_i
/// = 0, a 3-vector. Elements with the same stencil are one constraint. The order depends on the
/// elements and the slots alone, not on the history of edits.
///
/// On a grid most elements of a colour stand in runs: equal weights, and the slots of each are
/// those of the one before it, plus one. A run is projected without gathers, several elements at a
/// time.
class BendProjection {
 public:
  void build(const PlateBending& bending, const Particles& particles);
  /// Takes a part of the elements. \param isIn  isIn(e): the element e is of the part.
  void build(const PlateBending& bending, const Particles& particles,
             const std::function<bool(std::size_t)>& isIn);

  bool empty() const { return stiffness_.empty(); }

  /// Finds the factors of the XPBD update (Macklin et al. 2016, eq. 26).
  void setStep(const BendStep& step, const ScalarArray& inverseMass);

  /// Projects every element once.
  /// \param inverseInertia  by particle slot [1/kg]; at most the inverse mass. Factors are those of
  ///                        the masses, so that particles with added inertia bend a little less.
  /// \param onHeld  onHeld(slot, impulse * h) is called, in order, for each held particle (inverse
  ///                mass zero) of an element that has a free one, too.
  template <typename OnHeld>
  void project(Particles& particles, const ScalarArray& inverseInertia,
               const OnHeld& onHeld) const {
    projectFree(particles, inverseInertia);
    for (const Single& held : held_) {
      const Vec3 multiplier = apply(held, inverseInertia, particles);
      for (std::size_t k = 0; k < held.count; ++k) {
        const auto slot = static_cast<std::size_t>(held.slot[k]);
        if (particles.inverseMass[slot] == 0.0) onHeld(slot, held.weight[k] * multiplier);
      }
    }
  }

 private:
  /// Consecutive elements of one colour.
  struct Run {
    std::array<std::int32_t, PlateElement::kMostVertices> slot;  ///< of the first element
    std::array<double, PlateElement::kMostVertices> weight;      ///< of each element [1/m^2]
    std::size_t count = 0;                                       ///< of vertices of an element
    std::int32_t first = 0;                                      ///< index of the first element
    std::int32_t length = 0;                                     ///< number of elements
  };
  /// An element by itself.
  struct Single {
    std::array<std::int32_t, PlateElement::kMostVertices> slot;
    std::array<double, PlateElement::kMostVertices> weight;  ///< [1/m^2]
    std::size_t count = 0;                                   ///< of vertices
    double factor = 0.0;  ///< see `factor_`; not zero for held particles
  };

  void append(const PlateElement& element, const Particles& particles);
  /// The sum of w weight^2 over the vertices of an element [1/(kg m^4)].
  /// \param k  index of the element in the run.
  static double mobility(const Run& run, std::int32_t k, const ScalarArray& inverseMass);
  double factorOf(const Run& run, std::int32_t k, const ScalarArray& inverseMass) const;
  /// Projects all elements without held particles.
  void projectFree(Particles& particles, const ScalarArray& inverseInertia) const;
  /// Projects the elements [first, last) of one colour.
  void projectPart(std::int32_t first, std::int32_t last, const ScalarArray& inverseInertia,
                   Particles& particles) const;
  /// Projects an element.
  /// \return the multiplier [kg m^3]: times a weight, the mass times displacement of that particle.
  Vec3 apply(const Single& element, const ScalarArray& inverseInertia, Particles& particles) const;

  std::vector<Run> runs_;                    ///< in order of their colours
  std::vector<std::int32_t> firstOfColour_;  ///< element, and one more
  std::vector<double> stiffness_;            ///< by element [N m^3]
  /// By element: 1 / ((1 + gamma) sum of w weight^2 + 1 / (n k h^2)) [kg m^4], where n is the
  /// interval; 0: a particle of it is held.
  std::vector<double> factor_;
  std::vector<Single> held_;    ///< elements with held and free particles
  double gamma_ = 0.0;          ///< damping ratio: retardation over h
  double inverseSquare_ = 0.0;  ///< 1 / (n h^2) [1/s^2]
};

}  // namespace cloth_sim
