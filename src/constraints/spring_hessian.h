#pragma once
/// \file The linearised springs of implicit methods, as a matrix that is never assembled.

#include "linalg/block_jacobi.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// H = sum over springs of S^T (a n n^T + t (1 - n n^T)) S, where S p is the difference of p at the
/// ends and n the direction of the spring. A product is one sweep over the springs.
class SpringHessian {
 public:
  /// Linearises springs at positions x [m]: a = elastic k + viscous c - t along the spring and
  /// t = elastic k max(0, 1 - l0/l) in all directions. Without its negative part, t keeps H
  /// positive semidefinite where springs are compressed (Choi & Ko 2002, sec. 3).
  void linearise(const SpringSchedule& schedule, const VectorArray& x, double elastic,
                 double viscous);
  /// q += H p.
  void addProduct(const SpringSchedule& schedule, const VectorArray& p, VectorArray& q) const;
  /// Adds the 3 x 3 blocks on the diagonal of H.
  void addDiagonalBlocks(const SpringSchedule& schedule, SymmetricBlocks& blocks) const;

 private:
  // By position of the schedule:
  VectorArray direction_;       ///< n
  std::vector<double> along_;   ///< a
  std::vector<double> across_;  ///< t
};

}  // namespace cloth_sim
