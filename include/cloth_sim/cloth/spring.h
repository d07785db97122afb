#pragma once
/// \file A spring, and many of them in little memory.

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

enum class SpringKind : std::uint8_t { kStructural, kShear, kBend };
constexpr int kSpringKinds = 3;
/// "structural", "shear" or "bend".
const char* toString(SpringKind kind);

/// Direction of a spring in the weave.
enum class ThreadDirection : std::uint8_t { kWarp, kWeft, kBias };

/// How a spring pulls: f = -(k (l - l0) + c dl/dt).
struct SpringParameters {
  double restLength = 0.0;  ///< l0 [m]
  double stiffness = 0.0;   ///< k [N/m]
  double damping = 0.0;     ///< c [N s/m]

  bool operator==(const SpringParameters& other) const {
    return restLength == other.restLength && stiffness == other.stiffness &&
           damping == other.damping;
  }
};

struct Spring {
  VertexId a = kNone;
  VertexId b = kNone;
  SpringKind kind = SpringKind::kStructural;
  ThreadDirection direction = ThreadDirection::kWarp;
  /// The vertices whose faces the spring stands on: its own ends if it is a mesh edge, the ends of
  /// the edge that it crosses, or (bend) the vertex that it bridges and kNone.
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

/// A spring that must not be longer.
struct LengthLimit {
  VertexId a = kNone;
  VertexId b = kNone;
  double length = 0.0;  ///< [m]
};

/// Springs in slots. What many of them have in common, as on a grid, is there once: a slot takes 20
/// bytes, and 32 more for every kind of spring that no other one is of.
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
  /// What slots take their springs from; at least as many as there are different ones.
  std::size_t typeCount() const { return makes_.size() - unused_.size(); }
  Spring operator[](std::int32_t slot) const {
    const Slot& at = slots_[static_cast<std::size_t>(slot)];
    if (at.make == kNone) return {};
    const Make& make = makes_[static_cast<std::size_t>(at.make)];
    const SpringParameters& p = make.parameters;
    return {at.a,       at.b,         make.kind,   make.direction,
            at.support, p.restLength, p.stiffness, p.damping};
  }
  const_iterator begin() const { return {*this, 0}; }
  const_iterator end() const { return {*this, static_cast<std::int32_t>(size())}; }
  operator std::vector<Spring>() const { return {begin(), end()}; }

  void reserve(std::size_t slots) { slots_.reserve(slots); }
  void append(const Spring& spring);
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
  /// What springs may have in common.
  struct Make {
    SpringParameters parameters;
    SpringKind kind;
    ThreadDirection direction;
    std::int32_t springs;  ///< that are of it
  };
  struct Slot {
    VertexId a = kNone;
    VertexId b = kNone;
    std::array<VertexId, 2> support{kNone, kNone};
    std::int32_t make = kNone;
  };
  std::int32_t enter(const Spring& spring);
  void leave(std::int32_t make);

  std::vector<Slot> slots_;
  std::vector<Make> makes_;
  std::vector<std::int32_t> unused_;  ///< makes that no spring is of
  std::vector<std::int32_t> known_;   ///< a make that was entered lately, or kNone, by its hash
};

}  // namespace cloth_sim
