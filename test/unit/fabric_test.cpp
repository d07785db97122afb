#include "cloth_sim/cloth/fabric.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "cloth_sim/cloth/fabric_sheet.h"

namespace cloth_sim {
namespace {

TEST(Fabric, NamesAreSortedAndKnown) {
  const std::vector<std::string> names = fabricPresetNames();
  EXPECT_EQ(names, (std::vector<std::string>{"cotton", "denim", "interlock", "jersey", "linen",
                                             "polyester", "silk", "towel", "wool"}));
  for (const std::string& name : names) EXPECT_EQ(fabricPreset(name).name, name);
}

TEST(Fabric, DefaultsAreThoseOfCotton) {
  Fabric custom;
  Fabric cotton = fabricPreset("cotton");
  for (const FabricQuantity& quantity : fabricQuantities()) {
    if (!quantity.in) continue;
    EXPECT_EQ(quantity.in(custom), quantity.in(cotton)) << quantity.key;
  }
}

TEST(Fabric, EveryPresetIsPhysical) {
  for (const std::string& name : fabricPresetNames()) {
    SCOPED_TRACE(name);
    const Fabric fabric = fabricPreset(name);
    EXPECT_GT(fabric.arealDensity, 0.0);
    EXPECT_GT(fabric.tensileWarp, 0.0);
    EXPECT_GT(fabric.tensileWeft, 0.0);
    EXPECT_GE(fabric.shear, 0.0);
    EXPECT_GE(fabric.bending, 0.0);
    EXPECT_GE(fabric.damping, 0.0);
    EXPECT_GE(fabric.friction, 0.0);
    EXPECT_GT(fabric.thickness, 0.0);
    EXPECT_TRUE(fabric.tearEnergy.isKnown());
    EXPECT_GE(fabric.tearEnergy.bias, std::min(fabric.tearEnergy.warp, fabric.tearEnergy.weft));
    EXPECT_NE(fabric.source.find("docs/fabrics.md"), std::string::npos);
  }
}

TEST(Fabric, EveryValueHasASourceAndASpreadAroundIt) {
  std::set<std::string> known;
  for (const FabricQuantity& quantity : fabricQuantities()) known.insert(quantity.key);
  for (const FabricSheet& sheet : fabricSheets()) {
    EXPECT_FALSE(sheet.description.empty()) << sheet.name;
    std::set<std::string> seen;
    for (const FabricValue& value : sheet.values) {
      SCOPED_TRACE(sheet.name + "." + value.key);
      EXPECT_EQ(known.count(value.key), 1u);
      EXPECT_TRUE(seen.insert(value.key).second) << "twice";
      EXPECT_LE(value.low, value.value);
      EXPECT_GE(value.high, value.value);
      EXPECT_FALSE(value.source.empty());
      // A reference, in brackets, or a choice that is called one.
      EXPECT_TRUE(value.assumed || value.source.find('[') != std::string::npos);
    }
  }
}

TEST(Fabric, EveryPresetHangsLikeMeasuredFabrics) {
  // 5th and 95th percentile of (B / (rho g))^(1/3) of the 618 fabrics of Feng et al. 2022. The
  // rigidity itself is compared with fabrics of the same density in test/tools/fabrics_test.py.
  for (const std::string& name : fabricPresetNames()) {
    const Fabric fabric = fabricPreset(name);
    const double length = std::cbrt(fabric.bending / (fabric.arealDensity * 9.81));
    EXPECT_GT(length, 11.5e-3) << name;
    EXPECT_LT(length, 29.5e-3) << name;
  }
}

TEST(Fabric, UnknownNameListsTheKnown) {
  try {
    fabricPreset("chainmail");
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "no fabric 'chainmail', there are cotton, denim, interlock, jersey, linen, "
                 "polyester, silk, towel, wool");
  }
}

}  // namespace
}  // namespace cloth_sim
