/// \file Files that exist whole or not at all.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "cloth_sim/sim/saved_state.h"

namespace cloth_sim {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw StateError(path + ": " + what + " (" + std::strerror(errno) + ")");
}

/// An open file, closed at the end of its life.
class File {
 public:
  File(const std::string& path, int flags, mode_t mode = 0)
      : descriptor_(open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  ~File() { close(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool isOpen() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }
  /// \return whether the system reported no error.
  bool close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return descriptor < 0 || ::close(descriptor) == 0;
  }

 private:
  int descriptor_;
};

bool writeAll(int descriptor, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t part = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (part < 0 && errno != EINTR) return false;
    if (part > 0) done += static_cast<std::size_t>(part);
  }
  return true;
}

/// Returns a name that no other process uses for its temporary file.
std::string temporaryName(const std::string& path) {
  static std::atomic<int> number{0};
  return path + ".tmp" + std::to_string(getpid()) + "_" + std::to_string(++number);
}

}  // namespace

void writeFileWhole(const std::string& path, const std::string& bytes) {
  const std::string temporary = temporaryName(path);
  File file(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, 0644);
  if (!file.isOpen()) fail(path, "cannot be written");
  const bool written =
      writeAll(file.descriptor(), bytes) && fsync(file.descriptor()) == 0 && file.close();
  if (!written || std::rename(temporary.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    unlink(temporary.c_str());
    errno = reason;
    fail(path, "cannot be written");
  }
  // The new name is on the disk only after its folder has been flushed.
  const std::string folder = std::filesystem::absolute(path).parent_path().string();
  const File directory(folder, O_RDONLY | O_DIRECTORY);
  if (directory.isOpen()) fsync(directory.descriptor());
}

std::string readRegularFile(const std::string& path) {
  const File file(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
  if (!file.isOpen()) {
    if (errno == ELOOP) throw StateError(path + ": is a link, which is not followed");
    fail(path, "cannot be read");
  }
  struct stat status {};
  if (fstat(file.descriptor(), &status) != 0) fail(path, "cannot be read");
  if (!S_ISREG(status.st_mode)) throw StateError(path + ": is no regular file");
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t part = read(file.descriptor(), &bytes[done], bytes.size() - done);
    if (part < 0 && errno == EINTR) continue;
    if (part < 0) fail(path, "cannot be read");
    if (part == 0) break;
    done += static_cast<std::size_t>(part);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace cloth_sim
