#pragma once
/// \file The kinds of springs and what distinguishes them, in one table.

#include <array>
#include <cstddef>
#include <cstdint>

namespace cloth_sim {

/// Kinds of springs, as numbered in messages, bags and saved states.
enum class SpringKind : std::uint8_t { kStructural, kShear, kBend };

/// Properties of one kind of spring.
struct SpringKindTraits {
  SpringKind kind;
  const char* name;     ///< in scene files, summaries and messages
  bool isMembrane;      ///< its stretch counts as strain of the cloth
  bool bridgesAVertex;  ///< it stands on the faces around one vertex instead of those on an edge
};

/// One row per kind, in the order of `SpringKind`. A new kind is an enumerator, a row here, its
/// stiffness in `SpringCalibration`, and the rule in `SpringNetwork` that says where it stands.
inline constexpr std::array kSpringKindTraits{
    SpringKindTraits{SpringKind::kStructural, "structural", true, false},
    SpringKindTraits{SpringKind::kShear, "shear", true, false},
    SpringKindTraits{SpringKind::kBend, "bend", false, true},
};
constexpr int kSpringKinds = static_cast<int>(kSpringKindTraits.size());

constexpr bool isInOrderOfSpringKind() {
  for (std::size_t k = 0; k < kSpringKindTraits.size(); ++k) {
    if (static_cast<std::size_t>(kSpringKindTraits[k].kind) != k) return false;
  }
  return true;
}
static_assert(isInOrderOfSpringKind(), "the table has one row per kind, in the order of the kinds");

constexpr const SpringKindTraits& traitsOf(SpringKind kind) {
  return kSpringKindTraits[static_cast<std::size_t>(kind)];
}

/// The name of a kind: "structural", "shear" or "bend".
constexpr const char* toString(SpringKind kind) { return traitsOf(kind).name; }

}  // namespace cloth_sim
