#pragma once
/// \file Projection of springs line by line: each line at once, by a direct solve.

#include "line_bodies.h"
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
///
/// The arithmetic is in single precision, eight lines at a time, on pairs of floats (LineBodies).
/// So strains have a noise of about 1e-7, and the impulses of a line add up to zero to about 1e-7
/// of the largest.
class LineProjection {
 public:
  /// Prepares for springs.
  void prepare(const SpringLines& lines, const SpringNetwork& springs);
  /// Prepares for substeps of length h [s]. Allocates no memory.
  void setStep(double h);

  /// Projects every line once, colour by colour. Moves `particles.x`.
  /// \param inverseMass  by particle slot [1/kg]; 0: held.
  /// \param pull         by particle slot [kg m]: added up for particles that are held; over h it
  ///                     is the impulse of the springs on the holder.
  void project(const SpringLines& lines, const ScalarArray& inverseMass, Particles& particles,
               VectorArray& pull);
  /// The same; finds how far the lines displaced each particle in vain.
  /// \param cancelled  by particle slot: half of the difference between the sum of the lengths of
  ///                   the displacements by every line and the length of their sum [m].
  void projectAndMeasure(const SpringLines& lines, const ScalarArray& inverseMass,
                         Particles& particles, VectorArray& pull, ScalarArray& cancelled);

 private:
  static constexpr std::int32_t kWidth = SpringLines::kWidth;

  /// The springs of a step of a block, as the model has them; zero where there is none.
  struct Source {
    double restLength[kWidth];  ///< [m]
    double stiffness[kWidth];   ///< [N/m]
    double damping[kWidth];     ///< [N s/m]
  };
  /// Parameters of these springs for a length of the substep.
  struct alignas(32) Parameters {
    float restLength[kWidth];  ///< [m]
    float compliance[kWidth];  ///< alpha / (1 + gamma) [1/kg]
  };
  struct Kernel;

  static Source sourceOf(const SpringLines::Slots& slots, const SpringNetwork& springs);
  void findOffsets(const SpringLines& lines);
  template <bool kMeasured>
  void run(const SpringLines& lines, const ScalarArray& inverseMass, const Particles& particles,
           VectorArray& pull);

  std::vector<Source> sources_;  ///< of the blocks that differ: many rows of a grid share theirs
  std::vector<Parameters> parameters_;  ///< by source
  std::vector<float> gamma_;  ///< shape (as `parameters_`, kWidth); empty without dashpots
  std::vector<std::int32_t> firstParameters_;  ///< by block: index in `parameters_`
  /// By place of the lines, as `SpringLines::slots`: where in `bodies_` particles are [bytes].
  std::vector<std::array<std::uint32_t, kWidth>> offsets_;
  LineBodies bodies_;
};

}  // namespace cloth_sim
