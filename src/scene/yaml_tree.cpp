#include "yaml_tree.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "cloth_sim/scene/load.h"
#include "support/one_line.h"

namespace cloth_sim {

namespace {

// More than any scene needs, and a bound on the values that aliases of aliases expand to.
constexpr int kMaxDepth = 32;
constexpr int kMaxValues = 1000000;

/// Copies yaml-cpp's nodes into values.
class Converter {
 public:
  explicit Converter(std::string file) : file_(std::move(file)) {}

  YamlValue convert(const YAML::Node& node, int depth) {
    YamlValue value;
    value.line = node.Mark().line + 1;
    if (depth > kMaxDepth || ++count_ > kMaxValues)
      fail(value.line, "nested too deeply or too big");
    if (node.IsScalar()) {
      value.kind = YamlValue::Kind::kScalar;
      value.text = node.Scalar();
      value.quoted = node.Tag() == "!";
    } else if (node.IsSequence()) {
      value.kind = YamlValue::Kind::kList;
      for (const YAML::Node& item : node) value.items.push_back(convert(item, depth + 1));
    } else if (node.IsMap()) {
      value.kind = YamlValue::Kind::kMap;
      for (const auto& entry : node) addEntry(entry.first, entry.second, depth, value);
    }
    return value;
  }

 private:
  void addEntry(const YAML::Node& key, const YAML::Node& node, int depth, YamlValue& map) {
    const int line = key.Mark().line + 1;
    if (!key.IsScalar()) fail(line, "expected a word as key");
    if (map.find(key.Scalar()) != nullptr) {
      fail(line, "key '" + oneLine(key.Scalar()) + "' stands twice in the same map");
    }
    map.items.push_back(convert(node, depth + 1));
    map.items.back().key = key.Scalar();
    map.items.back().keyLine = line;
  }

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw SceneError(file_ + ":" + std::to_string(line) + ": " + what);
  }

  std::string file_;
  int count_ = 0;
};

/// Skips the events of a document.
class Ignore : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Returns whether anything follows the first document, which YAML::Load would ignore.
/// YAML::LoadAll is no alternative: in yaml-cpp 0.7 it never returns if the text begins with a
/// comma.
bool goesOnAfterFirstDocument(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Ignore ignore;
  return parser.HandleNextDocument(ignore) && parser.HandleNextDocument(ignore);
}

void markOverridden(YamlValue& value) {
  value.overridden = true;
  value.line = 0;
  value.keyLine = 0;
  for (YamlValue& item : value.items) markOverridden(item);
}

std::vector<std::string> splitPath(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

YamlValue* listItem(YamlValue& list, const std::string& part) {
  for (YamlValue& item : list.items) {
    const YamlValue* name = item.find("name");
    if (name != nullptr && name->text == part) return &item;
  }
  const bool isNumber = part.find_first_not_of("0123456789") == std::string::npos;
  if (!isNumber || part.size() > 9) return nullptr;
  const std::size_t index = std::stoul(part);
  return index < list.items.size() ? &list.items[index] : nullptr;
}

/// Returns the item `part` of a map or list, and adds it to a map that lacks it; nullptr if the
/// value cannot have such an item.
YamlValue* descend(YamlValue& value, const std::string& part) {
  if (value.kind == YamlValue::Kind::kList) return listItem(value, part);
  if (value.kind == YamlValue::Kind::kScalar) return nullptr;
  value.kind = YamlValue::Kind::kMap;
  if (YamlValue* found = value.find(part)) return found;
  value.items.emplace_back();
  value.items.back().key = part;
  value.items.back().overridden = true;
  return &value.items.back();
}

void assign(YamlValue& target, YamlValue value) {
  value.key = target.key;
  value.keyLine = target.keyLine;
  target = std::move(value);
}

void emit(const YamlValue& value, YAML::Emitter& out) {
  switch (value.kind) {
    case YamlValue::Kind::kNull:
      out << YAML::Null;
      break;
    case YamlValue::Kind::kScalar:
      if (value.quoted) out << YAML::DoubleQuoted;
      out << value.text;
      break;
    case YamlValue::Kind::kList:
      out << YAML::BeginSeq;
      for (const YamlValue& item : value.items) emit(item, out);
      out << YAML::EndSeq;
      break;
    case YamlValue::Kind::kMap:
      out << YAML::BeginMap;
      for (const YamlValue& item : value.items) {
        out << YAML::Key << item.key << YAML::Value;
        emit(item, out);
      }
      out << YAML::EndMap;
      break;
  }
}

void removeItem(YamlValue& parent, const YamlValue* item) {
  parent.items.erase(parent.items.begin() + (item - parent.items.data()));
}

/// \tparam Value  YamlValue or const YamlValue.
template <typename Value>
Value* findKey(Value& map, const std::string& key) {
  if (map.kind != YamlValue::Kind::kMap) return nullptr;
  for (Value& item : map.items) {
    if (item.key == key) return &item;
  }
  return nullptr;
}

}  // namespace

const YamlValue* YamlValue::find(const std::string& name) const { return findKey(*this, name); }

YamlValue* YamlValue::find(const std::string& name) { return findKey(*this, name); }

YamlValue parseYaml(const std::string& text, const std::string& file) {
  try {
    if (goesOnAfterFirstDocument(text)) {
      throw SceneError(file + ": expected one YAML document (got more after its end)");
    }
    return Converter(file).convert(YAML::Load(text), 0);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.line < 0 ? "" : ":" + std::to_string(error.mark.line + 1);
    throw SceneError(file + line + ": not valid YAML: " + oneLine(error.msg));
  }
}

std::string emitYaml(const YamlValue& root) {
  YAML::Emitter out;
  emit(root, out);
  return std::string(out.c_str()) + '\n';
}

void applyOverride(const std::string& text, const std::string& file, YamlValue& root) {
  const std::string what = "override '" + oneLine(text) + "'";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals + 1 == text.size()) {
    throw SceneError(file + ": " + what + ": expected dotted.key=value");
  }
  YamlValue* parent = nullptr;
  YamlValue* target = &root;
  for (const std::string& part : splitPath(text.substr(0, equals))) {
    if (part.empty()) throw SceneError(file + ": " + what + ": expected dotted.key=value");
    parent = target;
    target = descend(*parent, part);
    if (target == nullptr) {
      throw SceneError(
          file + ": " + what + ": there is no '" + oneLine(part) + "', as what it is in " +
          (parent->kind == YamlValue::Kind::kList ? "is a list without one" : "is a single value"));
    }
  }
  YamlValue value = parseYaml(text.substr(equals + 1), file + ": " + what);
  markOverridden(value);
  if (value.kind == YamlValue::Kind::kNull) {
    removeItem(*parent, target);
  } else {
    assign(*target, std::move(value));
  }
}

}  // namespace cloth_sim
