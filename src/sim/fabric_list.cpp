#include "cloth_sim/sim/fabric_list.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "cloth_sim/cloth/fabric_sheet.h"

namespace cloth_sim {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kGravity = 9.81;  ///< [m/s^2]

const FabricValue* find(const FabricSheet& sheet, const char* key) {
  for (const FabricValue& value : sheet.values) {
    if (value.key == key) return &value;
  }
  return nullptr;
}

Json valuesJson(const FabricSheet& sheet) {
  Json values = Json::object();
  for (const FabricQuantity& quantity : fabricQuantities()) {
    const FabricValue* value = find(sheet, quantity.key);
    if (!value) continue;
    values[quantity.key] = {{"value", value->value},     {"unit", quantity.unit},
                            {"low", value->low},         {"high", value->high},
                            {"assumed", value->assumed}, {"source", value->source}};
  }
  return values;
}

}  // namespace

std::string fabricListJson() {
  Json fabrics = Json::array();
  for (const FabricSheet& sheet : fabricSheets()) {
    const Fabric fabric = fabricPreset(sheet.name);
    const double length = std::cbrt(fabric.bending / (fabric.arealDensity * kGravity));
    fabrics.push_back({{"name", sheet.name},
                       {"description", sheet.description},
                       {"elasto_gravity_length_m", length},
                       {"values", valuesJson(sheet)}});
  }
  return Json{{"fabrics", fabrics}}.dump(2);
}

}  // namespace cloth_sim
