#pragma once
/// \file Which of many springs are too long, asked step after step.

#include <limits>
#include <vector>

#include "cloth_sim/cloth/spring.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// Springs, each with the length from which it is long. Most are far from it: all of them are
/// looked at only when particles have moved against each other further than the slack. Until then
/// only those can have become long that were nearly so. (What Verlet 1967 does with neighbours in
/// a list that reaches further than their force.)
class SpringLengthMonitor {
 public:
  bool empty() const { return springs_.empty(); }
  std::size_t size() const { return springs_.size(); }
  void clear();
  void reserve(std::size_t springs);
  /// One more.
  /// \param length  from which it is long [m].
  void watch(const Spring& spring, double length);
  /// A spring that is never long.
  void watchNothing() { springs_.push_back({0, 0, kNever}); }

  /// Another spring in place of the k-th.
  void replace(std::int32_t k, const Spring& spring, double length);
  /// One that is never long in place of it.
  void remove(std::int32_t k) { springs_[static_cast<std::size_t>(k)] = {0, 0, kNever}; }
  /// Tells that a particle is elsewhere than its springs have taken it, or new. All springs at it
  /// have to be looked at: see `lookAt`, `replace` and `watch`.
  void put(VertexId v) { put_.push_back(v); }
  /// Makes sure that the k-th is looked at until all of them are.
  void lookAt(std::int32_t k);

  /// Those that are long, by their place, ascending.
  /// \param x  positions [m].
  const std::vector<std::int32_t>& find(const VertexData<Vec3>& x);

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  struct Watched {
    VertexId a = kNone;
    VertexId b = kNone;
    double length = 0.0;  ///< [m]
  };

  void settle(const VertexData<Vec3>& x);
  bool haveMoved(const VertexData<Vec3>& x) const;
  void lookAtAll(const VertexData<Vec3>& x);

  std::vector<Watched> springs_;
  double margins_ = 0.0;       ///< how much longer than at rest springs have to be, together [m]
  std::int64_t finite_ = 0;    ///< springs that may become long
  double slack_ = 0.0;         ///< how far a particle may move until all are looked at again [m]
  std::vector<Vec3> before_;   ///< where particles were when all were looked at
  std::vector<char> isClose_;  ///< by spring, for those that there were then
  std::vector<std::int32_t> close_;  ///< that may become long before all are looked at again
  bool isSorted_ = true;             ///< close_
  std::vector<VertexId> put_;
  std::vector<std::int32_t> long_;
};

}  // namespace cloth_sim
