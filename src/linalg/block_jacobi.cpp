#include "block_jacobi.h"

#include <Eigen/LU>

#include "vector_operations.h"

namespace cloth_sim {

SymmetricBlocks& BlockJacobi::reset(const ScalarArray& diagonal) {
  blocks_.diagonal.x = blocks_.diagonal.y = blocks_.diagonal.z = diagonal;
  setZero(diagonal.size(), blocks_.offDiagonal);
  return blocks_;
}

void BlockJacobi::invert(std::size_t slot, bool isAbsent) {
  const Vec3 d = blocks_.diagonal.at(slot);
  const Vec3 o = blocks_.offDiagonal.at(slot);
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  if (!isAbsent) {
    Eigen::Matrix3d block;
    block << d.x(), o.x(), o.z(), o.x(), d.y(), o.y(), o.z(), o.y(), d.z();
    inverse = block.inverse();
  }
  blocks_.diagonal.set(slot, inverse.diagonal());
  blocks_.offDiagonal.set(slot, Vec3(inverse(0, 1), inverse(1, 2), inverse(0, 2)));
}

void BlockJacobi::apply(const VectorArray& r, VectorArray& z) const {
  const std::size_t n = r.x.size();
  z.resize(n);
  const VectorArray& d = blocks_.diagonal;
  const VectorArray& o = blocks_.offDiagonal;
  for (std::size_t k = 0; k < n; ++k) {
    z.x[k] = d.x[k] * r.x[k] + o.x[k] * r.y[k] + o.z[k] * r.z[k];
    z.y[k] = o.x[k] * r.x[k] + d.y[k] * r.y[k] + o.y[k] * r.z[k];
    z.z[k] = o.z[k] * r.x[k] + o.y[k] * r.y[k] + d.z[k] * r.z[k];
  }
}

}  // namespace cloth_sim
