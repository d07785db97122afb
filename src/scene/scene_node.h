#pragma once
/// \file Strict, typed reading of a YAML value. Every deviation is a SceneError that names the
/// file, the line, the key and what was expected.

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloth_sim/types.h"
#include "names.h"
#include "support/short_number.h"
#include "yaml_tree.h"

namespace cloth_sim {

/// The range of numbers that a key accepts: never NaN, and infinity only where it has a meaning.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool openMinimum = false;  ///< the minimum itself is not allowed
  bool infinite = false;     ///< plus infinity is allowed

  bool contains(double value) const;
  /// Returns, for example, "a number > 0 and <= 10".
  std::string text(const std::string& noun = "a number") const;
};

constexpr Range kAnyNumber{};
constexpr Range kPositive{0.0, std::numeric_limits<double>::infinity(), true, false};
constexpr Range kNotNegative{0.0, std::numeric_limits<double>::infinity(), false, false};

/// A value of the scene file with its path from the root.
class SceneNode {
 public:
  SceneNode(const YamlValue& value, std::string path, std::string file)
      : value_(&value), path_(std::move(path)), file_(std::move(file)) {}

  const std::string& key() const { return value_->key; }
  const std::string& path() const { return path_; }
  /// The name of the scene file in messages.
  const std::string& file() const { return file_; }
  bool isMap() const { return value_->kind == YamlValue::Kind::kMap; }
  bool isList() const { return value_->kind == YamlValue::Kind::kList; }
  bool isScalar() const { return value_->kind == YamlValue::Kind::kScalar; }
  bool isWord(const std::string& word) const { return isScalar() && value_->text == word; }
  bool isNumber() const;

  /// Throws the SceneError "FILE:LINE: PATH: expected `what` (got ...)".
  [[noreturn]] void expected(const std::string& what) const;
  /// Throws the SceneError "FILE:LINE: PATH: `message`".
  [[noreturn]] void refuse(const std::string& message) const;
  /// Throws the SceneError "FILE:LINE: PATH.KEY: missing, expected `what`".
  [[noreturn]] void missing(const std::string& name, const std::string& what) const;

  /// Refuses a value that is no map, or that has a key that is not in `known`.
  void expectKeys(const std::vector<std::string>& known) const;
  /// The value of a key of a map, if the map has the key.
  std::optional<SceneNode> find(const std::string& name) const;
  bool has(const std::string& name) const { return find(name).has_value(); }
  /// The value of a key that the map must have. \param what  the expected value, for the error.
  SceneNode need(const std::string& name, const std::string& what) const;
  /// The items of a list. \param what  the expected value, for the error.
  std::vector<SceneNode> list(const std::string& what) const;
  /// The values of a map with any keys, such as the names of clamps.
  std::vector<SceneNode> entries() const;

  // Each reads this value and refuses one of another type or out of range.

  double number(const Range& range = kAnyNumber) const;
  std::int64_t integer(std::int64_t minimum, std::int64_t maximum) const;
  std::uint64_t seed() const;
  bool boolean() const;
  std::string word(const std::string& what) const;
  /// Reads a list of kSize numbers.
  template <int kSize>
  Eigen::Matrix<double, kSize, 1> vector(const Range& range = kAnyNumber) const {
    Eigen::Matrix<double, kSize, 1> result;
    const std::vector<SceneNode> components = exactly(kSize, range);
    for (int k = 0; k < kSize; ++k) result[k] = components[k].number(range);
    return result;
  }
  /// The items of a list of exactly `count` numbers. \param range  of the numbers, for the error.
  std::vector<SceneNode> exactly(std::size_t count, const Range& range) const;
  /// Reads one of several words, and returns its value.
  /// \param options  the words with their values; the error lists them.
  /// \param aliases  older words with their values: accepted, but not suggested.
  template <typename T>
  T choice(const std::vector<std::pair<std::string, T>>& options,
           const std::vector<std::pair<std::string, T>>& aliases = {}) const {
    std::string known;
    for (const auto& [name, result] : options) {
      if (isScalar() && value_->text == name) return result;
      known += (known.empty() ? "" : ", ") + name;
    }
    for (const auto& [name, result] : aliases) {
      if (isScalar() && value_->text == name) return result;
    }
    expected("one of " + known);
  }

  // Each reads the value of a key of this map into `out`. An absent key leaves `out` as it is.
  void read(const std::string& name, double& out, const Range& range = kAnyNumber) const;
  void read(const std::string& name, std::optional<double>& out, const Range& range) const;
  void read(const std::string& name, bool& out) const;
  void read(const std::string& name, std::optional<bool>& out) const;
  void read(const std::string& name, std::optional<int>& out, int minimum, int maximum) const;
  void read(const std::string& name, int& out, int minimum, int maximum) const;
  void read(const std::string& name, Vec3& out, const Range& range = kAnyNumber) const;
  void read(const std::string& name, std::optional<Vec3>& out) const;
  void read(const std::string& name, Vec2& out, const Range& range = kAnyNumber) const;

 private:
  std::string location(int line) const;
  SceneNode child(const YamlValue& value, std::size_t index) const;

  const YamlValue* value_;
  std::string path_;
  std::string file_;
};

}  // namespace cloth_sim
