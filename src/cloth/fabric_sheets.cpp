#include "cloth_sim/cloth/fabric_sheet.h"

namespace cloth_sim {

const std::vector<FabricQuantity>& fabricQuantities() {
  static const std::vector<FabricQuantity> all{
      {"areal_density", "kg/m^2", [](Fabric& f) -> double& { return f.arealDensity; }},
      {"tensile_warp", "N/m", [](Fabric& f) -> double& { return f.tensileWarp; }},
      {"tensile_weft", "N/m", [](Fabric& f) -> double& { return f.tensileWeft; }},
      {"shear", "N/m", [](Fabric& f) -> double& { return f.shear; }},
      {"bending", "N m", [](Fabric& f) -> double& { return f.bending; }},
      {"bending_hysteresis", "N", nullptr},
      {"damping", "s", [](Fabric& f) -> double& { return f.damping; }},
      {"friction", "1", [](Fabric& f) -> double& { return f.friction; }},
      {"thickness", "m", [](Fabric& f) -> double& { return f.thickness; }},
      {"tear_energy.warp", "J/m", [](Fabric& f) -> double& { return f.tearEnergy.warp; }},
      {"tear_energy.weft", "J/m", [](Fabric& f) -> double& { return f.tearEnergy.weft; }},
      {"tear_energy.bias", "J/m", [](Fabric& f) -> double& { return f.tearEnergy.bias; }},
  };
  return all;
}

namespace {

using Source = std::string;

constexpr bool kMeasured = false;  ///< on a fabric of this kind
constexpr bool kAssumed = true;

// Keys of docs/fabrics.md, which has the references in full.
const char* const kOne = "[Clyde 2017]";
const char* const kOneQuarter = "[Clyde 2017]; one specimen, a quarter either way assumed";
const char* const kWang = "[Wang 2011]";

FabricValue damping() {
  return {"damping", 0.0, 0.0, 0.0, kAssumed, "none: no measured value is known"};
}

FabricValue friction() { return {"friction", 0.3, 0.2, 0.5, kAssumed, "chosen for all fabrics"}; }

/// Returns the bending rigidity of fabrics of the same density.
/// \param which  the percentile that is taken, and why.
FabricValue bendingLikeOthers(double value, double low, double high, const Source& which) {
  return {"bending",
          value,
          low,
          high,
          kAssumed,
          "[Feng 2022]: " + which +
              " of the fabrics within 15 % of this density; spread: 5th to 95th percentile"};
}

/// Returns a tear energy in proportion to the mass: 150 J/m per kg/m^2.
/// \param key   without "tear_energy.".
FabricValue tearEnergy(const std::string& key, double value, const Source& note = "") {
  return {"tear_energy." + key,
          value,
          0.5 * value,
          2.0 * value,
          kAssumed,
          "150 J/m per kg/m^2, about that of the cotton twill below" + note +
              "; spread: half to twice"};
}

/// Returns the energy of tears along the bias of a weave.
FabricValue wovenBias(double value) {
  return tearEnergy("bias", value, ", 1.4 times for threads of both directions");
}

/// Returns the energy of tears along the bias of a knit.
FabricValue knittedBias(double value) {
  return tearEnergy("bias", value, " (a knit ladders, which is not modelled)");
}

FabricSheet cotton() {
  return {"cotton",
          "cotton lawn, a light plain weave",
          {{"areal_density", 0.1036, 0.1036, 0.1503, kMeasured,
            Source(kOne) + "; spread: to [Penava 2014]"},
           {"tensile_warp", 4501.0, 3955.0, 10354.0, kMeasured,
            Source(kOne) + "; spread: [Penava 2014]"},
           {"tensile_weft", 2800.0, 2800.0, 10354.0, kMeasured,
            Source(kOne) + "; spread: to [Penava 2014]"},
           {"shear", 97.0, 73.0, 121.0, kMeasured, kOneQuarter},
           bendingLikeOthers(5e-6, 0.68e-6, 12.1e-6, "median"),
           {"bending_hysteresis", 1.216e-3, 0.91e-3, 1.52e-3, kMeasured,
            "[Matsudaira 2015], a broadcloth that bends with 11.57e-6 N m; one specimen, a quarter "
            "either way assumed"},
           damping(),
           friction(),
           {"thickness", 0.18e-3, 0.18e-3, 0.318e-3, kMeasured,
            Source(kOne) + "; spread: to [Penava 2014]"},
           tearEnergy("warp", 15.0),
           tearEnergy("weft", 15.0),
           wovenBias(21.0)}};
}

FabricSheet denim() {
  const Source file = Source(kWang) + " 11oz-black-denim";
  return {"denim",
          "stretch denim of 11 oz/yd^2, 99 % cotton and 1 % spandex",
          {{"areal_density", 0.324, 0.324, 0.4, kMeasured, file + "; spread: to [Clyde 2017]"},
           {"tensile_warp", 2028.0, 2028.0, 5959.0, kMeasured,
            file + " (2 C); spread: to [Clyde 2017]"},
           {"tensile_weft", 411.0, 411.0, 3163.0, kMeasured,
            file + " (2 C, along the spandex); spread: to [Clyde 2017], without spandex"},
           {"shear", 53.4, 53.4, 808.0, kMeasured, file + "; spread: to [Clyde 2017]"},
           {"bending", 80e-6, 64.2e-6, 97e-6, kMeasured,
            file + ", in three directions, at the smallest curvature"},
           damping(),
           friction(),
           {"thickness", 0.66e-3, 0.53e-3, 0.66e-3, kMeasured,
            "[Clyde 2017], a denim of 0.4 kg/m^2; spread: to that in proportion to the mass"},
           tearEnergy("warp", 49.0),
           tearEnergy("weft", 49.0),
           wovenBias(69.0)}};
}

FabricSheet interlock() {
  const Source file = Source(kWang) + " gray-interlock";
  return {"interlock",
          "interlock knit of a T-shirt, 60 % cotton and 40 % polyester; warp: along the wales",
          {{"areal_density", 0.187, 0.14, 0.234, kMeasured,
            file + "; one specimen, a quarter either way assumed"},
           {"tensile_warp", 69.0, 69.0, 827.0, kMeasured,
            file + " (2 C at zero strain; stiffer when stretched, which is not modelled); spread: "
                   "to the stiffest sample"},
           {"tensile_weft", 33.0, 33.0, 279.0, kMeasured,
            file + " (2 C at zero strain); spread: to the stiffest sample"},
           {"shear", 36.9, 22.8, 44.2, kMeasured, file + "; spread: of its samples"},
           {"bending", 20e-6, 14.3e-6, 24.7e-6, kMeasured,
            file + ", in three directions, at the smallest curvature"},
           damping(),
           friction(),
           {"thickness", 0.7e-3, 0.5e-3, 1e-3, kAssumed, "chosen"},
           tearEnergy("warp", 28.0),
           tearEnergy("weft", 28.0),
           knittedBias(28.0)}};
}

FabricSheet jersey() {
  const Source knits = Source(kWang) +
                       ": median of its three cotton knits (interlock, ponte roma, rib), whose "
                       "range is the spread";
  return {"jersey",
          "single jersey of a T-shirt; warp: along the wales",
          {{"areal_density", 0.16, 0.13, 0.2, kAssumed, "chosen: the usual weight of a T-shirt"},
           {"tensile_warp", 88.0, 69.0, 130.0, kAssumed, knits + " (2 C at zero strain)"},
           {"tensile_weft", 62.0, 33.0, 86.0, kAssumed, knits + " (2 C at zero strain)"},
           {"shear", 36.9, 31.9, 83.2, kAssumed, knits},
           bendingLikeOthers(6.6e-6, 2.1e-6, 42.7e-6, "lower quartile, because a jersey is soft,"),
           damping(),
           friction(),
           {"thickness", 0.5e-3, 0.4e-3, 0.7e-3, kAssumed, "chosen"},
           tearEnergy("warp", 24.0),
           tearEnergy("weft", 24.0),
           knittedBias(24.0)}};
}

FabricSheet linen() {
  const Source perMass =
      "in proportion to the mass, between the cotton and the canvas of [Clyde 2017]";
  return {"linen",
          "table linen, a plain weave",
          {{"areal_density", 0.2, 0.16, 0.24, kAssumed, "chosen: the usual weight of table linen"},
           {"tensile_warp", 7900.0, 7140.0, 8690.0, kAssumed, perMass},
           {"tensile_weft", 3200.0, 1930.0, 5410.0, kAssumed, perMass},
           {"shear", 260.0, 187.0, 362.0, kAssumed, perMass},
           bendingLikeOthers(34.9e-6, 1.8e-6, 53.7e-6, "upper quartile, because linen is stiff,"),
           damping(),
           friction(),
           {"thickness", 0.36e-3, 0.35e-3, 0.36e-3, kAssumed, perMass},
           tearEnergy("warp", 30.0),
           tearEnergy("weft", 30.0),
           wovenBias(42.0)}};
}

FabricSheet polyester() {
  const Source file = Source(kWang) + " white-dots-on-blk";
  const Source bound =
      " (2 C, a lower bound: the data are saturated there); spread: from [Penava "
      "2014] to the stiffest sample";
  return {"polyester",
          "polyester cloth for tables, a weave",
          {{"areal_density", 0.128, 0.128, 0.1646, kMeasured, file + "; spread: to [Penava 2014]"},
           {"tensile_warp", 4054.0, 2942.0, 4343.0, kMeasured, file + bound},
           {"tensile_weft", 4004.0, 1298.0, 4216.0, kMeasured, file + bound},
           {"shear", 19.2, 16.9, 101.0, kMeasured, file + "; spread: of its samples"},
           bendingLikeOthers(7.5e-6, 2.87e-6, 21.4e-6,
                             "median (the 31e-6 to 52e-6 of [Wang 2011] are beyond each of them)"),
           {"bending_hysteresis", 6.86e-5, 5.1e-5, 8.6e-5, kMeasured,
            "[Matsudaira 2015], a faille that bends with 1.863e-6 N m; one specimen, a quarter "
            "either way assumed"},
           damping(),
           friction(),
           {"thickness", 0.252e-3, 0.196e-3, 0.252e-3, kMeasured,
            "[Penava 2014], a weave of 0.165 kg/m^2; spread: to that in proportion to the mass"},
           tearEnergy("warp", 19.0),
           tearEnergy("weft", 19.0),
           wovenBias(27.0)}};
}

FabricSheet silk() {
  return {"silk",
          "silk charmeuse, a light satin",
          {{"areal_density", 0.083, 0.062, 0.104, kMeasured, kOneQuarter},
           {"tensile_warp", 1790.0, 1340.0, 2240.0, kMeasured, kOneQuarter},
           {"tensile_weft", 774.0, 580.0, 968.0, kMeasured, kOneQuarter},
           {"shear", 51.0, 38.0, 64.0, kMeasured, kOneQuarter},
           bendingLikeOthers(3e-6, 0.67e-6, 16.2e-6, "lower quartile, because silk is soft,"),
           damping(),
           friction(),
           {"thickness", 0.18e-3, 0.135e-3, 0.225e-3, kMeasured, kOneQuarter},
           tearEnergy("warp", 12.0),
           tearEnergy("weft", 12.0),
           wovenBias(17.0)}};
}

FabricSheet towel() {
  const Source ground = "that of cotton lawn, as if the loops of the pile bore nothing";
  return {"towel",
          "terry towel with loops on both sides",
          {{"areal_density", 0.45, 0.35, 0.6, kAssumed, "chosen: the usual weight of a bath towel"},
           {"tensile_warp", 4500.0, 2800.0, 10354.0, kAssumed, ground},
           {"tensile_weft", 2800.0, 2800.0, 10354.0, kAssumed, ground},
           {"shear", 97.0, 73.0, 121.0, kAssumed, ground},
           bendingLikeOthers(21.4e-6, 6.24e-6, 80.8e-6,
                             "lower quartile, because the pile adds mass rather than rigidity,"),
           damping(),
           friction(),
           {"thickness", 2.5e-3, 1.5e-3, 4e-3, kAssumed, "chosen"},
           tearEnergy("warp", 67.0),
           tearEnergy("weft", 67.0),
           wovenBias(94.0)}};
}

FabricSheet wool() {
  return {"wool",
          "wool coating, a thick weave",
          {{"areal_density", 0.4806, 0.2348, 0.4806, kMeasured,
            Source(kOne) + "; spread: from the thinner wool of [Penava 2014]"},
           {"tensile_warp", 2840.0, 2840.0, 12417.0, kMeasured,
            Source(kOne) + "; spread: to [Penava 2014]"},
           {"tensile_weft", 2931.0, 2931.0, 4629.0, kMeasured,
            Source(kOne) + "; spread: to [Penava 2014]"},
           {"shear", 237.0, 178.0, 296.0, kMeasured, kOneQuarter},
           bendingLikeOthers(43.4e-6, 6.24e-6, 82.6e-6, "median"),
           damping(),
           friction(),
           {"thickness", 1.28e-3, 0.568e-3, 1.28e-3, kMeasured,
            Source(kOne) + "; spread: from the thinner wool of [Penava 2014]"},
           tearEnergy("warp", 72.0),
           tearEnergy("weft", 72.0),
           wovenBias(101.0)}};
}

}  // namespace

const std::vector<FabricSheet>& fabricSheets() {
  static const std::vector<FabricSheet> all{cotton(),    denim(), interlock(), jersey(), linen(),
                                            polyester(), silk(),  towel(),     wool()};
  return all;
}

}  // namespace cloth_sim
