#include "cloth_sim/cloth/fabric.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace cloth_sim {
namespace {

TEST(Fabric, NamesAreSortedAndKnown) {
  const std::vector<std::string> names = fabricPresetNames();
  EXPECT_EQ(names, (std::vector<std::string>{"cotton", "denim", "interlock", "polyester", "silk"}));
  for (const std::string& name : names) EXPECT_EQ(fabricPreset(name).name, name);
}

TEST(Fabric, DefaultsAreThoseOfCotton) {
  const Fabric custom;
  const Fabric cotton = fabricPreset("cotton");
  EXPECT_EQ(custom.arealDensity, cotton.arealDensity);
  EXPECT_EQ(custom.tensileWarp, cotton.tensileWarp);
  EXPECT_EQ(custom.tensileWeft, cotton.tensileWeft);
  EXPECT_EQ(custom.shear, cotton.shear);
  EXPECT_EQ(custom.bending, cotton.bending);
  EXPECT_EQ(custom.damping, cotton.damping);
  EXPECT_EQ(custom.friction, cotton.friction);
  EXPECT_EQ(custom.thickness, cotton.thickness);
}

TEST(Fabric, EveryPresetIsPhysicalAndSaysItsSource) {
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
    EXPECT_NE(fabric.source.find("20"), std::string::npos) << "no year";
    EXPECT_NE(fabric.source.find("chosen"), std::string::npos) << "nobody measured its damping";
  }
}

TEST(Fabric, UnknownNameListsTheKnown) {
  try {
    fabricPreset("chainmail");
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "no fabric 'chainmail', there are cotton, denim, interlock, polyester, silk");
  }
}

}  // namespace
}  // namespace cloth_sim
