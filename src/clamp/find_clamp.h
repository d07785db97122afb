#pragma once
/// \file Clamps by name.

#include <string>
#include <vector>

namespace cloth_sim {

/// Returns the first clamp of that name, or null.
/// \tparam Clamps  a sequence of Clamp, const or not.
template <typename Clamps>
auto* findClamp(Clamps& clamps, const std::string& name) {
  for (auto& clamp : clamps) {
    if (clamp.spec().name == name) return &clamp;
  }
  return static_cast<decltype(&*clamps.begin())>(nullptr);
}

/// Returns the names of clamps, in their order.
template <typename Clamps>
std::vector<std::string> namesOf(const Clamps& clamps) {
  std::vector<std::string> names;
  for (const auto& clamp : clamps) names.push_back(clamp.spec().name);
  return names;
}

}  // namespace cloth_sim
