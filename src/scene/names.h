#pragma once
/// \file Lists of names in messages for people.

#include <string>
#include <vector>

namespace cloth_sim {

/// "left, right"; "none" if there are none.
std::string joinNames(const std::vector<std::string>& names);

/// The known name that needs the fewest single-letter edits to become `name`; "" if none is near:
/// at most half its length away, or two letters.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

/// "unknown clamp 'lef' (known: left, right)"
std::string unknownName(const std::string& what, const std::string& name,
                        const std::vector<std::string>& known);

/// Empty if `name` is made of letters, digits and _, and begins with a letter; otherwise what was
/// expected.
std::string plainNameDefect(const std::string& name);

/// Clamps give their names to topics and frames. Empty if `name` will do, otherwise what was
/// expected.
std::string clampNameDefect(const std::string& name);

}  // namespace cloth_sim
