#pragma once
/// \file Search for springs that exceed their length limits, repeated every substep.

#include <limits>
#include <vector>

#include "cloth_sim/cloth/spring.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// Springs with a length limit each, and the search for those that exceed it.
///
/// Most springs are far from their limits, so the search works with a list of candidates, as Verlet
/// (1967) does for particles that may come within the range of a force. A candidate is a spring
/// whose length is within twice the slack of its limit. As long as no particle has moved by more
/// than the slack relative to the others, no other spring can have reached its limit. When one has,
/// all springs are checked and the list is made again.
class SpringLengthMonitor {
 public:
  bool empty() const { return springs_.empty(); }
  std::size_t size() const { return springs_.size(); }
  void clear();
  void reserve(std::size_t springs);
  /// Appends a spring.
  /// \param limit  length that it must exceed to be found [m].
  void add(const Spring& spring, double limit);
  /// Appends an entry that is never found.
  void addUnlimited() { springs_.push_back({0, 0, kUnlimited}); }

  /// Replaces the k-th spring.
  void replace(std::int32_t k, const Spring& spring, double limit);
  /// Replaces the k-th spring by an entry that is never found.
  void remove(std::int32_t k) { springs_[static_cast<std::size_t>(k)] = {0, 0, kUnlimited}; }
  /// Notes a particle that an edit moved or created. The caller makes all of its springs candidates
  /// with `addCandidate`, `replace` or `add`.
  void noteEdited(VertexId v) { edited_.push_back(v); }
  /// Makes the k-th spring a candidate until all springs are checked again.
  void addCandidate(std::int32_t k);

  /// Returns the indices of the springs that exceed their limits, ascending; valid until the next
  /// call.
  /// \param x  positions, (vertexCount,) [m].
  const std::vector<std::int32_t>& find(const VertexData<Vec3>& x);

 private:
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  struct LimitedSpring {
    VertexId a = kNone;
    VertexId b = kNone;
    double limit = 0.0;  ///< [m]
  };

  void updateCandidates(const VertexData<Vec3>& x);
  bool haveMoved(const VertexData<Vec3>& x) const;
  void checkAll(const VertexData<Vec3>& x);

  std::vector<LimitedSpring> springs_;
  double margins_ = 0.0;       ///< sum of limit minus rest length over all limited springs [m]
  std::int64_t limited_ = 0;   ///< number of springs with a limit
  double slack_ = 0.0;         ///< displacement of a particle from which all are checked again [m]
  std::vector<Vec3> checked_;  ///< positions at which all springs were checked [m]
  std::vector<char> isCandidate_;         ///< by spring
  std::vector<std::int32_t> candidates_;  ///< indices of the candidates
  bool isSorted_ = true;                  ///< candidates_ are ascending
  std::vector<VertexId> edited_;          ///< particles to be taken over into checked_
  std::vector<std::int32_t> found_;
};

}  // namespace cloth_sim
