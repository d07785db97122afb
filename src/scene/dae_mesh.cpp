#include "dae_mesh.h"

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <unordered_map>
#include <utility>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

using tinyxml2::XMLElement;
using Corners = std::vector<Vec3>;  // three for each triangle

constexpr std::size_t kMostNodes = 100000;  // visits: a node may be instantiated many times

/// Where an error is, and its sentence.
class Place {
 public:
  explicit Place(std::string path) : path_(std::move(path)) {}

  [[noreturn]] void refuse(const std::string& message, int line = 0) const {
    throw SceneError(path_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + message);
  }
  [[noreturn]] void refuse(const std::string& message, const XMLElement& at) const {
    refuse("<" + std::string(at.Name()).substr(0, 40) + ">: " + message, at.GetLineNum());
  }

 private:
  std::string path_;
};

[[noreturn]] void refuseTriangleCount(const Place& place) {
  place.refuse("expected at most " + std::to_string(kMostTriangles) + " triangles (got more)");
}

bool isNamed(const XMLElement& element, const char* name) {
  return std::strcmp(element.Name(), name) == 0;
}

template <class Function>
void forEachChild(const XMLElement& parent, const char* name, Function&& function) {
  for (const XMLElement* it = parent.FirstChildElement(name); it != nullptr;
       it = it->NextSiblingElement(name)) {
    function(*it);
  }
}

/// The text directly inside an element; comments may divide it.
std::string textOf(const XMLElement& element) {
  std::string text;
  for (const tinyxml2::XMLNode* it = element.FirstChild(); it != nullptr; it = it->NextSibling()) {
    if (it->ToText() != nullptr) text += std::string(it->Value()) + " ";
  }
  return text;
}

/// Parses the numbers of an element. \param convert  strtod or strtol.
template <class Number, class Convert>
std::vector<Number> numbersOf(const XMLElement& element, const Place& place, Convert&& convert) {
  const std::string text = textOf(element);
  std::vector<Number> numbers;
  const char* at = text.c_str();
  while (true) {
    at += std::strspn(at, " \t\r\n");
    if (*at == '\0') return numbers;
    char* last = nullptr;
    const auto number = convert(at, &last);
    if (last == at || std::strchr(" \t\r\n", *last) == nullptr) {
      const std::size_t length = std::min<std::size_t>(std::strcspn(at, " \t\r\n"), 40);
      place.refuse("expected a number (got \"" + std::string(at, length) + "\")", element);
    }
    numbers.push_back(number);
    at = last;
  }
}

std::vector<double> realNumbers(const XMLElement& element, const Place& place) {
  std::vector<double> numbers = numbersOf<double>(
      element, place, [](const char* text, char** end) { return std::strtod(text, end); });
  for (const double number : numbers) {
    if (!std::isfinite(number)) place.refuse("expected finite numbers", element);
  }
  return numbers;
}

std::vector<long> wholeNumbers(const XMLElement& element, const Place& place) {
  return numbersOf<long>(element, place,
                         [](const char* text, char** end) { return std::strtol(text, end, 10); });
}

template <int kCount>
std::array<double, kCount> exactly(const XMLElement& element, const Place& place) {
  const std::vector<double> numbers = realNumbers(element, place);
  if (numbers.size() != kCount) {
    place.refuse("expected " + std::to_string(kCount) + " numbers (got " +
                     std::to_string(numbers.size()) + ")",
                 element);
  }
  std::array<double, kCount> result;
  std::copy(numbers.begin(), numbers.end(), result.begin());
  return result;
}

/// Returns the transform that an element of a node stands for; the identity if it is none.
Eigen::Affine3d transformOf(const XMLElement& element, const Place& place) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (isNamed(element, "translate")) {
    transform.translate(Vec3(exactly<3>(element, place).data()));
  } else if (isNamed(element, "scale")) {
    transform.scale(Vec3(exactly<3>(element, place).data()));
  } else if (isNamed(element, "rotate")) {
    const std::array<double, 4> r = exactly<4>(element, place);
    const Vec3 axis(r.data());
    if (!(axis.norm() > 0.0)) place.refuse("expected an axis with a length", element);
    transform.rotate(Eigen::AngleAxisd(r[3] * std::acos(-1.0) / 180.0, axis.normalized()));
  } else if (isNamed(element, "matrix")) {
    const std::array<double, 16> m = exactly<16>(element, place);
    transform.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(m.data());
  } else if (isNamed(element, "lookat") || isNamed(element, "skew")) {
    place.refuse("expected matrix, translate, rotate or scale", element);
  }
  return transform;
}

