// An updated factorisation, compared with a new one.
#include "linalg/updatable_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "sim/archive.h"

namespace cloth_sim {
namespace {

/// Point masses and springs; its matrix is that of a global step of projective dynamics.
struct Network {
  std::vector<double> mass;
  std::map<std::pair<int, int>, double> springs;  ///< by lower and higher end

  UpdatableFactor::Matrix matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k < mass.size(); ++k) entries.emplace_back(k, k, mass[k]);
    for (const auto& [ends, weight] : springs) {
      entries.emplace_back(ends.first, ends.first, weight);
      entries.emplace_back(ends.second, ends.second, weight);
      entries.emplace_back(ends.second, ends.first, -weight);
    }
    const auto n = static_cast<Eigen::Index>(mass.size());
    UpdatableFactor::Matrix result(n, n);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  void tie(int a, int b, double weight) { springs[{std::min(a, b), std::max(a, b)}] += weight; }
};

Network grid(int side) {
  Network network;
  network.mass.assign(static_cast<std::size_t>(side * side), 1.0);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const int k = row * side + column;
      if (column + 1 < side) network.tie(k, k + 1, 20.0);
      if (row + 1 < side) network.tie(k, k + side, 30.0);
      if (row + 1 < side && column + 1 < side) network.tie(k, k + side + 1, 5.0);
    }
  }
  return network;
}

VectorArray testVectors(std::size_t n) {
  VectorArray result;
  result.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto t = static_cast<double>(k);
    result.set(k, Vec3(std::sin(t), std::cos(3.0 * t), std::sin(7.0 * t) + 0.5));
  }
  return result;
}

/// Largest difference between L D L^T and the matrix, relative to its largest entry.
double factorError(const UpdatableFactor& factor, const UpdatableFactor::Matrix& matrix) {
  const SparseFactor& f = factor.factor();
  const auto n = static_cast<Eigen::Index>(f.size());
  Eigen::MatrixXd l = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const SparseFactor::Column& column = f.columns[static_cast<std::size_t>(j)];
    for (std::size_t k = column.begin; k < column.begin + column.count; ++k) {
      l(f.row[k], j) = f.value[k];
    }
  }
  const Eigen::Map<const Eigen::VectorXd> d(f.diagonal.data(), n);
  const Eigen::MatrixXd product = l * d.asDiagonal() * l.transpose();
  const Eigen::MatrixXd whole = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
  double error = 0.0;
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      const auto p = factor.permutation()[static_cast<std::size_t>(a)];
      const auto q = factor.permutation()[static_cast<std::size_t>(b)];
      error = std::max(error, std::abs(product(p, q) - whole(a, b)));
    }
  }
  return error / whole.cwiseAbs().maxCoeff();
}

/// Largest difference from the solution of a dense factorisation, relative to the largest
/// coordinate.
double solutionError(UpdatableFactor& factor, const UpdatableFactor::Matrix& matrix) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  const VectorArray right = testVectors(n);
  VectorArray x;
  factor.solve(right, x);
  Eigen::MatrixXd b(matrix.rows(), 3), got(matrix.rows(), 3);
  for (std::size_t k = 0; k < n; ++k) {
    b.row(static_cast<Eigen::Index>(k)) = right.at(k).transpose();
    got.row(static_cast<Eigen::Index>(k)) = x.at(k).transpose();
  }
  const Eigen::MatrixXd whole = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd expected = whole.llt().solve(b);
  return (got - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

/// Bound for rounding errors of a few hundred updates in double precision; matrices have at most
/// 300 rows, with entries between 1 and 100.
constexpr double kFactorTolerance = 1e-13;
/// Bound for solutions: single precision (6e-8) times the condition number of the matrices, about
/// 100.
constexpr double kSolutionTolerance = 1e-5;

TEST(UpdatableFactor, FactorisesAndSolves) {
  const UpdatableFactor::Matrix matrix = grid(9).matrix();
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(matrix));
  EXPECT_LT(factorError(factor, matrix), kFactorTolerance);
  EXPECT_LT(solutionError(factor, matrix), kSolutionTolerance);
}

TEST(UpdatableFactor, RejectsIndefiniteMatrices) {
  Network network = grid(4);
  network.mass[3] = -1e6;
  UpdatableFactor factor;
  EXPECT_FALSE(factor.compute(network.matrix()));
  network.mass[3] = std::nan("");
  EXPECT_FALSE(factor.compute(network.matrix()));
}

