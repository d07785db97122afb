#pragma once
/// \file The error of files that cannot be read or written.

#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "one_line.h"

namespace cloth_sim {

/// Says in one line, which begins with the name of the file, why it cannot be read or written.
class FileError : public std::runtime_error {
 public:
  /// \param text  control characters in it, as of names, become spaces.
  /// \param code  the system's number of the error (errno); 0 if the error is not the system's.
  explicit FileError(const std::string& text, int code = 0)
      : std::runtime_error(oneLine(text)), code_(code) {}

  /// Tells whether there was no space left: a full disk, a quota, or a limit on the size of files.
  bool isOutOfSpace() const { return code_ == ENOSPC || code_ == EDQUOT || code_ == EFBIG; }

 private:
  int code_;
};

/// Checks that a file can have a name. The system would see only the part before a zero byte.
/// \param expected  the name of what kind of file, for messages.
/// \throws FileError
void checkFileName(const std::string& path, const std::string& expected);

/// Decides what happens to symbolic links.
enum class Links : std::uint8_t {
  kFollowed,  ///< names on a command line: the link means its target
  kRefused,   ///< names that come over a network: nothing outside of a folder is touched
};

}  // namespace cloth_sim
