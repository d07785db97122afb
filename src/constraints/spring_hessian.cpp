#include "spring_hessian.h"

#include <algorithm>
#include <cmath>

#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Products of springs whose ends are consecutive; arrays begin at the first spring.
CLOTH_SIM_VECTOR_CLONES
void addSpanProduct(std::int32_t count, const ConstAxes& n, const double* along,
                    const double* across, const ConstAxes& pa, const ConstAxes& pb, const Axes& qa,
                    const Axes& qb) {
  CLOTH_SIM_NO_ALIAS_LOOP
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

}  // namespace

void SpringHessian::linearise(const SpringSchedule& schedule, const VectorArray& x, double elastic,
                              double viscous) {
  const auto count = static_cast<std::size_t>(schedule.size());
  direction_.resize(count);
  along_.resize(count);
  across_.resize(count);
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
}

void SpringHessian::addProduct(const SpringSchedule& schedule, const VectorArray& p,
                               VectorArray& q) const {
  const auto add = [&](std::int32_t position, std::int32_t count, const SpringEnds& ends) {
    addSpanProduct(count, axesAt(direction_, position), along_.data() + position,
                   across_.data() + position, axesAt(p, ends.a), axesAt(p, ends.b),
                   axesAt(q, ends.a), axesAt(q, ends.b));
  };
  schedule.sweep([&](const SpringSchedule::Span& span) { add(span.first, span.count, span.ends); },
                 [&](const SpringSchedule::Element& spring) {
                   add(spring.position, 1, {spring.a, spring.b});
                 });
}

void SpringHessian::addDiagonalBlocks(const SpringSchedule& schedule,
                                      SymmetricBlocks& blocks) const {
  schedule.forEach([&](const SpringSchedule::Element& spring) {
    const auto p = static_cast<std::size_t>(spring.position);
    const Vec3 n = direction_.at(p);
    const Vec3 squares = along_[p] * n.cwiseProduct(n) + Vec3::Constant(across_[p]);
    const Vec3 products = along_[p] * Vec3(n.x() * n.y(), n.y() * n.z(), n.x() * n.z());
    blocks.add(static_cast<std::size_t>(spring.a), squares, products);
    blocks.add(static_cast<std::size_t>(spring.b), squares, products);
  });
}

}  // namespace cloth_sim
