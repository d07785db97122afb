#include "surface_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "dae_mesh.h"
#include "obj_mesh.h"
#include "support/input_file.h"

namespace cloth_sim {
namespace {

constexpr std::uint64_t kMaxSurfaceSize = 256 << 20;  // [bytes]
constexpr std::size_t kStlHeader = 84;                // [bytes]
constexpr std::size_t kStlTriangle = 50;              // [bytes]

[[noreturn]] void refuseFile(const std::string& path, const std::string& message) {
  throw SceneError(path + ": " + message);
}

[[noreturn]] void refuseCount(const std::string& path, const std::string& count) {
  refuseFile(path, "expected at most " + std::to_string(kMostTriangles) + " triangles (got " +
                       count + ")");
}

std::uint32_t littleEndian(const char* bytes) {
  std::uint32_t value = 0;
  for (int k = 3; k >= 0; --k) value = value << 8U | static_cast<unsigned char>(bytes[k]);
  return value;
}

double floatAt(const char* bytes) {
  const std::uint32_t bits = littleEndian(bytes);
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

Triangles parseBinaryStl(const std::string& bytes, const std::string& path) {
  if (bytes.size() < kStlHeader) {
    refuseFile(path, "expected an STL file (got " + std::to_string(bytes.size()) +
                         " bytes, fewer than the header of a binary one)");
  }
  const std::size_t count = littleEndian(bytes.data() + kStlHeader - 4);
  if (count > kMostTriangles) refuseCount(path, std::to_string(count));
  const std::size_t size = kStlHeader + kStlTriangle * count;
  if (bytes.size() != size) {
    refuseFile(path, "expected " + std::to_string(size) + " bytes, for its " +
                         std::to_string(count) + " triangles (got " + std::to_string(bytes.size()) +
                         ")");
  }
  std::vector<Vec3> corners;
  for (std::size_t t = 0; t < count; ++t) {
    const char* at = bytes.data() + kStlHeader + kStlTriangle * t + 12;  // after the normal
    for (int k = 0; k < 3; ++k, at += 12) {
      corners.emplace_back(floatAt(at), floatAt(at + 4), floatAt(at + 8));
      if (!corners.back().allFinite()) {
        refuseFile(path, "triangle " + std::to_string(t + 1) + ": expected finite numbers");
      }
    }
  }
  return weld(std::move(corners));
}

/// The words of a text in STL, with line numbers for errors.
class StlText {
 public:
  StlText(const std::string& text, const std::string& path)
      : at_(text.c_str()), end_(at_ + text.size()), path_(path) {}

  Triangles read() {
    expectWord("solid");
    skipLine();
    for (std::string word = next(); word != "endsolid"; word = next()) {
      if (word != "facet") refuse("expected \"facet\" or \"endsolid\"", word);
      skipLine();  // its normal, which the corners say too
      readFacet();
    }
    return weld(std::move(corners_));
  }

 private:
  void readFacet() {
    if (corners_.size() == 3 * kMostTriangles) {
      refuseCount(path_, "more");
    }
    expectWord("outer");
    expectWord("loop");
    for (int k = 0; k < 3; ++k) {
      expectWord("vertex");
      const double x = number();
      const double y = number();
      corners_.emplace_back(x, y, number());
    }
    expectWord("endloop");
    expectWord("endfacet");
  }

  [[noreturn]] void refuse(const std::string& expected, const std::string& got) const {
    throw SceneError(path_ + ":" + std::to_string(line_) + ": " + expected + " (got " +
                     (got.empty() ? "the end of the file" : "\"" + got.substr(0, 40) + "\"") + ")");
  }
  static bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  std::string next() {
    for (; at_ != end_ && isSpace(*at_); ++at_) line_ += *at_ == '\n' ? 1 : 0;
    const char* first = at_;
    while (at_ != end_ && !isSpace(*at_)) ++at_;
    return {first, at_};
  }
  void expectWord(const char* word) {
    const std::string got = next();
    if (got != word) refuse(std::string("expected \"") + word + "\"", got);
  }
  double number() {
    const std::string word = next();
    char* last = nullptr;
    const double value = std::strtod(word.c_str(), &last);
    if (word.empty() || *last != '\0' || !std::isfinite(value)) {
      refuse("expected a finite number", word);
    }
    return value;
  }
  void skipLine() {
    while (at_ != end_ && *at_ != '\n') ++at_;
  }

  const char* at_;
  const char* end_;
  const std::string& path_;
  int line_ = 1;
  std::vector<Vec3> corners_;
};

std::string endingOf(const std::string& path) {
  std::string ending = path.substr(std::min(path.find_last_of('.'), path.size()));
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

Triangles readTriangles(const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending != ".stl" && ending != ".obj" && ending != ".dae") {
    refuseFile(path, "expected a file whose name ends in .stl, .obj or .dae");
  }
  try {
    const std::string bytes = readInputFile(path, {kMaxSurfaceSize, Links::kFollowed});
    if (ending == ".dae") return parseDae(bytes, path);
    return ending == ".stl" ? parseStl(bytes, path) : parseObjTriangles(bytes, path);
  } catch (const FileError& error) {
    throw SceneError(error.what());
  }
}

}  // namespace

Triangles weld(std::vector<Vec3> corners) {
  for (Vec3& x : corners) x.array() += 0.0;  // makes -0 and 0 the same
  std::vector<std::int32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&corners](std::int32_t k) {
    return std::make_tuple(corners[k].x(), corners[k].y(), corners[k].z(), k);
  };
  std::sort(order.begin(), order.end(),
            [&key](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  Triangles result;
  result.corners.resize(corners.size() / 3);
  for (const std::int32_t k : order) {
    if (result.vertices.empty() || result.vertices.back() != corners[k]) {
      result.vertices.push_back(corners[k]);
    }
    result.corners[k / 3][k % 3] = static_cast<std::int32_t>(result.vertices.size()) - 1;
  }
  return result;
}

Triangles parseStl(const std::string& bytes, const std::string& path) {
  if (bytes.empty()) refuseFile(path, "expected an STL file (got an empty one)");
  const bool isBinary =
      bytes.size() >= kStlHeader &&
      bytes.size() == kStlHeader + kStlTriangle * littleEndian(bytes.data() + kStlHeader - 4);
  // A binary file may begin with the same word: then its size decides.
  const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const bool isText =
      bytes.compare(start, 5, "solid") == 0 && bytes.find('\0') == std::string::npos;
  if (isText && !isBinary) return StlText(bytes, path).read();
  return parseBinaryStl(bytes, path);
}

SurfaceFile readSurface(const std::string& path, const std::string& name, const Vec3& scale) {
  Triangles triangles = readTriangles(path);
  for (Vec3& x : triangles.vertices) x = x.cwiseProduct(scale);
  try {
    SurfaceFile file =
        surfaceFile(name, TriangleSurface(std::move(triangles.vertices), triangles.corners));
    file.path = std::filesystem::absolute(path).lexically_normal().string();
    return file;
  } catch (const std::invalid_argument& error) {
    refuseFile(path, error.what());
  }
}

}  // namespace cloth_sim
