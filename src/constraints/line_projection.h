#pragma once
/// \file Projection of springs line by line: each line at once, by a direct solve.

#include "particles.h"
#include "spring_lines.h"

namespace cloth_sim {

/// Extended position-based dynamics with a direct solve for each line of springs.
///
/// The springs i of a line, between its particles i and i + 1, are constraints C_i(x) = l_i - L_i
/// with the compliance alpha_i = 1 / (k_i h^2) and the damping ratio gamma_i = c_i / (k_i h), as in
/// reference_projection.h. That projects one spring after the other; here the multipliers mu_i of a
/// line follow from one linear system (Macklin, Mueller & Chentanez 2016, eqs. 12 and 26),
///
///     (w_i + w_{i+1} + alpha_i / (1 + gamma_i)) mu_i
///         - w_i (n_i . n_{i-1}) mu_{i-1} - w_{i+1} (n_i . n_{i+1}) mu_{i+1}
///         = (C_i + gamma_i n_i . (d_i - d_start,i)) / (1 + gamma_i).
///
/// Its matrix is symmetric, positive definite and tridiagonal, so the Thomas algorithm solves it in
/// one pass forwards and one back. Tension thus passes along a whole line within a substep, where a
/// sweep over single springs passes it on by one cell. Direct solves of chains of constraints are
/// known from rods (Deul et al. 2018); taking one family of lines after the other is line
/// Gauss-Seidel.
class LineProjection {
 public:
  /// Prepares for springs, and for substeps of length h [s].
  void prepare(const SpringLines& lines, const SpringNetwork& springs, double h);

  /// Projects every line once, colour by colour. Moves `particles.x`.
  /// \param inverseMass  by particle slot [1/kg]; 0: held.
  /// \param pull         by particle slot [kg m]: added up for particles that are held; over h it
  ///                     is the impulse of the springs on the holder.
  void project(const SpringLines& lines, const ScalarArray& inverseMass, Particles& particles,
               VectorArray& pull);
  /// The same; adds the length of the displacement by every line to `moved` [m], by particle slot.
  void projectAndMeasure(const SpringLines& lines, const ScalarArray& inverseMass,
                         Particles& particles, VectorArray& pull, ScalarArray& moved);

 private:
  /// Parameters of four springs.
  struct alignas(32) Parameters {
    double restLength[kLanes];  ///< [m]
    double compliance[kLanes];  ///< alpha / (1 + gamma) [1/kg]
  };
  /// A particle while lines are projected.
  struct alignas(32) Body {
    double x[3];  ///< [m]
    double w;     ///< inverse inertia [1/kg]
  };
  struct Kernel;

  /// Index of a particle slot in `bodies_`. Four unused entries after every 128 keep the rows of a
  /// grid, whose length is often a power of two, out of each other's cache sets.
  static std::uint32_t placeOf(std::int32_t slot) {
    const auto k = static_cast<std::uint32_t>(slot);
    return k + k / 128 * 4;
  }

  void loadBodies(const ScalarArray& inverseMass, const Particles& particles);
  void storeBodies(Particles& particles) const;
  template <bool kMeasured>
  void run(const SpringLines& lines, const ScalarArray& inverseMass, Particles& particles,
           VectorArray& pull, double* moved);

  /// Of the batches that differ: many rows of a grid share theirs.
  std::vector<Parameters> parameters_;
  std::vector<double> gamma_;                  ///< four by step of a batch; empty without dashpots
  std::vector<std::int32_t> firstParameters_;  ///< by batch: index in `parameters_`
  /// By place of the lines, as `SpringLines::slots`: where in `bodies_` particles are [bytes].
  std::vector<std::array<std::uint32_t, kLanes>> offsets_;
  CacheAlignedVector<Body> bodies_;
};

}  // namespace cloth_sim
