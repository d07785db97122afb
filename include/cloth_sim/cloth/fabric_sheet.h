#pragma once
/// \file Sheets of the built-in fabrics: each value with its unit, its spread and its source.

#include <string>
#include <vector>

#include "cloth_sim/cloth/fabric.h"

namespace cloth_sim {

/// A quantity of fabrics that sheets list.
struct FabricQuantity {
  const char* key;   ///< as in `cloth.fabric` of a scene, if the model uses it
  const char* unit;  ///< "1": none
  /// Returns the value in a fabric; null: presets do not set it.
  double& (*in)(Fabric& fabric);
};

/// Returns the quantities in the order of the sheets.
const std::vector<FabricQuantity>& fabricQuantities();

/// A value of a fabric, how far it varies, and where it is from.
struct FabricValue {
  std::string key;      ///< of its FabricQuantity
  double value = 0.0;   ///< in the unit of its FabricQuantity
  double low = 0.0;     ///< end of the spread, <= value
  double high = 0.0;    ///< end of the spread, >= value
  bool assumed = true;  ///< nobody measured it on such a fabric
  std::string source;   ///< of the value and of the spread
};

/// A built-in fabric with the pedigree of its values.
struct FabricSheet {
  std::string name;
  std::string description;  ///< which cloth it is
  std::vector<FabricValue> values;
};

/// Returns the sheets of the built-in fabrics, sorted by name.
const std::vector<FabricSheet>& fabricSheets();

}  // namespace cloth_sim
