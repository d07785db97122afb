#include "bend_matrix.h"

#include <algorithm>
#include <cmath>

#include "support/simd.h"
#include "support/vector_clones.h"
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

/// Products of consecutive rows whose entries are the same but for a shift of their columns.
struct BendMatrix::Kernel {
  struct Rows {
    std::size_t first;           ///< row
    std::size_t count;           ///< of rows
    std::size_t entries;         ///< of a row
    const std::int32_t* column;  ///< of the entries of the first row
    const double* value;
  };

  /// The rows [begin, end) of one run.
  static Rows rowsOf(const BendMatrix& matrix, std::int32_t begin, std::int32_t end) {
    const auto first = static_cast<std::size_t>(begin);
    const std::size_t entry = matrix.start_[first];
    return {first, static_cast<std::size_t>(end - begin), matrix.start_[first + 1] - entry,
            matrix.column_.data() + entry, matrix.value_.data() + entry};
  }

  static constexpr std::size_t kBlock = 2 * kLanes;  ///< rows at a time
  /// Products of rows with one coordinate.
  struct Block {
    Lanes low{}, high{};
    [[gnu::always_inline]] void add(double value, const double* y) {
      low += value * lanesAt(y);
      high += value * lanesAt(y + kLanes);
    }
    [[gnu::always_inline]] double at(std::size_t k) const {
      return k < kLanes ? low[k] : high[k - kLanes];
    }
  };

  /// Products of `kBlock` rows, from the row `shift` of the run on.
  [[gnu::always_inline]] static void multiply(const Rows& rows, std::size_t shift, ConstAxes y,
                                              Block& ofX, Block& ofY, Block& ofZ) {
    for (std::size_t k = 0; k < rows.entries; ++k) {
      const std::size_t column = static_cast<std::size_t>(rows.column[k]) + shift;
      const double value = rows.value[k];
      ofX.add(value, y.x + column);
      ofY.add(value, y.y + column);
      ofZ.add(value, y.z + column);
    }
  }
  [[gnu::always_inline]] static Vec3 multiplyOne(const Rows& rows, std::size_t shift, ConstAxes y) {
    double ofX = 0.0, ofY = 0.0, ofZ = 0.0;
    for (std::size_t k = 0; k < rows.entries; ++k) {
      const std::size_t column = static_cast<std::size_t>(rows.column[k]) + shift;
      ofX += rows.value[k] * y.x[column];
      ofY += rows.value[k] * y.y[column];
      ofZ += rows.value[k] * y.z[column];
    }
    return Vec3(ofX, ofY, ofZ);
  }
  /// Products of all rows. The last block of a run overlaps the one before it.
  /// \param putFour  putFour(row, of x, of y, of z) takes the products of four rows.
  /// \param putOne   the same of one row.
  template <typename PutFour, typename PutOne>
  [[gnu::always_inline]] static void multiplyAll(const Rows& rows, ConstAxes y,
                                                 const PutFour& putFour, const PutOne& putOne) {
    std::size_t e = 0;
    for (; e + kBlock <= rows.count; e += kBlock) {
      Block ofX, ofY, ofZ;
      multiply(rows, e, y, ofX, ofY, ofZ);
      putFour(rows.first + e, ofX.low, ofY.low, ofZ.low);
      putFour(rows.first + e + kLanes, ofX.high, ofY.high, ofZ.high);
    }
    if (e == rows.count) return;
    if (e > 0) {
      const std::size_t last = rows.count - kBlock;
      Block ofX, ofY, ofZ;
      multiply(rows, last, y, ofX, ofY, ofZ);
      for (; e < rows.count; ++e) {
        putOne(rows.first + e, ofX.at(e - last), ofY.at(e - last), ofZ.at(e - last));
      }
    }
    for (; e < rows.count; ++e) {
      const Vec3 of = multiplyOne(rows, e, y);
      putOne(rows.first + e, of.x(), of.y(), of.z());
    }
  }

