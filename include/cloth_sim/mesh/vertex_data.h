#pragma once
/// \file Data per vertex that is updated with the edits of its mesh.

#include <stdexcept>
#include <utility>

#include "cloth_sim/mesh/mesh_changes.h"

namespace cloth_sim {

/// One value per vertex, with the revision of the mesh that it belongs to: after a forgotten
/// `applyChanges`, the next one throws instead of working on stale values.
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

  /// Copies, interpolates and removes values as the vertex edits say.
  /// \throws std::logic_error if `changes` does not start from the revision of this data.
  void applyChanges(const MeshChanges& changes) {
    if (changes.fromRevision != revision_) {
      throw std::logic_error("vertex data is at another mesh revision than the changes start from");
    }
    for (const VertexEdit& edit : changes.vertices) apply(edit);
    revision_ = changes.toRevision;
  }

  /// Applies a single vertex edit, without changing the revision.
  void apply(const VertexEdit& edit) {
    switch (edit.kind) {
      case VertexEdit::Kind::kCopy:
      case VertexEdit::Kind::kInsert:
        values_.push_back(blend(edit));
        break;
      case VertexEdit::Kind::kMove:
        (*this)[edit.id] = blend(edit);
        break;
      case VertexEdit::Kind::kRemove:
        (*this)[edit.id] = T((*this)[edit.from[0]]);
        values_.pop_back();
        break;
    }
  }

 private:
  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(values_, revision_);
  }

  /// Returns the weighted sum that an edit names.
  T blend(const VertexEdit& edit) const {
    if (edit.from[1] == kNone) return (*this)[edit.from[0]];
    T sum = (*this)[edit.from[0]] * edit.weight[0];
    for (std::size_t k = 1; k < edit.from.size() && edit.from[k] != kNone; ++k) {
      sum += (*this)[edit.from[k]] * edit.weight[k];
    }
    return sum;
  }

  std::vector<T> values_;
  std::uint64_t revision_ = 0;
};

}  // namespace cloth_sim
