#pragma once
/// \file Writes parts of a simulation to bytes and reads them back: cereal's portable binary
/// archives, and how they store Eigen's types. For .cpp files.
///
/// A type has one function `serialize` that lists the members to be stored; it serves writing and
/// reading, so the two cannot differ. Members that follow from the scene or from other members are
/// left out, and made anew after reading.

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/set.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>

#include "cloth_sim/types.h"

namespace Eigen {

template <class Archive>
void serialize(Archive& archive, Vector2d& v) {
  archive(v.x(), v.y());
}

template <class Archive>
void serialize(Archive& archive, Vector3d& v) {
  archive(v.x(), v.y(), v.z());
}

template <class Archive>
void serialize(Archive& archive, Quaterniond& q) {
  archive(q.x(), q.y(), q.z(), q.w());
}

}  // namespace Eigen

namespace cloth_sim {

using StateWriter = cereal::PortableBinaryOutputArchive;
using StateReader = cereal::PortableBinaryInputArchive;

/// Writes or reads a vector of a type without default constructor: on reading, its items are copies
/// of `blank` first.
/// \tparam Items  std::vector<T>; const if the archive writes.
template <class Archive, typename Items, typename T>
void serializeItems(Archive& archive, Items& items, const T& blank) {
  std::uint64_t count = items.size();
  archive(count);
  if constexpr (Archive::is_loading::value) items.resize(count, blank);
  for (auto& item : items) archive(item);
}

}  // namespace cloth_sim
