#pragma once
/// \file The springs' part of the matrices of implicit methods, without a matrix.

#include "cloth_sim/solver/spring_schedule.h"
#include "packed_ops.h"

namespace cloth_sim {

/// A symmetric matrix M + sum over springs of (S p)^T (a n n^T + t (1 - n n^T)) (S p), S p the
/// difference of the ends: what linearised springs and dashpots do. Rows and columns of particles
/// with prescribed motion count as absent. It is never assembled: a product is one sweep over the
/// springs, in the order and on the threads of all other sweeps.
class SpringMatrix {
 public:
  /// Linearises springs at positions x: a = elastic k + viscous c and t = elastic k max(0, 1 -
  /// l0/l) for each. Without its negative part, t keeps the matrix positive definite also where
  /// springs are compressed (Choi & Ko 2002).
  /// \param diagonal  M, one value for the three coordinates of each particle; 0: prescribed.
  void linearise(const SpringSchedule& schedule, const PackedVectors& x, double elastic,
                 double viscous, const std::vector<double>& diagonal);

  /// q = A p.
  void multiply(const SpringSchedule& schedule, const PackedVectors& p, PackedVectors& q) const;

  /// Solves A p = r by conjugate gradients, preconditioned with the 3 x 3 blocks on the diagonal,
  /// to |A p - r| <= tolerance |r|.
  /// \return iterations.
  int solve(const SpringSchedule& schedule, const PackedVectors& r, double tolerance,
            int maxIterations, PackedVectors& p);

 private:
  void factoriseBlocks(const SpringSchedule& schedule);
  void precondition(const PackedVectors& r, PackedVectors& z) const;

  PackedVectors direction_;         ///< n, by position of the schedule
  std::vector<double> along_;       ///< a - t
  std::vector<double> across_;      ///< t
  std::vector<double> diagonal_;    ///< by particle
  PackedVectors blockDiagonal_;     ///< of the inverses of the blocks: xx, yy, zz
  PackedVectors blockOffDiagonal_;  ///< xy, yz, xz
  PackedVectors residual_, preconditioned_, search_, product_;
};

}  // namespace cloth_sim