TEST(UpdatableFactor, UpdatesForRemovedSprings) {
  Network network = grid(15);
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(network.matrix()));
  for (int k = 0; k < 4; ++k) network.springs.erase({7 * 15 + k, 8 * 15 + k});
  ASSERT_TRUE(factor.tryUpdate(network.matrix()));
  EXPECT_LT(factorError(factor, network.matrix()), kFactorTolerance);
}

/// A tear: a new particle takes over three springs and part of the mass of an old one.
TEST(UpdatableFactor, UpdatesForASplitParticle) {
  Network network = grid(15);
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(network.matrix()));
  const int old = 7 * 15 + 7;
  const int fresh = static_cast<int>(network.mass.size());
  network.mass.push_back(0.4);
  network.mass[old] = 0.6;
  for (const int neighbour : {old + 1, old + 15, old + 16}) {
    network.tie(fresh, neighbour, network.springs.at({old, neighbour}));
    network.springs.erase({old, neighbour});
  }
  ASSERT_TRUE(factor.tryUpdate(network.matrix()));
  EXPECT_EQ(factor.rows(), network.mass.size());
  EXPECT_LT(factorError(factor, network.matrix()), kFactorTolerance);
}

/// A clamp: a large diagonal entry, which fixes a particle, is added and removed.
TEST(UpdatableFactor, UpdatesForAHeldAndReleasedParticle) {
  Network network = grid(15);
  const UpdatableFactor::Matrix before = network.matrix();
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(before));
  network.mass[100] += 1e8;
  ASSERT_TRUE(factor.tryUpdate(network.matrix()));
  EXPECT_LT(factorError(factor, network.matrix()), kFactorTolerance);
  ASSERT_TRUE(factor.tryUpdate(before));
  // The entry was a million times larger than the others: six of sixteen digits are lost.
  EXPECT_LT(factorError(factor, before), 1e-9);
}

/// Random changes of all kinds; the factor is checked after each update.
TEST(UpdatableFactor, UpdatesForManyChangesOfAllKinds) {
  Network network = grid(12);
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(network.matrix()));
  std::mt19937 random(7);
  const auto upTo = [&](std::size_t n) {
    return static_cast<int>(random() % static_cast<unsigned>(n));
  };
  int updated = 0;
  for (int round = 0; round < 60; ++round) {
    for (int change = 0; change < 3; ++change) {
      const int a = upTo(network.mass.size());
      const int b = upTo(network.mass.size());
      switch (upTo(4)) {
        case 0:
          if (a != b) network.tie(a, b, 1.0 + upTo(50));
          break;
        case 1:
          network.springs.erase(std::next(network.springs.begin(), upTo(network.springs.size())));
          break;
        case 2:
          network.mass.push_back(0.5);
          network.tie(a, static_cast<int>(network.mass.size()) - 1, 10.0);
          break;
        default:
          network.mass[static_cast<std::size_t>(a)] *= 1.5;
      }
    }
    if (factor.tryUpdate(network.matrix())) {
      ++updated;
    } else {
      ASSERT_TRUE(factor.compute(network.matrix()));
    }
    ASSERT_LT(factorError(factor, network.matrix()), kFactorTolerance) << "round " << round;
    ASSERT_LT(solutionError(factor, network.matrix()), kSolutionTolerance) << "round " << round;
  }
  EXPECT_GT(updated, 30);
}

TEST(UpdatableFactor, AsksForANewFactorisationWhenAllEntriesChange) {
  Network network = grid(12);
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(network.matrix()));
  for (auto& [ends, weight] : network.springs) weight *= 2.0;
  EXPECT_FALSE(factor.tryUpdate(network.matrix()));
}

TEST(UpdatableFactor, ContinuesFromASavedState) {
  Network network = grid(12);
  UpdatableFactor factor;
  ASSERT_TRUE(factor.compute(network.matrix()));
  network.springs.erase({30, 31});
  ASSERT_TRUE(factor.tryUpdate(network.matrix()));
  std::stringstream file;
  StateWriter{file}(factor);
  UpdatableFactor loaded;
  StateReader{file.str()}(loaded);
  for (UpdatableFactor* one : {&factor, &loaded}) {
    network.springs.erase({30, 42});
    ASSERT_TRUE(one->tryUpdate(network.matrix()));
  }
  const VectorArray right = testVectors(network.mass.size());
  VectorArray x, y;
  factor.solve(right, x);
  loaded.solve(right, y);
  EXPECT_EQ(x.x, y.x);
  EXPECT_EQ(x.y, y.y);
  EXPECT_EQ(x.z, y.z);
}

}  // namespace
}  // namespace cloth_sim
