#include "cloth_sim/ros/shading.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cloth_sim {
namespace {

constexpr std::size_t kMapSize = 7;

// The upper three quarters of matplotlib's viridis: its dark end would hide the shading.
constexpr std::array<std::array<float, 3>, kMapSize> kStrainMap{{{0.230f, 0.322f, 0.546f},
                                                                 {0.173f, 0.449f, 0.558f},
                                                                 {0.128f, 0.567f, 0.551f},
                                                                 {0.158f, 0.684f, 0.502f},
                                                                 {0.369f, 0.789f, 0.383f},
                                                                 {0.678f, 0.864f, 0.190f},
                                                                 {0.993f, 0.906f, 0.144f}}};

std_msgs::ColorRGBA blend(const std_msgs::ColorRGBA& from, const std_msgs::ColorRGBA& to,
                          float fraction) {
  return makeColour(from.r + fraction * (to.r - from.r), from.g + fraction * (to.g - from.g),
                    from.b + fraction * (to.b - from.b), from.a + fraction * (to.a - from.a));
}

}  // namespace

std_msgs::ColorRGBA strainColour(double fraction) {
  const double inMap = std::clamp(fraction, 0.0, 1.0) * (kMapSize - 1);
  const auto index = std::min(static_cast<std::size_t>(inMap), kMapSize - 2);
  const auto& low = kStrainMap[index];
  const auto& high = kStrainMap[index + 1];
  return blend(makeColour(low[0], low[1], low[2]), makeColour(high[0], high[1], high[2]),
               static_cast<float>(inMap - static_cast<double>(index)));
}

std_msgs::ColorRGBA contactColour(double newtons) {
  constexpr double kLeast = 1e-5;  // [N]
  constexpr double kDecades = 3.0;
  const double part = std::log10(std::max(newtons, kLeast) / kLeast) / kDecades;
  return blend(makeColour(0.0f, 0.95f, 1.0f), makeColour(1.0f, 0.0f, 0.75f),
               static_cast<float>(std::min(part, 1.0)));
}

StrainColours::StrainColours(double range, const std_msgs::ColorRGBA& wash, float part)
    : scale_(static_cast<float>(kLast / range)) {
  for (std::size_t step = 0; step < kCount; ++step) {
    colours_[step] = blend(strainColour(static_cast<double>(step) / kLast), wash, part);
  }
}

}  // namespace cloth_sim
