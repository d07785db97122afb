#pragma once
/// \file The colours of a cloth on a screen. Markers and the rviz display share them.

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

/// Colour of a strain, from 0 (or below) to 1 (or above) times the range, on a map of even
/// perceptual steps from blue over green to yellow.
std_msgs::ColorRGBA strainColour(double fraction);

/// That map in even steps: a look-up instead of a blend for each vertex.
class StrainColours {
 public:
  /// \param range  strain of the last colour [-], > 0
  /// \param wash, part  this much of that colour is mixed into all.
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

/// Light from above and a little from the side, soft all around the surface (half Lambert): rviz
/// does not light vertices with colours of their own.
/// \param x, y, z  of a unit normal towards the viewer's side of the surface, or of many.
/// \return factor of a colour, 0.3 ... 1.05, or many.
template <typename Number>
Number brightness(const Number& x, const Number& y, const Number& z) {
  const Number half = 0.5f + 0.5f * (0.450586f * x - 0.350456f * y + 0.821068f * z);
  return 0.30f + 0.75f * half * half;
}
inline float brightness(const Eigen::Vector3f& normal) {
  return brightness(normal.x(), normal.y(), normal.z());
}

/// Opaque, no brighter than white.
inline std_msgs::ColorRGBA shaded(const std_msgs::ColorRGBA& base, float factor) {
  static_assert(sizeof(std_msgs::ColorRGBA) == 4 * sizeof(float));
  std_msgs::ColorRGBA result;
  Eigen::Map<Eigen::Array4f>(&result.r) =
      (factor * Eigen::Map<const Eigen::Array4f>(&base.r)).min(1.0f);
  result.a = 1.0f;
  return result;
}

}  // namespace cloth_sim
