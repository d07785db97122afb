#pragma once
/// \file The springs' part of the matrices of implicit methods, without a matrix.

#include "bend_matrix.h"
#include "constraints/spring_schedule.h"
#include "vector_operations.h"

namespace cloth_sim {

/// A symmetric matrix M + sum over springs of (S p)^T (a n n^T + t (1 - n n^T)) (S p), S p the
/// difference of the ends: what linearised springs and dashpots do; and a bending energy's. Rows
/// and columns of particles with prescribed motion count as absent. It is never assembled: a
/// product is one sweep over the springs, in the order and on the threads of all other sweeps.
class SpringMatrix {
 public:
  /// What it is made of; the same in every call from `linearise` on.
  struct Elements {
    const SpringSchedule& springs;
    const BendMatrix& bending;
  };

  /// Linearises springs at positions x: a = elastic k + viscous c and t = elastic k max(0, 1 -
  /// l0/l) for each. Without its negative part, t keeps the matrix positive definite also where
  /// springs are compressed (Choi & Ko 2002).
  /// The bending energy is there as (elastic + viscous retardation) K.
  /// \param diagonal  M, one value for the three coordinates of each particle; 0: prescribed.
  void linearise(const Elements& elements, const VectorArray& x, double elastic, double viscous,
                 const ScalarArray& diagonal);

  /// q = A p.
  void multiply(const Elements& elements, const VectorArray& p, VectorArray& q) const;

  /// Solves A p = r by conjugate gradients, preconditioned with the 3 x 3 blocks on the diagonal,
  /// to |A p - r| <= tolerance |r|.
  /// \return iterations.
  int solve(const Elements& elements, const VectorArray& r, double tolerance, int maxIterations,
            VectorArray& p);

 private:
  void factoriseBlocks(const Elements& elements);
  void precondition(const VectorArray& r, VectorArray& z) const;

  VectorArray direction_;         ///< n, by position of the schedule
  std::vector<double> along_;     ///< a - t
  std::vector<double> across_;    ///< t
  double bendScale_ = 0.0;        ///< times the matrix of the bending energy
  ScalarArray diagonal_;          ///< by particle
  VectorArray blockDiagonal_;     ///< of the inverses of the blocks: xx, yy, zz
  VectorArray blockOffDiagonal_;  ///< xy, yz, xz
  VectorArray residual_, preconditioned_, search_, product_;
};

}  // namespace cloth_sim