  CLOTH_SIM_VECTOR_CLONES
  static void addProduct(const Rows& rows, double s, ConstAxes y, Axes out) {
    multiplyAll(
        rows, y,
        [&](std::size_t row, const Lanes& ofX, const Lanes& ofY, const Lanes& ofZ) {
          lanesAt(out.x + row) += s * ofX;
          lanesAt(out.y + row) += s * ofY;
          lanesAt(out.z + row) += s * ofZ;
        },
        [&](std::size_t row, double ofX, double ofY, double ofZ) {
          out.x[row] += s * ofX;
          out.y[row] += s * ofY;
          out.z[row] += s * ofZ;
        });
  }
  /// out = next(x - s W K y, y, out), one coordinate after the other.
  template <typename Next>
  [[gnu::always_inline]] static void move(const Rows& rows, double s, const double* w, ConstAxes y,
                                          ConstAxes x, Axes out, const Next& next) {
    multiplyAll(
        rows, y,
        [&](std::size_t row, const Lanes& ofX, const Lanes& ofY, const Lanes& ofZ) {
          const Lanes scale = s * lanesAt(w + row);
          const auto put = [&](const double* from, const Lanes& of, const double* at, double* to) {
            lanesAt(to + row) =
                next(lanesAt(from + row) - scale * of, lanesAt(at + row), lanesAt(to + row));
          };
          put(x.x, ofX, y.x, out.x);
          put(x.y, ofY, y.y, out.y);
          put(x.z, ofZ, y.z, out.z);
        },
        [&](std::size_t row, double ofX, double ofY, double ofZ) {
          const double scale = s * w[row];
          out.x[row] = next(x.x[row] - scale * ofX, y.x[row], out.x[row]);
          out.y[row] = next(x.y[row] - scale * ofY, y.y[row], out.y[row]);
          out.z[row] = next(x.z[row] - scale * ofZ, y.z[row], out.z[row]);
        });
  }
  CLOTH_SIM_VECTOR_CLONES
  static void displace(const Rows& rows, double s, const double* w, ConstAxes y, ConstAxes x,
                       Axes moved) {
    move(rows, s, w, y, x, moved,
         [](const auto& displaced, const auto& /*y*/, const auto& /*moved*/) { return displaced; });
  }
  CLOTH_SIM_VECTOR_CLONES
  static void recur(const Rows& rows, double s, const double* w, ConstAxes y, ConstAxes x,
                    const ImpulsePolynomial::Step& step, Axes before) {
    move(rows, s, w, y, x, before,
         [&](const auto& residual, const auto& current, const auto& last) {
           return step.residual * residual + step.current * current - step.before * last;
         });
  }
};

void BendMatrix::build(const Model& model, const Particles& particles) {
  build(model, particles, [](std::size_t /*e*/) { return true; });
}

void BendMatrix::build(const Model& model, const Particles& particles,
                       const std::function<bool(std::size_t)>& isIn) {
  retardation_ = model.bendRetardation();
  buildWith(model, particles,
            [&](std::size_t e) { return isIn(e) ? model.bending.elements()[e].stiffness : 0.0; });
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
  findRuns();
}

void BendMatrix::findRuns() {
  firstOfRun_.assign(1, 0);
  const std::size_t rows = start_.size() - 1;
  for (std::size_t row = 1; row < rows; ++row) {
    if (!continues(row)) firstOfRun_.push_back(static_cast<std::int32_t>(row));
  }
  firstOfRun_.push_back(static_cast<std::int32_t>(rows));
}

/// Tells whether a row is the one before it, with all columns shifted by one.
bool BendMatrix::continues(std::size_t row) const {
  const std::size_t begin = start_[row], end = start_[row + 1], before = start_[row - 1];
  if (end - begin != begin - before) return false;
  for (std::size_t k = 0; k < end - begin; ++k) {
    if (column_[begin + k] != column_[before + k] + 1) return false;
    if (value_[begin + k] != value_[before + k]) return false;
  }
  return true;
}

template <typename Visit>
void BendMatrix::forRuns(const Visit& visit) const {
  parallelFor(firstOfRun_.back(), kGrainRows, [&](std::int32_t first, std::int32_t last) {
    auto run = std::upper_bound(firstOfRun_.begin(), firstOfRun_.end(), first) - 1;
    for (std::int32_t row = first; row < last; ++run) {
      const std::int32_t end = std::min(last, run[1]);
      visit(Kernel::rowsOf(*this, row, end));
      row = end;
    }
  });
}

void BendMatrix::addProduct(double s, const VectorArray& x, VectorArray& out) const {
  if (empty()) return;
  forRuns(
      [&](const Kernel::Rows& rows) { Kernel::addProduct(rows, s, axesAt(x, 0), axesAt(out, 0)); });
}

void BendMatrix::displace(double s, const ScalarArray& w, const VectorArray& y,
                          const VectorArray& x, VectorArray& moved) const {
  forRuns([&](const Kernel::Rows& rows) {
    Kernel::displace(rows, s, w.data(), axesAt(y, 0), axesAt(x, 0), axesAt(moved, 0));
  });
}

void BendMatrix::recur(double s, const ScalarArray& w, const VectorArray& y, const VectorArray& x,
                       const ImpulsePolynomial::Step& step, VectorArray& before) const {
  forRuns([&](const Kernel::Rows& rows) {
    Kernel::recur(rows, s, w.data(), axesAt(y, 0), axesAt(x, 0), step, axesAt(before, 0));
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

Vec3 BendMatrix::rowProduct(std::size_t row, const VectorArray& y) const {
  const auto k = static_cast<std::int32_t>(row);
  return Kernel::multiplyOne(Kernel::rowsOf(*this, k, k + 1), 0, axesAt(y, 0));
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