/// Positions that faces name by their index.
class Positions {
 public:
  /// \param source  with a float_array and an accessor.
  Positions(const XMLElement& source, const Place& place) {
    const XMLElement* array = source.FirstChildElement("float_array");
    if (array == nullptr) place.refuse("expected a float_array", source);
    numbers_ = realNumbers(*array, place);
    const XMLElement* common = source.FirstChildElement("technique_common");
    const XMLElement* accessor =
        common != nullptr ? common->FirstChildElement("accessor") : nullptr;
    const int stride = accessor != nullptr ? accessor->IntAttribute("stride", 1) : 3;
    const int offset = accessor != nullptr ? accessor->IntAttribute("offset", 0) : 0;
    if (stride < 3 || offset < 0) {
      place.refuse("expected an accessor of positions: a stride of 3 or more", source);
    }
    stride_ = static_cast<std::size_t>(stride);
    offset_ = static_cast<std::size_t>(offset);
    const std::size_t end = offset_ + 3;  // of the first one
    count_ = numbers_.size() < end ? 0 : (numbers_.size() - end) / stride_ + 1;
  }

  std::size_t count() const { return count_; }
  Vec3 at(std::size_t k) const { return Vec3(numbers_.data() + offset_ + k * stride_); }

 private:
  std::vector<double> numbers_;
  std::size_t stride_ = 3;
  std::size_t offset_ = 0;
  std::size_t count_ = 0;
};

/// The triangles of one `<mesh>`.
class DaeMesh {
 public:
  DaeMesh(const std::unordered_map<std::string, const XMLElement*>& byId, const Place& place)
      : byId_(byId), place_(place) {}

  Corners read(const XMLElement& mesh) {
    for (const XMLElement* it = mesh.FirstChildElement(); it != nullptr;
         it = it->NextSiblingElement()) {
      if (isNamed(*it, "triangles") || isNamed(*it, "tristrips") || isNamed(*it, "trifans") ||
          isNamed(*it, "polylist") || isNamed(*it, "polygons")) {
        readFaces(*it);
      }
    }
    return std::move(corners_);
  }

 private:
  /// The element with the id that an attribute names: "#id".
  const XMLElement& target(const XMLElement& element, const char* attribute) const {
    const char* url = element.Attribute(attribute);
    const auto found = byId_.find(url != nullptr && *url == '#' ? url + 1 : "");
    if (found == byId_.end()) place_.refuse(std::string("no such ") + attribute, element);
    return *found->second;
  }

  void readFaces(const XMLElement& faces) {
    std::size_t stride = 1;
    std::size_t offset = 0;
    const XMLElement* vertices = nullptr;
    forEachChild(faces, "input", [&](const XMLElement& input) {
      const int at = input.IntAttribute("offset", 0);
      if (at < 0 || at > 100) place_.refuse("expected an offset from 0 to 100", input);
      stride = std::max(stride, static_cast<std::size_t>(at) + 1);
      if (!input.Attribute("semantic", "VERTEX")) return;
      offset = static_cast<std::size_t>(at);
      vertices = &target(input, "source");
    });
    if (vertices == nullptr) place_.refuse("expected an input VERTEX", faces);
    const Positions positions = positionsOf(*vertices);
    std::vector<std::size_t> sizes;  // of the polygons of a polylist
    if (const XMLElement* counts = faces.FirstChildElement("vcount")) {
      for (const long size : wholeNumbers(*counts, place_)) {
        if (size < 0) place_.refuse("expected numbers of 0 or more", *counts);
        sizes.push_back(static_cast<std::size_t>(size));
      }
    }
    forEachChild(faces, "p", [&](const XMLElement& p) {
      add(faces, pointsOf(p, stride, offset, positions), sizes);
    });
    forEachChild(faces, "ph", [&](const XMLElement& ph) {
      place_.refuse("expected polygons without holes", ph);
    });
  }

