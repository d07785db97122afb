#include "scene_node.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <locale>
#include <sstream>

#include "cloth_sim/scene/load.h"
#include "names.h"
#include "section.h"

namespace cloth_sim {

namespace {

std::string at(const std::string& path, const std::string& key) {
  return path.empty() ? shownText(key) : path + "." + shownText(key);
}

/// Largest number that any key takes, in SI units [-]: far beyond what cloth is made of and what
/// happens to it, and far from where squares and products of what a scene says would overflow.
constexpr double kLargest = 1e9;
/// Smallest number that a key takes that must be positive.
constexpr double kSmallest = 1e-12;

/// Returns what a number that is in the range of its key should be instead; empty if it is within
/// the physical bounds of all keys.
std::string boundError(double value, const Range& range) {
  if (std::isinf(value)) return "";
  if (std::abs(value) > kLargest) return "a number of at most 1e9 in size";
  const bool isPositive = range.openMinimum && range.minimum >= 0.0;
  if (isPositive && value < kSmallest) return "a number of at least 1e-12";
  return "";
}

/// A number of YAML: decimal, whatever the locale of the process; .inf and .nan.
std::optional<double> parseNumber(const YamlValue& value) {
  if (value.kind != YamlValue::Kind::kScalar || value.quoted) return std::nullopt;
  const std::string& text = value.text;
  if (text == ".inf" || text == "+.inf") return std::numeric_limits<double>::infinity();
  if (text == "-.inf") return -std::numeric_limits<double>::infinity();
  if (text == ".nan") return std::numeric_limits<double>::quiet_NaN();
  if (text.find_first_not_of("+-.0123456789eE") != std::string::npos) return std::nullopt;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double number = 0.0;
  stream >> number;
  if (stream.fail() || stream.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return number;
}

/// Says what a key that a map does not have may have been meant to be: a key of another map, or a
/// similar one; "" if there is none.
std::string hintFor(const std::string& key, const std::vector<std::string>& known) {
  std::vector<std::string> places;
  for (const KeyTable& table : sceneKeys()) {
    const auto has = [&](const std::string& name) {
      return std::find(table.names.begin(), table.names.end(), name) != table.names.end();
    };
    const bool isThisMap = std::all_of(known.begin(), known.end(), has);
    if (isThisMap || !has(key)) continue;
    places.push_back(table.heading == kTopLevel ? "the top level" : table.heading);
  }
  constexpr std::size_t kMostPlaces = 2;  // a key of more says little
  if (!places.empty() && places.size() <= kMostPlaces)
    return "it belongs to " + joinNames(places) + "; ";
  const std::string near = nearestName(key, known);
  return near.empty() ? "" : "did you mean '" + near + "'? ";
}

template <typename Integer>
std::optional<Integer> parseInteger(const YamlValue& value) {
  if (value.kind != YamlValue::Kind::kScalar || value.quoted) return std::nullopt;
  const std::string& text = value.text;
  if (text.find_first_not_of("0123456789", text[0] == '-' ? 1 : 0) != std::string::npos) {
    return std::nullopt;
  }
  if (text[0] == '-' && !std::is_signed<Integer>::value) return std::nullopt;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  Integer number = 0;
  stream >> number;
  return stream.fail() ? std::nullopt : std::optional<Integer>(number);
}

std::optional<bool> parseBoolean(const YamlValue& value) {
  if (value.kind != YamlValue::Kind::kScalar || value.quoted) return std::nullopt;
  std::string text = value.text;
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (text == "true" || text == "yes" || text == "on") return true;
  if (text == "false" || text == "no" || text == "off") return false;
  return std::nullopt;
}

std::string shown(const YamlValue& value) {
  const std::string suffix = value.overridden ? ", by an override" : "";
  switch (value.kind) {
    case YamlValue::Kind::kNull:
      return "nothing" + suffix;
    case YamlValue::Kind::kList:
      return "a list of " + std::to_string(value.items.size()) + suffix;
    case YamlValue::Kind::kMap:
      return "a map" + suffix;
    case YamlValue::Kind::kScalar:
      break;
  }
  const bool bare = parseNumber(value) || parseBoolean(value);
  return (bare ? shownText(value.text) : "'" + shownText(value.text) + "'") + suffix;
}

}  // namespace

bool Range::contains(double value) const {
  if (std::isnan(value)) return false;
  if (std::isinf(value)) return infinite && value > 0.0;
  return (openMinimum ? value > minimum : value >= minimum) && value <= maximum;
}

std::string Range::text(const std::string& noun) const {
  std::string result = noun;
  const bool below = std::isfinite(minimum);
  const bool above = std::isfinite(maximum);
  if (below) result += (openMinimum ? " > " : " >= ") + shortNumber(minimum);
  if (above) result += (below ? " and <= " : " <= ") + shortNumber(maximum);
  return infinite ? result + " or .inf" : result;
}

std::string SceneNode::location(int line) const {
  return file_ + (line > 0 ? ":" + std::to_string(line) : "") + ": ";
}

void SceneNode::expected(const std::string& what) const {
  refuse("expected " + what + " (got " + shown(*value_) + ")");
}

void SceneNode::refuse(const std::string& message) const {
  const int line = value_->line > 0 ? value_->line : value_->keyLine;
  throw SceneError(location(line) + (path_.empty() ? "" : path_ + ": ") + message);
}

void SceneNode::missing(const std::string& name, const std::string& what) const {
  const int line = value_->keyLine > 0 ? value_->keyLine : value_->line;
  throw SceneError(location(line) + at(path_, name) + ": missing, expected " + what);
}

void SceneNode::expectKeys(const std::vector<std::string>& known) const {
  if (!isMap()) expected("a map with keys from " + joinNames(known));
  for (const YamlValue& item : value_->items) {
    if (std::find(known.begin(), known.end(), item.key) != known.end()) continue;
    throw SceneError(location(item.keyLine) + at(path_, item.key) + ": unknown key, " +
                     hintFor(item.key, known) + "expected one of " + joinNames(known));
  }
}

SceneNode SceneNode::child(const YamlValue& value, std::size_t index) const {
  if (isMap()) return SceneNode(value, at(path_, value.key), file_);
  const YamlValue* name = value.find("name");
  const bool named = name != nullptr && !name->text.empty();
  return SceneNode(value, at(path_, named ? name->text : std::to_string(index)), file_);
}

std::optional<SceneNode> SceneNode::find(const std::string& name) const {
  const YamlValue* value = value_->find(name);
  if (value == nullptr) return std::nullopt;
  return child(*value, 0);
}

SceneNode SceneNode::need(const std::string& name, const std::string& what) const {
  const std::optional<SceneNode> found = find(name);
  if (!found) missing(name, what);
  return *found;
}

std::vector<SceneNode> SceneNode::list(const std::string& what) const {
  if (!isList()) expected(what);
  std::vector<SceneNode> result;
  for (std::size_t k = 0; k < value_->items.size(); ++k) {
    result.push_back(child(value_->items[k], k));
  }
  return result;
}

std::vector<SceneNode> SceneNode::entries() const {
  if (!isMap()) expected("a map of names");
  std::vector<SceneNode> result;
  for (const YamlValue& item : value_->items) result.push_back(child(item, 0));
  return result;
}

std::vector<SceneNode> SceneNode::exactly(std::size_t count, const Range& range) const {
  const std::string each = range.text("each");
  const std::string what = "a list of " + std::to_string(count) + " numbers";
  if (!isList() || value_->items.size() != count) {
    expected(each == "each" ? what : what + ", " + each);
  }
  return list(what);
}

double SceneNode::number(const Range& range) const {
  const std::optional<double> value = parseNumber(*value_);
  if (!value || !range.contains(*value)) expected(range.text());
  const std::string bound = boundError(*value, range);
  if (!bound.empty()) expected(bound);
  return *value;
}

bool SceneNode::isNumber() const { return parseNumber(*value_).has_value(); }

std::int64_t SceneNode::integer(std::int64_t minimum, std::int64_t maximum) const {
  const std::optional<std::int64_t> value = parseInteger<std::int64_t>(*value_);
  if (!value || *value < minimum || *value > maximum) {
    expected("a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum));
  }
  return *value;
}

std::uint64_t SceneNode::seed() const {
  const std::optional<std::uint64_t> value = parseInteger<std::uint64_t>(*value_);
  if (!value) expected("a whole number >= 0 and < 2^64");
  return *value;
}

bool SceneNode::boolean() const {
  const std::optional<bool> value = parseBoolean(*value_);
  if (!value) expected("true or false");
  return *value;
}

std::string SceneNode::word(const std::string& what) const {
  constexpr std::size_t kLongest = 4096;  // a path may be that long
  if (!isScalar() || value_->text.empty()) expected(what);
  if (value_->text.size() > kLongest) expected("at most 4096 characters");
  return value_->text;
}

void SceneNode::read(const std::string& name, double& out, const Range& range) const {
  if (const auto node = find(name)) out = node->number(range);
}

void SceneNode::read(const std::string& name, std::optional<double>& out,
                     const Range& range) const {
  if (const auto node = find(name)) out = node->number(range);
}

void SceneNode::read(const std::string& name, bool& out) const {
  if (const auto node = find(name)) out = node->boolean();
}

void SceneNode::read(const std::string& name, std::optional<bool>& out) const {
  if (const auto node = find(name)) out = node->boolean();
}

void SceneNode::read(const std::string& name, std::optional<int>& out, int minimum,
                     int maximum) const {
  if (const auto node = find(name)) out = static_cast<int>(node->integer(minimum, maximum));
}

void SceneNode::read(const std::string& name, int& out, int minimum, int maximum) const {
  if (const auto node = find(name)) out = static_cast<int>(node->integer(minimum, maximum));
}

void SceneNode::read(const std::string& name, Vec3& out, const Range& range) const {
  if (const auto node = find(name)) out = node->vector<3>(range);
}

void SceneNode::read(const std::string& name, std::optional<Vec3>& out) const {
  if (const auto node = find(name)) out = node->vector<3>();
}

void SceneNode::read(const std::string& name, Vec2& out, const Range& range) const {
  if (const auto node = find(name)) out = node->vector<2>(range);
}

}  // namespace cloth_sim
