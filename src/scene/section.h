#pragma once
/// \file Sections: the tables of the keys of a scene file, one table for each map. A new key is a
/// row in the table of its map, a member that it is read into, and a row in docs/scene.md.

#include <functional>
#include <initializer_list>

#include "scene_node.h"

namespace cloth_sim {

constexpr const char* kTopLevel = "Top level";  ///< heading of the keys outside of all maps

/// The keys of one map, and the heading that docs/scene.md gives them.
struct KeyTable {
  std::string heading;
  std::vector<std::string> names;
};

/// The keys of all maps but the parameters of the methods, which the registry has. Obstacles have
/// the keys of every shape.
std::vector<KeyTable> sceneKeys();

/// A key of a map that is read into a T.
template <class T>
struct Key {
  using ReadValue = std::function<void(const SceneNode& value, T& out)>;

  /// A key that the reader of the map reads by hand, because it depends on other keys.
  // NOLINTNEXTLINE(google-explicit-constructor): a row of a table may be a name only.
  Key(const char* key) : name(key) {}
  /// A key that is read into a member. \param limits  as SceneNode::read takes them.
  template <class Value, class... Limits>
  Key(const char* key, Value T::*member, const Limits&... limits)
      : name(key), read([key, member, limits...](const SceneNode& map, T& out) {
          map.read(key, out.*member, limits...);
        }) {}
  /// A key whose value a function reads.
  Key(const char* key, ReadValue readValue)
      : name(key), read([key, readValue](const SceneNode& map, T& out) {
          if (const auto value = map.find(key)) readValue(*value, out);
        }) {}
  /// A key that must be there. \param what  the expected value, for the error.
  static Key required(const char* key, const std::string& what, ReadValue readValue) {
    Key result(key);
    result.read = [key, what, readValue](const SceneNode& map, T& out) {
      readValue(map.need(key, what), out);
    };
    return result;
  }
  /// A number that must be there.
  static Key required(const char* key, double T::*member, const Range& range) {
    return required(key, range.text(), [member, range](const SceneNode& value, T& out) {
      out.*member = value.number(range);
    });
  }

  const char* name;
  std::function<void(const SceneNode& map, T& out)> read;  ///< absent if read by hand
};

/// The table of the keys of a map that is read into a T.
template <class T>
class Section {
 public:
  /// \param headingInDocs  of the section of docs/scene.md, without "## ".
  Section(const char* headingInDocs, std::initializer_list<Key<T>> rows)
      : rows_(rows), keys_{headingInDocs, {}} {
    for (const Key<T>& row : rows_) keys_.names.emplace_back(row.name);
  }

  const KeyTable& keys() const { return keys_; }

  /// Refuses a node that is no map or has unknown keys, then reads its keys in the order of the
  /// table. A member whose key is absent keeps its value.
  void read(const SceneNode& map, T& out) const {
    map.expectKeys(keys_.names);
    readKnown(map, out);
  }
  /// Reads the keys of this table only; the map may have others.
  void readKnown(const SceneNode& map, T& out) const {
    for (const Key<T>& row : rows_) {
      if (row.read) row.read(map, out);
    }
  }
  /// Reads a T that starts from its defaults.
  T read(const SceneNode& map) const {
    T result;
    read(map, result);
    return result;
  }

 private:
  std::vector<Key<T>> rows_;
  KeyTable keys_;
};

}  // namespace cloth_sim
