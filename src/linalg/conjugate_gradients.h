#pragma once
/// \file Preconditioned conjugate gradients on arrays of 3-vectors.

#include "vector_operations.h"

namespace cloth_sim {

/// Solves A p = r for symmetric positive definite A (Hestenes & Stiefel 1952; Saad, Iterative
/// Methods for Sparse Linear Systems, alg. 9.1). Keeps its vectors from one solve to the next.
class ConjugateGradients {
 public:
  /// Bounds of a solve.
  struct Goal {
    double tolerance = 0.0;  ///< of |A p - r|, over |r|
    int maxIterations = 0;
  };

  /// Ends at its goal, in a direction in which A is not positive, or where it is stopped.
  /// \param multiply      multiply(p, q) sets q = A p.
  /// \param precondition  precondition(r, z) sets z = M^-1 r, M close to A.
  /// \param isStopped     whether the result is not wanted any more; asked once per iteration.
  /// \param p             out: the solution; the iteration begins with zero.
  /// \return iterations.
  template <typename Multiply, typename Precondition, typename IsStopped>
  int solve(const Multiply& multiply, const Precondition& precondition, const IsStopped& isStopped,
            const VectorArray& r, const Goal& goal, VectorArray& p) {
    setZero(r.x.size(), p);
    residual_ = r;
    precondition(residual_, preconditioned_);
    direction_ = preconditioned_;
    double rz = dot(residual_, preconditioned_);
    const double enough = goal.tolerance * goal.tolerance * dot(r, r);
    for (int k = 1; k <= goal.maxIterations; ++k) {
      multiply(direction_, product_);
      const double curvature = dot(direction_, product_);
      if (!(curvature > 0.0)) return k;
      const double step = rz / curvature;
      addScaled(step, direction_, p);
      addScaled(-step, product_, residual_);
      if (dot(residual_, residual_) <= enough || isStopped()) return k;
      precondition(residual_, preconditioned_);
      const double next = dot(residual_, preconditioned_);
      setSum(preconditioned_, next / rz, direction_, direction_);
      rz = next;
    }
    return goal.maxIterations;
  }

 private:
  VectorArray residual_, preconditioned_, direction_, product_;
};

}  // namespace cloth_sim
