#pragma once
/// \file The shapes of obstacles. A new shape is a file in `shapes/` and a row of `Shape`; see
/// shape_contract.h.

#include <string>
#include <type_traits>
#include <variant>

#include "cloth_sim/contact/shapes/bounds.h"
#include "cloth_sim/contact/shapes/box.h"
#include "cloth_sim/contact/shapes/capsule.h"
#include "cloth_sim/contact/shapes/cylinder.h"
#include "cloth_sim/contact/shapes/mesh.h"
#include "cloth_sim/contact/shapes/plane.h"
#include "cloth_sim/contact/shapes/sphere.h"

namespace cloth_sim {

/// Any shape. Saved states store the number of the row: new rows go to the end.
using Shape = std::variant<PlaneShape,     //
                           SphereShape,    //
                           CapsuleShape,   //
                           BoxShape,       //
                           BoundsShape,    //
                           CylinderShape,  //
                           MeshShape>;

/// One of each, in the order of the rows, with its default dimensions.
const std::vector<Shape>& allShapes();
/// The names of a shape for `type` in scene files, the preferred one first.
std::vector<std::string> typeNames(const Shape& shape);
/// The primitives that viewers draw.
std::vector<DrawnPart> drawing(const Shape& shape);
/// Radius of the ball around the position that fits a handle to drag the shape by [m]; absent if
/// the shape cannot be dragged.
std::optional<double> handleRadius(const Shape& shape);
/// The surface whose sharp corners and edges the cloth meets with its faces and edges, too; null if
/// only particles meet the shape.
std::shared_ptr<const TriangleSurface> sharpSurface(const Shape& shape);
/// Returns "radius: expected a length > 0" for the first bad dimension, "" if there is none.
std::string validationError(const Shape& shape);

template <class S, class Variant>
struct IsAlternative;
template <class S, class... Row>
struct IsAlternative<S, std::variant<Row...>> : std::disjunction<std::is_same<S, Row>...> {};

/// Calls `visit(name, value)` for each dimension of a shape of known type, in the order of
/// `keys()`.
template <class S, class Visit>
void forEachKey(S& shape, Visit visit) {
  std::apply([&](const auto&... key) { (visit(key.name, shape.*key.member), ...); }, S::keys());
}

/// Saves or loads the dimensions of a shape.
template <class Archive, class S, std::enable_if_t<IsAlternative<S, Shape>::value, int> = 0>
void serialize(Archive& archive, S& shape) {
  forEachKey(shape, [&](const char* /*name*/, auto& value) { archive(value); });
}

/// Returns `function(geometry)` for the geometry of the shape. This chooses the type once for each
/// call, outside of the function's loop over particles.
template <class Function>
decltype(auto) visitGeometry(const Shape& shape, const Quat& orientation, double margin,
                             Function&& function) {
  return std::visit(
      [&](const auto& known) -> decltype(auto) {
        return known.visitGeometry(orientation, margin, function);
      },
      shape);
}

}  // namespace cloth_sim
