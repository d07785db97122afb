#pragma once
/// \file A spring between two vertices, and compact storage for many of them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "cloth_sim/cloth/spring_kind.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Direction of a spring in the weave.
enum class ThreadDirection : std::uint8_t { kWarp, kWeft, kBias };
/// Classifies a direction in material coordinates: within 22.5 degrees of a thread it is that
/// thread's, else it is a bias direction.
ThreadDirection threadDirection(const Vec2& direction);

/// Parameters of a damped linear spring. Its force along the line between its ends is
/// f = -(k (l - l0) + c dl/dt).
struct SpringParameters {
  double restLength = 0.0;  ///< l0 [m]
  double stiffness = 0.0;   ///< k [N/m]
  double damping = 0.0;     ///< c [N s/m]

  bool operator==(const SpringParameters& other) const {
    return restLength == other.restLength && stiffness == other.stiffness &&
           damping == other.damping;
  }
};

/// A damped linear spring between two vertices.
struct Spring {
  VertexId a = kNone;
  VertexId b = kNone;
  SpringKind kind = SpringKind::kStructural;
  ThreadDirection direction = ThreadDirection::kWarp;
  /// The vertices whose faces the spring represents: its own ends if it is a mesh edge, the ends of
  /// the edge that it crosses if it is the other diagonal of a cell, and the vertex that it bridges
  /// and kNone if it is a bend spring.
  std::array<VertexId, 2> support{kNone, kNone};
  double restLength = 0.0;  ///< [m]
  double stiffness = 0.0;   ///< [N/m]
  double damping = 0.0;     ///< dashpot along the spring [N s/m]

  bool exists() const { return a != kNone; }
  SpringParameters parameters() const { return {restLength, stiffness, damping}; }
  bool operator==(const Spring& other) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(a, b, kind, direction, support, restLength, stiffness, damping);
  }
};

/// A length that the distance between two vertices must not exceed.
struct LengthLimit {
  VertexId a = kNone;
  VertexId b = kNone;
  double length = 0.0;  ///< [m]
};

/// Springs in numbered slots, stored compactly (the flyweight pattern). Springs with the same
/// parameters, kind and direction, as on a regular grid, share one `Type`. A slot takes 20 bytes,
/// and each type 32 more.
class SpringSlots {
 public:
  class const_iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Spring;
    using difference_type = std::ptrdiff_t;
    using pointer = const Spring*;
    using reference = Spring;

    const_iterator(const SpringSlots& slots, std::int32_t slot) : slots_(&slots), slot_(slot) {}
    Spring operator*() const { return (*slots_)[slot_]; }
    const_iterator& operator++() {
      ++slot_;
      return *this;
    }
    bool operator==(const const_iterator& other) const { return slot_ == other.slot_; }
    bool operator!=(const const_iterator& other) const { return slot_ != other.slot_; }

   private:
    const SpringSlots* slots_;
    std::int32_t slot_;
  };

  std::size_t size() const { return slots_.size(); }
  /// Number of types in use. It can exceed the number of distinct types: the search for an equal
  /// one is limited, see `acquireType`.
  std::size_t typeCount() const { return types_.size() - unused_.size(); }
  /// The spring in a slot; one that does not exist if the slot is empty.
  Spring operator[](std::int32_t slot) const {
    const Slot& at = slots_[static_cast<std::size_t>(slot)];
    if (at.type == kNone) return {};
    const Type& type = types_[static_cast<std::size_t>(at.type)];
    const SpringParameters& p = type.parameters;
    return {at.a,       at.b,         type.kind,   type.direction,
            at.support, p.restLength, p.stiffness, p.damping};
  }
  const_iterator begin() const { return {*this, 0}; }
  const_iterator end() const { return {*this, static_cast<std::int32_t>(size())}; }
  explicit operator std::vector<Spring>() const { return {begin(), end()}; }

  void reserve(std::size_t slots) { slots_.reserve(slots); }
  void append(const Spring& spring);
  /// Replaces the spring in a slot.
  /// \param spring  empties the slot if it does not exist.
  void set(std::int32_t slot, const Spring& spring);

  template <class Archive>
  void save(Archive& archive) const {
    archive(std::vector<Spring>(*this));
  }
  template <class Archive>
  void load(Archive& archive) {
    std::vector<Spring> springs;
    archive(springs);
    *this = SpringSlots();
    for (const Spring& spring : springs) append(spring);
  }

 private:
  /// The properties that springs can share.
  struct Type {
    SpringParameters parameters;
    SpringKind kind;
    ThreadDirection direction;
    std::int32_t users;  ///< number of springs of this type
  };
  /// The properties that each spring has for itself.
  struct Slot {
    VertexId a = kNone;
    VertexId b = kNone;
    std::array<VertexId, 2> support{kNone, kNone};
    std::int32_t type = kNone;  ///< index into types_
  };
  std::int32_t acquireType(const Spring& spring);
  void releaseType(std::int32_t type);

  std::vector<Slot> slots_;
  std::vector<Type> types_;
  std::vector<std::int32_t> unused_;  ///< indices of types without users
  /// Hash table of recently added types, with open addressing: indices into types_, or kNone.
  std::vector<std::int32_t> recent_;
};

}  // namespace cloth_sim