  Positions positionsOf(const XMLElement& vertices) const {
    const XMLElement* source = nullptr;
    forEachChild(vertices, "input", [&](const XMLElement& input) {
      if (input.Attribute("semantic", "POSITION")) source = &target(input, "source");
    });
    if (source == nullptr) place_.refuse("expected an input POSITION", vertices);
    return Positions(*source, place_);
  }

  /// The positions that a list of indices names.
  std::vector<Vec3> pointsOf(const XMLElement& p, std::size_t stride, std::size_t offset,
                             const Positions& positions) const {
    const std::vector<long> indices = wholeNumbers(p, place_);
    std::vector<Vec3> points;
    for (std::size_t k = offset; k < indices.size(); k += stride) {
      if (indices[k] < 0 || static_cast<std::size_t>(indices[k]) >= positions.count()) {
        place_.refuse("expected an index from 0 to " + std::to_string(positions.count()) +
                          ", exclusive (got " + std::to_string(indices[k]) + ")",
                      p);
      }
      points.push_back(positions.at(static_cast<std::size_t>(indices[k])));
    }
    return points;
  }

  /// Adds the triangles of one list of points. \param sizes  of its polygons, of a polylist.
  void add(const XMLElement& faces, const std::vector<Vec3>& points,
           const std::vector<std::size_t>& sizes) {
    if (isNamed(faces, "polylist")) {
      std::size_t first = 0;
      for (const std::size_t size : sizes) {
        if (size > points.size() - first) place_.refuse("expected as many as vcount says", faces);
        addFan(points, first, size);
        first += size;
      }
    } else if (isNamed(faces, "triangles")) {
      if (points.size() % 3 != 0) place_.refuse("expected three corners a triangle", faces);
      for (std::size_t k = 0; k < points.size(); k += 3) addFan(points, k, 3);
    } else if (isNamed(faces, "tristrips")) {
      for (std::size_t k = 2; k < points.size(); ++k) {
        const std::size_t turned = k % 2;  // every second one turns the other way
        addTriangle(points[k - 2 + turned], points[k - 1 - turned], points[k]);
      }
    } else {
      addFan(points, 0, points.size());
    }
  }

  void addFan(const std::vector<Vec3>& points, std::size_t first, std::size_t size) {
    for (std::size_t k = 2; k < size; ++k) {
      addTriangle(points[first], points[first + k - 1], points[first + k]);
    }
  }

  void addTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    if (corners_.size() == 3 * kMostTriangles) refuseTriangleCount(place_);
    for (const Vec3& x : {a, b, c}) corners_.push_back(x);
  }

  const std::unordered_map<std::string, const XMLElement*>& byId_;
  const Place& place_;
  Corners corners_;
};

/// A whole file: its scene, and the geometries in it.
class DaeFile {
 public:
  DaeFile(const std::string& bytes, const std::string& path) : place_(path) {
    if (document_.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
      place_.refuse("expected a Collada file (XML that is malformed)", document_.ErrorLineNum());
    }
    const XMLElement* root = document_.RootElement();
    if (root == nullptr || !isNamed(*root, "COLLADA")) {
      place_.refuse("expected a Collada file: an element <COLLADA>");
    }
    root_ = root;
    findIds(*root);
    if (const XMLElement* asset = root->FirstChildElement("asset")) {
      if (const XMLElement* unit = asset->FirstChildElement("unit")) {
        metre_ = unit->DoubleAttribute("meter", 1.0);
        if (!(std::isfinite(metre_) && metre_ > 0.0)) {
          place_.refuse("expected a length in metres, > 0", *unit);
        }
      }
    }
  }

