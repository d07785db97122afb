#pragma once
/// \file What it takes to write parts of a simulation to bytes and to read them back: cereal's
/// portable binary archives, and how they deal with Eigen's types. For .cpp files.
///
/// A type has one function `serialize` that lists what is to be kept; it serves both ways, so they
/// cannot differ. What the scene or other members say is left out and made anew after reading.

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

/// A list of what has no default: on reading, items are copies of `blank` first.
template <class Archive, typename T>
void serializeItems(Archive& archive, std::vector<T>& items, const T& blank) {
  std::uint64_t count = items.size();
  archive(count);
  items.resize(count, blank);
  for (T& item : items) archive(item);
}

}  // namespace cloth_sim
