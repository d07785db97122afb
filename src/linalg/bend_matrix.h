#pragma once
/// \file The stiffness matrix of a bending energy.

#include <functional>

#include "cloth_sim/cloth/model.h"
#include "constraints/particles.h"
#include "impulse_polynomial.h"

namespace cloth_sim {

/// K of the energy 1/2 x^T K x of a PlateBending: one row per particle slot, the same for the three
/// coordinates, in compressed rows. Constant until the model changes.
///
/// On a grid most rows are equal but for a shift of their columns. Such consecutive rows are a run,
/// whose product takes no gathers and several rows at a time.
class BendMatrix {
 public:
  void build(const Model& model, const Particles& particles);
  /// Builds the matrix of a part of the elements. \param isIn  isIn(e): the element e is of the
  /// part.
  void build(const Model& model, const Particles& particles,
             const std::function<bool(std::size_t)>& isIn);
  /// Builds the matrix with the stiffness of the slip elements instead of that of the elements: an
  /// upper bound on their stiffness, without the way in which normals of faces turn.
  void buildSlip(const Model& model, const Particles& particles);

  bool empty() const { return column_.empty(); }
  /// out += s K x, on several threads where that pays.
  void addProduct(double s, const VectorArray& x, VectorArray& out) const;
  /// moved = x - s W K y, on several threads where that pays: an impulse of bending.
  /// \param s      square of a time [s^2].
  /// \param w      the diagonal of W: inverse inertia by particle slot [1/kg]; 0: held.
  /// \param moved  neither `x` nor `y`; of the size of `x`.
  void displace(double s, const ScalarArray& w, const VectorArray& y, const VectorArray& x,
                VectorArray& moved) const;
  /// before = residual (x - s W K y) + current y - before `before`: a step of a recurrence, see
  /// ImpulsePolynomial.
  void recur(double s, const ScalarArray& w, const VectorArray& y, const VectorArray& x,
             const ImpulsePolynomial::Step& step, VectorArray& before) const;
  /// The sum of K y in one row.
  Vec3 rowProduct(std::size_t row, const VectorArray& y) const;
  /// force -= K (x + retardation v) [N].
  void addForces(const VectorArray& x, const VectorArray& v, VectorArray& force) const;
  /// Adds the force on the particle in one slot [N].
  void addForce(std::size_t slot, const VectorArray& x, const VectorArray& v,
                VectorArray& force) const;
  /// 1/2 x^T K x + tau/2 retardation v^T K v: see springPotential [J].
  double potential(const VectorArray& x, const VectorArray& v, double tau) const;
  double retardation() const { return retardation_; }
  /// The diagonal entry of a slot [N/m]; 0 if there is no bending energy.
  double diagonal(std::size_t slot) const {
    return slot < diagonal_.size() ? diagonal_[slot] : 0.0;
  }

  /// Calls `visit(row, column, value)` for every entry on and below the diagonal.
  template <typename Visit>
  void forLower(const Visit& visit) const {
    for (std::size_t row = 0; row + 1 < start_.size(); ++row) {
      for (std::size_t k = start_[row]; k < start_[row + 1]; ++k) {
        if (static_cast<std::size_t>(column_[k]) <= row) visit(row, column_[k], value_[k]);
      }
    }
  }

 private:
  /// \param stiffness  stiffness(e) of the element e [N m^3].
  template <typename Stiffness>
  void buildWith(const Model& model, const Particles& particles, const Stiffness& stiffness);
  void findRuns();
  bool continues(std::size_t row) const;
  /// Calls `visit(rows)` for runs, or parts of them, that together are all rows.
  template <typename Visit>
  void forRuns(const Visit& visit) const;
  double quadraticForm(const VectorArray& x) const;

  struct Kernel;

  std::vector<std::size_t> start_;  ///< by slot, and one more
  std::vector<std::int32_t> column_;
  std::vector<double> value_;  ///< [N/m]
  std::vector<double> diagonal_;
  std::vector<std::int32_t> firstOfRun_;  ///< row, ascending, and one more
  double retardation_ = 0.0;              ///< dashpot over stiffness [s]
};

}  // namespace cloth_sim