  Triangles read() {
    if (const XMLElement* scene = visualScene()) {
      forEachChild(*scene, "node",
                   [&](const XMLElement& node) { visit(node, Eigen::Affine3d::Identity()); });
    } else {
      forEachChild(*root_, "library_geometries", [&](const XMLElement& library) {
        forEachChild(library, "geometry", [&](const XMLElement& geometry) {
          instantiate(geometry, Eigen::Affine3d::Identity());
        });
      });
    }
    for (Vec3& x : corners_) {
      x *= metre_;
      if (!x.allFinite()) place_.refuse("expected finite positions");
    }
    return weld(std::move(corners_));
  }

 private:
  /// Depth is bounded by the parser.
  void findIds(const XMLElement& element) {
    if (const char* id = element.Attribute("id")) byId_.emplace(id, &element);
    for (const XMLElement* it = element.FirstChildElement(); it != nullptr;
         it = it->NextSiblingElement()) {
      findIds(*it);
    }
  }

  /// The element that an attribute `url` names; nullptr if there is none of that name.
  const XMLElement* targetOf(const XMLElement& element, const char* name) const {
    const char* url = element.Attribute("url");
    const auto found = byId_.find(url != nullptr && *url == '#' ? url + 1 : "");
    if (found == byId_.end() || !isNamed(*found->second, name)) return nullptr;
    return found->second;
  }

  /// The scene of the file, or the first one of its library; nullptr if there is none.
  const XMLElement* visualScene() const {
    if (const XMLElement* scene = root_->FirstChildElement("scene")) {
      if (const XMLElement* instance = scene->FirstChildElement("instance_visual_scene")) {
        const XMLElement* found = targetOf(*instance, "visual_scene");
        if (found == nullptr) place_.refuse("no such visual_scene", *instance);
        return found;
      }
    }
    const XMLElement* library = root_->FirstChildElement("library_visual_scenes");
    return library != nullptr ? library->FirstChildElement("visual_scene") : nullptr;
  }

  void visit(const XMLElement& node, Eigen::Affine3d transform) {
    if (++visits_ > kMostNodes || depth_ > kDeepest) {
      place_.refuse("expected at most " + std::to_string(kMostNodes) + " nodes, " +
                        std::to_string(kDeepest) + " deep",
                    node);
    }
    ++depth_;
    for (const XMLElement* it = node.FirstChildElement(); it != nullptr;
         it = it->NextSiblingElement()) {
      if (isNamed(*it, "node")) {
        visit(*it, transform);
      } else if (isNamed(*it, "instance_node")) {
        const XMLElement* other = targetOf(*it, "node");
        if (other == nullptr) place_.refuse("no such node", *it);
        visit(*other, transform);
      } else if (isNamed(*it, "instance_geometry")) {
        const XMLElement* geometry = targetOf(*it, "geometry");
        if (geometry == nullptr) place_.refuse("no such geometry", *it);
        instantiate(*geometry, transform);
      } else {
        transform = transform * transformOf(*it, place_);
      }
    }
    --depth_;
  }

  /// Adds the triangles of a geometry where a node has it.
  void instantiate(const XMLElement& geometry, const Eigen::Affine3d& transform) {
    const XMLElement* mesh = geometry.FirstChildElement("mesh");
    if (mesh == nullptr) return;
    auto known = meshes_.find(mesh);
    if (known == meshes_.end()) {
      known = meshes_.emplace(mesh, DaeMesh(byId_, place_).read(*mesh)).first;
    }
    if (corners_.size() + known->second.size() > 3 * kMostTriangles) {
      refuseTriangleCount(place_);
    }
    for (const Vec3& x : known->second) corners_.push_back(transform * x);
  }

  static constexpr int kDeepest = 200;

  Place place_;
  tinyxml2::XMLDocument document_;
  const XMLElement* root_ = nullptr;
  std::unordered_map<std::string, const XMLElement*> byId_;
  std::unordered_map<const XMLElement*, Corners> meshes_;
  double metre_ = 1.0;  ///< length unit of the file [m]
  std::size_t visits_ = 0;
  int depth_ = 0;
  Corners corners_;
};

}  // namespace

Triangles parseDae(const std::string& bytes, const std::string& path) {
  return DaeFile(bytes, path).read();
}

}  // namespace cloth_sim
