#include "cloth_sim/cloth/fabric.h"

#include <stdexcept>

#include "cloth_sim/cloth/fabric_sheet.h"

namespace cloth_sim {

namespace {

double valueOf(const FabricSheet& sheet, const std::string& key) {
  for (const FabricValue& value : sheet.values) {
    if (value.key == key) return value.value;
  }
  throw std::logic_error("the sheet of '" + sheet.name + "' has no " + key);
}

Fabric fabricOf(const FabricSheet& sheet) {
  Fabric fabric;
  fabric.name = sheet.name;
  fabric.source = sheet.description + " (docs/fabrics.md has the source of each value)";
  for (const FabricQuantity& quantity : fabricQuantities()) {
    if (quantity.in) quantity.in(fabric) = valueOf(sheet, quantity.key);
  }
  return fabric;
}

}  // namespace

std::vector<std::string> fabricPresetNames() {
  std::vector<std::string> names;
  for (const FabricSheet& sheet : fabricSheets()) names.push_back(sheet.name);
  return names;
}

Fabric fabricPreset(const std::string& name) {
  std::string known;
  for (const FabricSheet& sheet : fabricSheets()) {
    if (sheet.name == name) return fabricOf(sheet);
    known += (known.empty() ? "" : ", ") + sheet.name;
  }
  throw std::invalid_argument("no fabric '" + name + "', there are " + known);
}

}  // namespace cloth_sim
