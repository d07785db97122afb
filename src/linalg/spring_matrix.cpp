#include "spring_matrix.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

struct Axes {
  const double *x, *y, *z;
};
struct OutAxes {
  double *x, *y, *z;
};

Axes axesAt(const VectorArray& v, std::int32_t k) {
  return {v.x.data() + k, v.y.data() + k, v.z.data() + k};
}
OutAxes axesAt(VectorArray& v, std::int32_t k) {
  return {v.x.data() + k, v.y.data() + k, v.z.data() + k};
}

CLOTH_SIM_VECTOR_CLONES
void multiplyRun(std::int32_t count, const Axes& n, const double* along, const double* across,
                 const Axes& pa, const Axes& pb, const OutAxes& qa, const OutAxes& qb) {
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const double dx = pa.x[k] - pb.x[k];
    const double dy = pa.y[k] - pb.y[k];
    const double dz = pa.z[k] - pb.z[k];
    const double s = along[k] * (n.x[k] * dx + n.y[k] * dy + n.z[k] * dz);
    const double fx = across[k] * dx + s * n.x[k];
    const double fy = across[k] * dy + s * n.y[k];
    const double fz = across[k] * dz + s * n.z[k];
    qa.x[k] += fx;
    qa.y[k] += fy;
    qa.z[k] += fz;
    qb.x[k] -= fx;
    qb.y[k] -= fy;
    qb.z[k] -= fz;
  }
}

CLOTH_SIM_VECTOR_CLONES
void scaleAxis(std::size_t n, const double* diagonal, const double* p, double* q) {
  for (std::size_t k = 0; k < n; ++k) q[k] = diagonal[k] * p[k];
}

CLOTH_SIM_VECTOR_CLONES
void maskAxis(std::size_t n, const double* diagonal, double* q) {
  for (std::size_t k = 0; k < n; ++k) q[k] = diagonal[k] > 0.0 ? q[k] : 0.0;
}

}  // namespace

void SpringMatrix::linearise(const Elements& elements, const VectorArray& x, double elastic,
                             double viscous, const ScalarArray& diagonal) {
  const SpringSchedule& schedule = elements.springs;
  bendScale_ = elastic + viscous * elements.bending.retardation();
  const auto count = static_cast<std::size_t>(schedule.size());
  direction_.resize(count);
  along_.resize(count);
  across_.resize(count);
  diagonal_ = diagonal;
  schedule.forEach([&](const SpringSchedule::Element& spring) {
    const auto p = static_cast<std::size_t>(spring.position);
    const Vec3 d =
        x.at(static_cast<std::size_t>(spring.b)) - x.at(static_cast<std::size_t>(spring.a));
    const double length = std::sqrt(d.squaredNorm() + kTinySquare);
    direction_.set(p, d / length);
    const double k = elastic * spring.parameters.stiffness;
    across_[p] = k * std::max(0.0, 1.0 - spring.parameters.restLength / length);
    along_[p] = k + viscous * spring.parameters.damping - across_[p];
  });
  factoriseBlocks(elements);
}

void SpringMatrix::factoriseBlocks(const Elements& elements) {
  const std::size_t n = diagonal_.size();
  blockDiagonal_.x = blockDiagonal_.y = blockDiagonal_.z = diagonal_;
  setZero(n, blockOffDiagonal_);
  elements.springs.forEach([&](const SpringSchedule::Element& spring) {
    const auto p = static_cast<std::size_t>(spring.position);
    const Vec3 u = direction_.at(p);
    const Vec3 squares = along_[p] * u.cwiseProduct(u) + Vec3::Constant(across_[p]);
    const Vec3 products = along_[p] * Vec3(u.x() * u.y(), u.y() * u.z(), u.x() * u.z());
    for (const std::int32_t end : {spring.a, spring.b}) {
      const auto k = static_cast<std::size_t>(end);
      blockDiagonal_.set(k, blockDiagonal_.at(k) + squares);
      blockOffDiagonal_.set(k, blockOffDiagonal_.at(k) + products);
    }
  });
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 d = blockDiagonal_.at(k) + Vec3::Constant(bendScale_ * elements.bending.diagonal(k));
    const Vec3 o = blockOffDiagonal_.at(k);
    if (diagonal_[k] <= 0.0) continue;
    Eigen::Matrix3d block;
    block << d.x(), o.x(), o.z(), o.x(), d.y(), o.y(), o.z(), o.y(), d.z();
    const Eigen::Matrix3d inverse = block.inverse();
    blockDiagonal_.set(k, inverse.diagonal());
    blockOffDiagonal_.set(k, Vec3(inverse(0, 1), inverse(1, 2), inverse(0, 2)));
  }
}

void SpringMatrix::multiply(const Elements& elements, const VectorArray& p, VectorArray& q) const {
  const std::size_t n = diagonal_.size();
  q.resize(n);
  forAxes(
      [&](const auto& from, auto& to) { scaleAxis(n, diagonal_.data(), from.data(), to.data()); },
      p, q);
  const auto run = [&](std::int32_t first, std::int32_t count, std::int32_t a, std::int32_t b) {
    multiplyRun(count, axesAt(direction_, first), along_.data() + first, across_.data() + first,
                axesAt(p, a), axesAt(p, b), axesAt(q, a), axesAt(q, b));
  };
  elements.springs.sweep(
      [&](const SpringSchedule::Span& span) {
        run(span.first, span.count, span.ends.a, span.ends.b);
      },
      [&](const SpringSchedule::Element& spring) { run(spring.position, 1, spring.a, spring.b); });
  elements.bending.addProduct(bendScale_, p, q);
  forAxes([&](auto& axis) { maskAxis(n, diagonal_.data(), axis.data()); }, q);
}

void SpringMatrix::precondition(const VectorArray& r, VectorArray& z) const {
  const std::size_t n = diagonal_.size();
  z.resize(n);
  const VectorArray& d = blockDiagonal_;
  const VectorArray& o = blockOffDiagonal_;
  for (std::size_t k = 0; k < n; ++k) {
    const double keep = diagonal_[k] > 0.0 ? 1.0 : 0.0;
    z.x[k] = keep * (d.x[k] * r.x[k] + o.x[k] * r.y[k] + o.z[k] * r.z[k]);
    z.y[k] = keep * (o.x[k] * r.x[k] + d.y[k] * r.y[k] + o.y[k] * r.z[k]);
    z.z[k] = keep * (o.z[k] * r.x[k] + o.y[k] * r.y[k] + d.z[k] * r.z[k]);
  }
}

int SpringMatrix::solve(const Elements& elements, const VectorArray& r, double tolerance,
                        int maxIterations, VectorArray& p) {
  setZero(diagonal_.size(), p);
  residual_ = r;
  precondition(residual_, preconditioned_);
  search_ = preconditioned_;
  double rz = dot(residual_, preconditioned_);
  const double enough = tolerance * tolerance * dot(r, r);
  for (int k = 1; k <= maxIterations; ++k) {
    multiply(elements, search_, product_);
    const double curvature = dot(search_, product_);
    if (!(curvature > 0.0)) return k;
    const double step = rz / curvature;
    addScaled(step, search_, p);
    addScaled(-step, product_, residual_);
    if (dot(residual_, residual_) <= enough) return k;
    precondition(residual_, preconditioned_);
    const double next = dot(residual_, preconditioned_);
    setSum(preconditioned_, next / rz, search_, search_);
    rz = next;
  }
  return maxIterations;
}

}  // namespace cloth_sim
