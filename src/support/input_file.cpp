#include "input_file.h"

#include <fcntl.h>

#include <cstring>

#include "descriptor.h"

namespace cloth_sim {
namespace {

[[noreturn]] void failToRead(const std::string& path) {
  const int reason = errno;
  throw FileError(path + ": cannot be read (" + std::strerror(reason) + ")", reason);
}

std::string sizeText(std::uint64_t bytes) {
  const bool inMega = bytes >= 1U << 20;
  return std::to_string(inMega ? bytes >> 20 : bytes) + (inMega ? " MiB" : " bytes");
}

[[noreturn]] void refuseSize(const std::string& path, const InputRules& rules) {
  throw FileError(path + ": is too large (expected at most " + sizeText(rules.maxSize) + ")");
}

/// Opens a file for reading. O_NONBLOCK keeps the call from waiting for the writer of a pipe.
Descriptor openRegular(const std::string& path, const InputRules& rules, struct stat& status) {
  checkFileName(path, "the name of a file");
  const int noFollow = rules.links == Links::kRefused ? O_NOFOLLOW : 0;
  // The kind is asked for first: opening some devices has effects (a tape rewinds).
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    throw FileError(path + ": " + describeKind(status.st_mode) + " (expected a regular file)");
  }
  Descriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | noFollow));
  if (!file.isOpen() && errno == ELOOP && noFollow != 0) {
    throw FileError(path + ": is a link, which is not followed");
  }
  if (!file.isOpen() || fstat(file.number(), &status) != 0) failToRead(path);
  if (!S_ISREG(status.st_mode)) {
    throw FileError(path + ": " + describeKind(status.st_mode) + " (expected a regular file)");
  }
  if (static_cast<std::uint64_t>(status.st_size) > rules.maxSize) refuseSize(path, rules);
  return file;
}

}  // namespace

std::string readInputFile(const std::string& path, const InputRules& rules) {
  struct stat status {};
  const Descriptor file = openRegular(path, rules, status);
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  // Files of /proc say that they are empty; one more byte tells whether more follows.
  for (bytes.resize(bytes.size() + 1);;) {
    const ssize_t part = read(file.number(), &bytes[done], bytes.size() - done);
    if (part < 0 && errno == EINTR) continue;
    if (part < 0) failToRead(path);
    if (part == 0) break;
    done += static_cast<std::size_t>(part);
    if (done > rules.maxSize) refuseSize(path, rules);
    if (done == bytes.size()) bytes.resize(bytes.size() + (1 << 16));
  }
  bytes.resize(done);
  return bytes;
}

void checkInputFile(const std::string& path, const InputRules& rules) {
  struct stat status {};
  openRegular(path, rules, status);
}

}  // namespace cloth_sim
