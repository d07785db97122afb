#pragma once
/// \file A YAML document as plain values that know their lines. The only place that knows yaml-cpp
/// is yaml_tree.cpp.

#include <string>
#include <vector>

namespace cloth_sim {

/// One value of a YAML document, with what is inside it. Aliases are copies.
struct YamlValue {
  enum class Kind { kNull, kScalar, kList, kMap };

  Kind kind = Kind::kNull;
  std::string key;               ///< under which it stands in its map; else ""
  std::string text;              ///< of a scalar
  bool quoted = false;           ///< the scalar stands in quotes, so it is no number
  bool overridden = false;       ///< it comes from an override, not from the file
  int keyLine = 0;               ///< of its key, from 1; 0: not in the file
  int line = 0;                  ///< of its beginning, from 1; 0: not in the file
  std::vector<YamlValue> items;  ///< of a list or map, in the order of the file

  /// The value under a key of a map; nullptr if there is none, or this is no map.
  const YamlValue* find(const std::string& name) const;
  YamlValue* find(const std::string& name);
};

/// Parses one YAML document.
/// \param file  stands for the document in messages.
/// \throws SceneError for bad syntax, a key that stands twice in a map, or absurd nesting.
YamlValue parseYaml(const std::string& text, const std::string& file);

/// The document as YAML, without comments: parsed again, it has the same values.
std::string emitYaml(const YamlValue& root);

/// Sets one value of a document: "dotted.key=value", the value in YAML. List items go by number or
/// by their `name`. Keys that are not there are added; the value null removes the key.
/// \throws SceneError
void applyOverride(const std::string& text, const std::string& file, YamlValue& root);

}  // namespace cloth_sim
