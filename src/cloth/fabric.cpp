#include "cloth_sim/cloth/fabric.h"

#include <stdexcept>

namespace cloth_sim {

namespace {

// Values that no source gives for these fabrics, chosen for all of them.
constexpr double kChosenDamping = 0.0;  // [s]
constexpr double kChosenFriction = 0.3;

const char* const kChosen = "; damping and friction chosen";

/// The built-in fabrics, sorted by name.
const std::vector<Fabric>& presets() {
  // Wang et al. give a stiffness C for each direction of strain. Their solver applies 2 C, so the
  // tensile stiffness is 2 C.
  static const std::string wang =
      "Wang, O'Brien, Ramamoorthi 2011, Data-driven elastic models for cloth, ACM TOG 30(4):71, "
      "doi 10.1145/2010324.1964966, file ";
  static const std::string cipc =
      "Li, Kaufman, Jiang 2021, Codimensional incremental potential contact, ACM TOG 40(4), "
      "anisotropic table of the code release";
  // Density, warp, weft, shear, bending; damping, friction, thickness.
  static const std::vector<Fabric> all{
      {"cotton", 0.1036, 4501.0, 2800.0, 97.0, 5e-6, kChosenDamping, kChosenFriction, 0.18e-3,
       cipc + "; bending: textbook range (Kawabata 1980), not measured on this fabric" + kChosen},
      {"denim", 0.324, 2028.0, 411.0, 53.4, 80e-6, kChosenDamping, kChosenFriction, 0.66e-3,
       wang +
           "11oz-black-denim (tensile 2 C, weft along the spandex; bending 64.2e-6 to 97e-6); "
           "thickness: Li, Kaufman, Jiang 2021" +
           kChosen},
      {"interlock", 0.187, 69.0, 33.0, 36.9, 20e-6, kChosenDamping, kChosenFriction, 0.7e-3,
       wang +
           "gray-interlock (tensile 2 C at zero strain: about ten times stiffer by 17 % strain, "
           "which is not modelled; bending 14.3e-6 to 24.7e-6); thickness chosen" +
           kChosen},
      {"polyester", 0.128, 4054.0, 4004.0, 19.2, 41e-6, kChosenDamping, kChosenFriction, 0.252e-3,
       wang +
           "white-dots-on-blk (tensile: a lower bound, the data are saturated there; bending "
           "31.3e-6 to 51.7e-6); thickness: Penava et al. 2014" +
           kChosen},
      {"silk", 0.083, 1790.0, 774.0, 51.0, 3e-6, kChosenDamping, kChosenFriction, 0.18e-3,
       cipc + "; bending: textbook range (Kawabata 1980), not measured on this fabric" + kChosen},
  };
  return all;
}

}  // namespace

std::vector<std::string> fabricPresetNames() {
  std::vector<std::string> names;
  for (const Fabric& fabric : presets()) names.push_back(fabric.name);
  return names;
}

Fabric fabricPreset(const std::string& name) {
  std::string known;
  for (const Fabric& fabric : presets()) {
    if (fabric.name == name) return fabric;
    known += (known.empty() ? "" : ", ") + fabric.name;
  }
  throw std::invalid_argument("no fabric '" + name + "', there are " + known);
}

}  // namespace cloth_sim
