#pragma once
/// \file Symmetric 3 x 3 blocks on the diagonal of a matrix, and the preconditioner they make.

#include "vector_array.h"

namespace cloth_sim {

/// A symmetric 3 x 3 matrix for each particle slot.
struct SymmetricBlocks {
  VectorArray diagonal;     ///< xx, yy, zz
  VectorArray offDiagonal;  ///< xy, yz, xz

  /// Adds to the block of a slot.
  void add(std::size_t slot, const Vec3& squares, const Vec3& products) {
    diagonal.set(slot, diagonal.at(slot) + squares);
    offDiagonal.set(slot, offDiagonal.at(slot) + products);
  }
};

/// The block Jacobi preconditioner: z = B^-1 r, B the blocks on the diagonal.
class BlockJacobi {
 public:
  /// Sets every block to a multiple of the identity, and gives access to add to them.
  /// \param diagonal  by slot.
  SymmetricBlocks& reset(const ScalarArray& diagonal);
  /// Replaces the blocks by their inverses; a block with `isAbsent(slot)` by zero.
  template <typename IsAbsent>
  void factorise(const IsAbsent& isAbsent) {
    for (std::size_t k = 0; k < blocks_.diagonal.x.size(); ++k) invert(k, isAbsent(k));
  }
  void apply(const VectorArray& r, VectorArray& z) const;

 private:
  void invert(std::size_t slot, bool isAbsent);

  SymmetricBlocks blocks_;  ///< their inverses after `factorise`
};

}  // namespace cloth_sim
