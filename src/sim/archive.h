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
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

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

/// Reads what a StateWriter wrote, from memory. What no writer can have written is refused at once,
/// with a cereal::Exception: a length that exceeds the rest of the bytes (before memory is taken
/// for it), a boolean that is neither 0 nor 1, a number that is not one. Whether the values make
/// sense together is for their owners to check (`validationError`).
class StateReader : public cereal::InputArchive<StateReader, cereal::AllowEmptyClassElision> {
 public:
  explicit StateReader(std::string bytes)
      : cereal::InputArchive<StateReader, cereal::AllowEmptyClassElision>(this),
        bytes_(std::move(bytes)) {
    std::uint8_t isLittleEndian = 0;
    read(&isLittleEndian, 1);
    if (isLittleEndian > 1) throw cereal::Exception("no byte order");
    swaps_ = isLittleEndian != cereal::portable_binary_detail::is_little_endian();
  }

  /// Number of bytes that are left.
  std::size_t left() const { return bytes_.size() - at_; }
  /// Number of bytes that have been read.
  std::size_t position() const { return at_; }

  void read(void* data, std::size_t size) {
    if (size > left()) throw cereal::Exception("too few bytes");
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  /// Reads numbers of one type.
  template <typename T>
  void readNumbers(T* numbers, std::size_t count) {
    if (count > left() / sizeof(T)) throw cereal::Exception("too few bytes");
    read(numbers, count * sizeof(T));
    for (std::size_t k = 0; k < count; ++k) {
      if (swaps_) {
        cereal::portable_binary_detail::swap_bytes<sizeof(T)>(
            reinterpret_cast<std::uint8_t*>(numbers + k));
      }
      if constexpr (std::is_floating_point_v<T>) {
        if (std::isnan(numbers[k])) throw cereal::Exception("not a number");
      }
    }
  }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
  bool swaps_ = false;
};

}  // namespace cloth_sim

/// Tells cereal who writes what a StateReader reads.
template <>
struct cereal::traits::detail::get_output_from_input<cloth_sim::StateReader> {
  using type = cloth_sim::StateWriter;
};

namespace cloth_sim {

/// Reads a single number; infinity stands only in arrays (TearRatios).
template <typename T>
std::enable_if_t<std::is_arithmetic_v<T>> CEREAL_LOAD_FUNCTION_NAME(StateReader& archive,
                                                                    T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    std::uint8_t byte = 0;
    archive.readNumbers(&byte, 1);
    if (byte > 1) throw cereal::Exception("not a truth value");
    value = byte == 1;
  } else {
    archive.readNumbers(&value, 1);
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) throw cereal::Exception("not a finite number");
    }
  }
}

/// Reads the length of a container. Its items take a byte each, at least.
template <typename T>
void CEREAL_LOAD_FUNCTION_NAME(StateReader& archive, cereal::SizeTag<T>& tag) {
  std::uint64_t size = 0;
  archive.readNumbers(&size, 1);
  if (size > archive.left()) throw cereal::Exception("a list that is longer than the file");
  tag.size = static_cast<std::decay_t<T>>(size);
}

/// Names of values are for archives of text.
template <typename T>
void CEREAL_LOAD_FUNCTION_NAME(StateReader& archive, cereal::NameValuePair<T>& pair) {
  archive(pair.value);
}

template <typename T>
void CEREAL_LOAD_FUNCTION_NAME(StateReader& archive, cereal::BinaryData<T>& data) {
  using Number = std::remove_pointer_t<T>;
  archive.readNumbers(static_cast<Number*>(data.data),
                      static_cast<std::size_t>(data.size) / sizeof(Number));
}

/// Writes or reads a vector of a type without default constructor: on reading, its items are copies
/// of `blank` first.
/// \tparam Items  std::vector<T>; const if the archive writes.
template <class Archive, typename Items, typename T>
void serializeItems(Archive& archive, Items& items, const T& blank) {
  std::uint64_t count = items.size();
  archive(count);
  if constexpr (Archive::is_loading::value) {
    items.clear();
    while (items.size() < count) archive(items.emplace_back(blank));  // ends where the bytes end
  } else {
    for (auto& item : items) archive(item);
  }
}

}  // namespace cloth_sim
