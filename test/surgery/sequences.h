#pragma once
/// \file Runs of properties over random sequences by RapidCheck.
///
/// Every run draws the same sequences; RC_PARAMS="seed=... max_success=..." draws others. A failure
/// prints its seed and its case, shrunk.

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "fewer_cases.h"

namespace cloth_sim::surgery_support {

constexpr int kFullSize = 100;  ///< size at which RapidCheck draws from whole ranges

/// Draws one of the values; shrinks towards the first.
template <typename T>
rc::Gen<T> pick(const std::vector<T>& from) {
  const int count = static_cast<int>(from.size());
  return rc::gen::map(rc::gen::inRange(0, count),
                      [from](int k) { return from[static_cast<std::size_t>(k)]; });
}

/// Checks a property with `count` cases, or fewer of them (fewer_cases.h), unless RC_PARAMS asks
/// for another number, and records how many held.
template <typename Property>
void checkSequences(const std::string& name, int count, const Property& property) {
  constexpr std::uint64_t kSeed = 20211121;
  rc::detail::TestParams params = rc::detail::configuration().testParams;
  const char* given = std::getenv("RC_PARAMS");
  const std::string asked = given == nullptr ? "" : given;
  if (asked.find("seed") == std::string::npos) params.seed = kSeed;
  if (asked.find("max_success") == std::string::npos) params.maxSuccess = fewerCases(count);
  rc::detail::TestMetadata metadata;
  metadata.id = metadata.description = name;
  const auto result = rc::detail::checkTestable(property, metadata, params);
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  if (!result.template is<rc::detail::SuccessResult>()) {
    FAIL() << "seed " << params.seed << "\n" << text.str();
  }
  // scripts/test.sh adds these up (scripts/lib/suites.txt).
  testing::Test::RecordProperty("sequences",
                                result.template get<rc::detail::SuccessResult>().numSuccess);
}

}  // namespace cloth_sim::surgery_support
