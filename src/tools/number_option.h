#pragma once
/// \file Ranges of numbers on the command line.

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace cloth_sim {

/// Returns a check that refuses numbers outside of [least, most], and NaN, which CLI::Range lets
/// pass: a run for NaN seconds has no end.
inline CLI::Validator numberIn(double least, double most) {
  const CLI::Range range(least, most);
  const auto check = [range](std::string& text) {
    double value = 0.0;
    const bool isNan = CLI::detail::lexical_cast(text, value) && std::isnan(value);
    return isNan ? "Value " + text + ": expected a number" : range(text);
  };
  return {check, range.get_description()};
}

}  // namespace cloth_sim
