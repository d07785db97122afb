#include "names.h"

#include <algorithm>
#include <numeric>

#include "support/one_line.h"

namespace cloth_sim {
namespace {

/// Number of letters that are compared. It bounds the work for long text that somebody pastes.
constexpr std::size_t kLongestCompared = 60;

constexpr std::size_t kLongestName = 100;  ///< of clamps, obstacles, phases and cloths
constexpr std::size_t kLongestShown = 40;  ///< of what somebody sent

/// Levenshtein's distance, computed row by row.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string shownText(const std::string& text) {
  std::string result = oneLine(text.substr(0, kLongestShown));
  for (char& c : result) {  // they may be no UTF-8, or be cut in the middle of a character
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  }
  return text.size() > kLongestShown ? result + "..." : result;
}

std::string joinNames(const std::vector<std::string>& names, std::size_t most) {
  if (names.empty()) return "none";
  std::string result = shownText(names.front());
  const std::size_t listed = std::min(names.size(), most);
  for (std::size_t i = 1; i < listed; ++i) result += ", " + shownText(names[i]);
  if (listed == names.size()) return result;
  return result + " and " + std::to_string(names.size() - listed) + " more";
}

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(name.substr(0, kLongestCompared), candidate);
    // A candidate of which every letter changes is not near.
    if (distance < best && distance < candidate.size()) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string unknownName(const std::string& what, const std::string& name,
                        const std::vector<std::string>& known) {
  const std::string unknown = "unknown " + what + " '" + shownText(name) + "' ";
  return unknown + (known.empty() ? "(there is none)" : "(known: " + joinNames(known) + ")");
}

std::string nameError(const std::string& name) {
  if (name.size() > kLongestName) {
    return "expected a name of at most " + std::to_string(kLongestName) + " characters (got " +
           std::to_string(name.size()) + ")";
  }
  const bool good = !name.empty() && isLetter(name[0]) &&
                    std::all_of(name.begin(), name.end(),
                                [](char c) { return isLetter(c) || isDigit(c) || c == '_'; });
  return good ? "" : "expected a name of letters, digits and _ that begins with a letter";
}

std::string clampNameError(const std::string& name) {
  const std::string error = nameError(name);
  if (!error.empty()) return error;
  if (name == "all") return "expected another name: 'all' stands for all clamps";
  return "";
}

}  // namespace cloth_sim
