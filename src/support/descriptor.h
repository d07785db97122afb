#pragma once
/// \file An open file of the system, and a word for its kind.

#include <sys/stat.h>
#include <unistd.h>

namespace cloth_sim {

/// An open file descriptor, closed at the end of its life.
class Descriptor {
 public:
  Descriptor() = default;
  /// \param descriptor  as open() returns it; negative if that failed.
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(other.descriptor_) {
    other.descriptor_ = -1;
  }
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    descriptor_ = other.descriptor_;
    other.descriptor_ = -1;
    return *this;
  }
  ~Descriptor() { close(); }

  bool isOpen() const { return descriptor_ >= 0; }
  int number() const { return descriptor_; }
  /// \return whether the system reported no error.
  bool close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return descriptor < 0 || ::close(descriptor) == 0;
  }

 private:
  int descriptor_ = -1;
};

/// Names the kind of a file that is not a regular one: "is a directory".
inline const char* describeKind(mode_t mode) {
  if (S_ISDIR(mode)) return "is a directory";
  if (S_ISFIFO(mode)) return "is a pipe";
  if (S_ISSOCK(mode)) return "is a socket";
  if (S_ISCHR(mode)) return "is a character device";
  if (S_ISBLK(mode)) return "is a block device";
  if (S_ISLNK(mode)) return "is a link";
  return "is no regular file";
}

}  // namespace cloth_sim
