#pragma once
/// \file Reads the files that users name: scenes, meshes, saved states, tables, bags.

#include <cstdint>
#include <string>

#include "file_error.h"

namespace cloth_sim {

/// Restrictions on an input.
struct InputRules {
  std::uint64_t maxSize = 1ULL << 30;  ///< [bytes]
  Links links = Links::kFollowed;
};

/// Returns the contents of a regular file. Directories, devices, pipes and sockets are refused
/// without a wait for data, and larger files before anything is read.
/// \throws FileError
std::string readInputFile(const std::string& path, const InputRules& rules);

/// Same refusals, for a file that somebody else opens afterwards by its name (rosbag).
/// \throws FileError
void checkInputFile(const std::string& path, const InputRules& rules);

}  // namespace cloth_sim
