#include "bend_matrix.h"

#include <algorithm>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

constexpr std::int32_t kGrainRows = 1024;

/// Elements of each particle slot, in ascending order.
struct Incidence {
  std::vector<std::size_t> start;
  std::vector<std::size_t> element;
};

Incidence incidence(const PlateBending& bending, const Particles& particles) {
  Incidence result;
  result.start.assign(static_cast<std::size_t>(particles.slots) + 1, 0);
  const auto forAll = [&](const auto& visit) {
    for (std::size_t e = 0; e < bending.elements().size(); ++e) {
      const PlateElement& element = bending.elements()[e];
      for (int k = 0; k < element.count; ++k) {
        const VertexId v = element.vertex[static_cast<std::size_t>(k)];
        visit(e, static_cast<std::size_t>(particles.slotOf[v]));
      }
    }
  };
  forAll([&](std::size_t /*e*/, std::size_t slot) { ++result.start[slot + 1]; });
  for (std::size_t k = 1; k < result.start.size(); ++k) result.start[k] += result.start[k - 1];
  result.element.resize(result.start.back());
  std::vector<std::size_t> next(result.start.begin(), result.start.end() - 1);
  forAll([&](std::size_t e, std::size_t slot) { result.element[next[slot]++] = e; });
  return result;
}

/// The weight of a particle in an element [1/m^2], or 0 if it is not one of the element's.
double weightOf(const PlateElement& element, const Particles& particles, std::size_t slot) {
  double weight = 0.0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(element.count); ++j) {
    const bool isOwn = static_cast<std::size_t>(particles.slotOf[element.vertex[j]]) == slot;
    if (isOwn) weight = element.weight[j];
  }
  return weight;
}

}  // namespace

void BendMatrix::build(const Model& model, const Particles& particles) {
  retardation_ = model.bendRetardation();
  buildWith(model, particles, [&](std::size_t e) { return model.bending.elements()[e].stiffness; });
}

void BendMatrix::buildSlip(const Model& model, const Particles& particles) {
  retardation_ = 0.0;
  buildWith(model, particles, [&](std::size_t e) {
    return model.bending.slipStiffness(static_cast<FaceId>(e / PlateBending::kPerFace));
  });
}

template <typename Stiffness>
void BendMatrix::buildWith(const Model& model, const Particles& particles,
                           const Stiffness& stiffness) {
  const PlateBending& bending = model.bending;
  const auto slots = static_cast<std::size_t>(particles.slots);
  const Incidence incident = incidence(bending, particles);
  start_.assign(1, 0);
  column_.clear();
  value_.clear();
  diagonal_.assign(slots, 0.0);
  std::vector<double> row(slots, 0.0);
  std::vector<std::int32_t> columns;
  for (std::size_t slot = 0; slot < slots; ++slot) {
    columns.clear();
    for (std::size_t k = incident.start[slot]; k < incident.start[slot + 1]; ++k) {
      const PlateElement& element = bending.elements()[incident.element[k]];
      const auto count = static_cast<std::size_t>(element.count);
      const double own = weightOf(element, particles, slot);
      for (std::size_t j = 0; j < count; ++j) {
        const std::int32_t column = particles.slotOf[element.vertex[j]];
        columns.push_back(column);
        row[static_cast<std::size_t>(column)] +=
            stiffness(incident.element[k]) * (own * element.weight[j]);
      }
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    for (const std::int32_t column : columns) {
      const auto c = static_cast<std::size_t>(column);
      if (c == slot) diagonal_[slot] = row[c];
      if (row[c] != 0.0) {
        column_.push_back(column);
        value_.push_back(row[c]);
      }
      row[c] = 0.0;
    }
    start_.push_back(column_.size());
  }
}

void BendMatrix::addProduct(double s, const VectorArray& x, VectorArray& out) const {
  if (empty()) return;
  const auto rows = static_cast<std::int32_t>(start_.size() - 1);
  parallelFor(rows, kGrainRows, [&](std::int32_t first, std::int32_t last) {
    for (auto row = static_cast<std::size_t>(first); row < static_cast<std::size_t>(last); ++row) {
      double sx = 0.0;
      double sy = 0.0;
      double sz = 0.0;
      for (std::size_t k = start_[row]; k < start_[row + 1]; ++k) {
        const auto c = static_cast<std::size_t>(column_[k]);
        sx += value_[k] * x.x[c];
        sy += value_[k] * x.y[c];
        sz += value_[k] * x.z[c];
      }
      out.x[row] += s * sx;
      out.y[row] += s * sy;
      out.z[row] += s * sz;
    }
  });
}

void BendMatrix::addForces(const VectorArray& x, const VectorArray& v, VectorArray& force) const {
  addProduct(-1.0, x, force);
  if (retardation_ > 0.0) addProduct(-retardation_, v, force);
}

void BendMatrix::addForce(std::size_t slot, const VectorArray& x, const VectorArray& v,
                          VectorArray& force) const {
  if (slot + 1 >= start_.size()) return;
  Vec3 sum = rowProduct(slot, x);
  if (retardation_ > 0.0) sum += retardation_ * rowProduct(slot, v);
  force.set(slot, force.at(slot) - sum);
}

Vec3 BendMatrix::rowProduct(std::size_t row, const VectorArray& x) const {
  Vec3 product = Vec3::Zero();
  for (std::size_t k = start_[row]; k < start_[row + 1]; ++k) {
    product += value_[k] * x.at(static_cast<std::size_t>(column_[k]));
  }
  return product;
}

double BendMatrix::potential(const VectorArray& x, const VectorArray& v, double tau) const {
  const double viscous = retardation_ > 0.0 ? tau * retardation_ * quadraticForm(v) : 0.0;
  return 0.5 * (quadraticForm(x) + viscous);
}

double BendMatrix::quadraticForm(const VectorArray& x) const {
  double sum = 0.0;
  for (std::size_t row = 0; row + 1 < start_.size(); ++row) {
    sum += x.at(row).dot(rowProduct(row, x));
  }
  return sum;
}

}  // namespace cloth_sim
