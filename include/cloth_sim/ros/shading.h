#pragma once
/// \file The colours of a cloth on a screen, shared by the markers and the rviz display.

#include <std_msgs/ColorRGBA.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace cloth_sim {

inline std_msgs::ColorRGBA makeColour(float r, float g, float b, float a = 1.0f) {
  std_msgs::ColorRGBA result;
  result.r = r;
  result.g = g;
  result.b = b;
  result.a = a;
  return result;
}

/// Returns the colour of a strain, on a perceptually uniform map from blue over green to yellow.
/// \param fraction  strain over the range of the map [-]; values outside 0 to 1 are clamped.
std_msgs::ColorRGBA strainColour(double fraction);

/// Returns the colour of a contact between layers by its force, on a logarithmic scale: from cyan
/// at 0.01 mN to magenta at 10 mN. Neither is a colour of the cloth.
std_msgs::ColorRGBA contactColour(double newtons);

/// Half the length of the line across the layers that shows a contact [m].
constexpr double kContactReach = 0.006;
/// Width of that line [m].
constexpr double kContactWidth = 0.0015;

/// Table of `strainColour` in even steps, so that a vertex costs a look-up instead of a blend.
class StrainColours {
 public:
  /// \param range  strain of the last colour [-], > 0
  /// \param wash   colour that is mixed into all others
  /// \param part   fraction of `wash` in the mix, 0 to 1
  explicit StrainColours(double range, const std_msgs::ColorRGBA& wash = {}, float part = 0.0f);

  /// \param strain  >= 0 [-]
  const std_msgs::ColorRGBA& operator()(float strain) const {
    return colours_[static_cast<std::size_t>(std::min(kLast, strain * scale_ + 0.5f))];
  }

 private:
  static constexpr std::size_t kCount = 256;
  static constexpr float kLast = kCount - 1;

  std::array<std_msgs::ColorRGBA, kCount> colours_;
  float scale_ = 0.0f;
};

/// Returns the factor of a colour, 0.3 to 1.05, under light from above and slightly from the side,
/// soft all around the surface (half Lambert). Lighting is part of the colours because rviz does
/// not light vertices that have colours of their own.
/// \param normal  unit normal of the side of the surface that is seen.
inline float brightness(const Eigen::Vector3f& normal) {
  const float cosine = normal.dot(Eigen::Vector3f(0.450586f, -0.350456f, 0.821068f));
  const float half = 0.5f + 0.5f * cosine;
  return 0.30f + 0.75f * half * half;
}

/// Returns `base` times `factor`, opaque and no brighter than white.
inline std_msgs::ColorRGBA shaded(const std_msgs::ColorRGBA& base, float factor) {
  static_assert(sizeof(std_msgs::ColorRGBA) == 4 * sizeof(float));
  std_msgs::ColorRGBA result;
  Eigen::Map<Eigen::Array4f>(&result.r) =
      (factor * Eigen::Map<const Eigen::Array4f>(&base.r)).min(1.0f);
  result.a = 1.0f;
  return result;
}

}  // namespace cloth_sim
