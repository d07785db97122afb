#pragma once
/// \file A YAML document as a tree of plain values with their line numbers. Only yaml_tree.cpp uses
/// yaml-cpp.

#include <string>
#include <vector>

namespace cloth_sim {

/// A value of a YAML document with its items. Aliases are copies.
struct YamlValue {
  enum class Kind { kNull, kScalar, kList, kMap };

  Kind kind = Kind::kNull;
  std::string key;               ///< of an item of a map; else ""
  std::string text;              ///< of a scalar
  bool quoted = false;           ///< the scalar has quotes, so it is no number
  bool overridden = false;       ///< comes from an override, not from the file
  int keyLine = 0;               ///< line of the key, from 1; 0: not in the file
  int line = 0;                  ///< first line, from 1; 0: not in the file
  std::vector<YamlValue> items;  ///< items of a list or map, in the order of the file

  /// The value of a key of a map; nullptr if there is none, or if this is no map.
  const YamlValue* find(const std::string& name) const;
  YamlValue* find(const std::string& name);
};

/// Parses one YAML document.
/// \param file  stands for the document in messages.
/// \throws SceneError for bad syntax, a key that a map has twice, or too deep nesting.
YamlValue parseYaml(const std::string& text, const std::string& file);

/// Returns the document as YAML without comments. Parsing it again gives the same values.
std::string emitYaml(const YamlValue& root);

/// Sets one value of a document. \param text  "dotted.key=value" with the value in YAML; list items
/// go by number or by their `name`. Adds missing keys; the value null removes the key.
/// \throws SceneError
void applyOverride(const std::string& text, const std::string& file, YamlValue& root);

}  // namespace cloth_sim
