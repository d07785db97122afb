#pragma once
/// \file Per-vertex data that follows the edits of its mesh.

#include <stdexcept>
#include <utility>

#include "cloth_sim/mesh/mesh_changes.h"

namespace cloth_sim {

/// One value per vertex. It knows the mesh revision that it belongs to, so a forgotten `follow`
/// throws at the next one instead of leaving stale rows behind.
template <typename T>
class VertexData {
 public:
  VertexData() = default;
  VertexData(std::size_t size, const T& value, std::uint64_t revision = 0)
      : values_(size, value), revision_(revision) {}
  explicit VertexData(std::vector<T> values, std::uint64_t revision = 0)
      : values_(std::move(values)), revision_(revision) {}

  T& operator[](VertexId v) { return values_[static_cast<std::size_t>(v)]; }
  const T& operator[](VertexId v) const { return values_[static_cast<std::size_t>(v)]; }
  std::size_t size() const { return values_.size(); }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  const std::vector<T>& values() const { return values_; }
  std::uint64_t revision() const { return revision_; }

  /// Gives every new vertex the weighted sum of its sources' values (a copy for split vertices).
  /// \throws std::logic_error if `changes` does not start at this data's revision.
  void follow(const MeshChanges& changes) {
    if (changes.fromRevision != revision_) {
      throw std::logic_error("vertex data is at another mesh revision than the changes start from");
    }
    values_.reserve(values_.size() + changes.newVertices.size());
    for (const NewVertex& added : changes.newVertices) values_.push_back(blend(added));
    revision_ = changes.toRevision;
  }

 private:
  T blend(const NewVertex& added) const {
    const T& first = values_[static_cast<std::size_t>(added.from[0])];
    if (added.from[1] == kNone) return first;
    return static_cast<T>(first * added.weight[0] +
                          values_[static_cast<std::size_t>(added.from[1])] * added.weight[1]);
  }

  std::vector<T> values_;
  std::uint64_t revision_ = 0;
};

}  // namespace cloth_sim
