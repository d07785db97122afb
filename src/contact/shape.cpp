#include "cloth_sim/contact/shape.h"

#include <cmath>

namespace cloth_sim {
namespace {

bool isGood(double value) { return std::isfinite(value) && value > 0.0; }
bool isGood(const Vec3& size) { return size.allFinite() && size.minCoeff() > 0.0; }
bool isGood(const std::optional<Vec3>& scale) {
  return !scale || (scale->allFinite() && scale->cwiseAbs().minCoeff() > 0.0);
}

bool isGood(bool /*isOn*/) { return true; }
bool isGood(const SurfaceFile& file) { return file.surface != nullptr; }

std::string textOfGood(const SurfaceFile& /*file*/) { return "a file of triangles"; }
std::string textOfGood(const std::optional<Vec3>& /*scale*/) { return "numbers other than 0"; }
template <class Length>
std::string textOfGood(const Length& /*length*/) {
  return "a length > 0";
}

template <std::size_t... kRow>
std::vector<Shape> oneOfEach(std::index_sequence<kRow...> /*rows*/) {
  return {Shape(std::in_place_index<kRow>)...};
}

}  // namespace

const std::vector<Shape>& allShapes() {
  static const std::vector<Shape> shapes =
      oneOfEach(std::make_index_sequence<std::variant_size_v<Shape>>());
  return shapes;
}

std::vector<std::string> typeNames(const Shape& shape) {
  return std::visit(
      [](const auto& known) {
        return std::vector<std::string>(known.kTypes.begin(), known.kTypes.end());
      },
      shape);
}

std::vector<DrawnPart> drawing(const Shape& shape) {
  return std::visit([](const auto& known) { return known.drawing(); }, shape);
}

std::optional<double> handleRadius(const Shape& shape) {
  return std::visit([](const auto& known) { return known.handleRadius(); }, shape);
}

std::shared_ptr<const TriangleSurface> sharpSurface(const Shape& shape) {
  return std::visit([](const auto& known) { return known.sharpSurface(); }, shape);
}

std::string validationError(const Shape& shape) {
  std::string error;
  const auto check = [&error](const char* name, const auto& value) {
    if (error.empty() && !isGood(value)) error = name + (": expected " + textOfGood(value));
  };
  std::visit([&check](const auto& known) { forEachKey(known, check); }, shape);
  return error;
}

}  // namespace cloth_sim
