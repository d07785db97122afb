#pragma once
/// \file Names in error messages: lists, suggestions and rules.

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace cloth_sim {

/// Returns what somebody wrote as messages show it: its first 40 characters, on one line, with ?
/// for what is not ASCII.
std::string shownText(const std::string& text);

/// Returns "left, right", or "none" for an empty list; after `most` names "and 5 more". Lists that
/// the package itself bounds may be shown whole: pass kAllNames.
constexpr std::size_t kAllNames = std::numeric_limits<std::size_t>::max();
std::string joinNames(const std::vector<std::string>& names, std::size_t most = 10);

/// Returns the known name with the smallest edit distance (Levenshtein) to `name`. Returns ""
/// unless that distance is at most two, or at most half of the length of `name`.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

/// Returns "unknown clamp 'lef' (known: left, right)"
std::string unknownName(const std::string& what, const std::string& name,
                        const std::vector<std::string>& known);

/// Returns "" if `name` consists of at most 100 letters, digits and _ and begins with a letter;
/// otherwise the error.
std::string nameError(const std::string& name);

/// Returns "" if a clamp, its topics and its frame can have this name; otherwise the error.
std::string clampNameError(const std::string& name);

}  // namespace cloth_sim
