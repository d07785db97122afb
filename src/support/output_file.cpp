#include "output_file.h"

#include <fcntl.h>
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;            ///< as in Linux
constexpr int kReaderPatience = 60'000;  ///< for a reader that takes nothing [ms]
constexpr mode_t kNewFile = 0666;        ///< less the umask
constexpr mode_t kPermissions = 07777;

[[noreturn]] void failToWrite(const std::string& path, const std::string& why) {
  throw FileError(path + ": cannot be written (" + why + ")");
}
[[noreturn]] void failToWrite(const std::string& path, int reason) {
  throw FileError(path + ": cannot be written (" + std::strerror(reason) + ")", reason);
}

/// Returns the number of the own descriptor that a name stands for, or -1.
int ownDescriptor(const std::string& path) {
  if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (path.compare(0, folder.size(), folder) != 0) continue;
    const std::string number = path.substr(folder.size());
    const bool isNumber = !number.empty() && number.size() < 7 &&
                          number.find_first_not_of("0123456789") == std::string::npos;
    if (isNumber) return std::atoi(number.c_str());
  }
  return -1;
}

/// Returns what a chain of links ends in, which need not exist.
std::string behindLinks(const std::string& path) {
  fs::path place = path;
  std::error_code error;
  for (int k = 0; fs::is_symlink(fs::symlink_status(place, error)); ++k) {
    if (k == kMaxLinks) failToWrite(path, ELOOP);
    place = place.parent_path() / fs::read_symlink(place, error);
    if (error) failToWrite(path, error.value());
  }
  return place.string();
}

fs::path folderOf(const std::string& file) { return fs::absolute(file).parent_path(); }

/// Returns a name in the folder of `path` that no other process uses for its temporary file.
std::string temporaryName(const std::string& path) {
  static std::atomic<int> number{0};
  return path + ".tmp" + std::to_string(getpid()) + "_" + std::to_string(++number);
}

/// A new file that is removed at the end of its life, unless it got another name.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string name)
      : name_(std::move(name)),
        file_(open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kNewFile)),
        exists_(file_.isOpen()) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (exists_) unlink(name_.c_str());
  }

  bool exists() const { return exists_; }
  int number() const { return file_.number(); }
  bool close() { return file_.close(); }
  /// \return whether it has the name now.
  bool rename(const std::string& name) {
    if (std::rename(name_.c_str(), name.c_str()) != 0) return false;
    exists_ = false;
    return true;
  }

 private:
  std::string name_;
  Descriptor file_;
  bool exists_;
};

bool writeAll(int descriptor, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t part = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (part < 0 && errno != EINTR) return false;
    if (part > 0) done += static_cast<std::size_t>(part);
  }
  return true;
}

/// Flushes a folder: a new name in it is on the disk only then.
void flushFolder(const std::string& file) {
  const Descriptor folder(open(folderOf(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.isOpen()) fsync(folder.number());
}

}  // namespace

OutputFile::OutputFile(const std::string& path, const OutputRules& rules)
    : path_(path), target_(path) {
  checkFileName(path, "the name of a file to write");
  const int own = ownDescriptor(path);
  if (own >= 0) {
    openDescriptor(own, rules);
  } else {
    openPlace(rules);
  }
}

void OutputFile::openPlace(const OutputRules& rules) {
  struct stat status {};
  const bool isThere = lstat(path_.c_str(), &status) == 0;
  if (isThere && S_ISLNK(status.st_mode) && rules.links == Links::kRefused) {
    failToWrite(path_, "is a link, which is not followed");
  }
  const bool exists = stat(path_.c_str(), &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) {
    openSpecial(rules, status.st_mode);
    return;
  }
  if (exists) mode_ = status.st_mode & kPermissions;
  target_ = behindLinks(path_);
  if (exists && access(target_.c_str(), W_OK) != 0) failToWrite(path_, errno);
  tryFolder();
}

void OutputFile::openDescriptor(int number, const OutputRules& rules) {
  if (rules.onlyRegular) failToWrite(path_, "is no name of a regular file");
  const int flags = fcntl(number, F_GETFL);
  if (flags < 0) failToWrite(path_, errno);
  if ((flags & O_ACCMODE) == O_RDONLY) failToWrite(path_, "is open for reading only");
  special_ = Descriptor(fcntl(number, F_DUPFD_CLOEXEC, 3));
  if (!special_.isOpen()) failToWrite(path_, errno);
}

void OutputFile::openSpecial(const OutputRules& rules, mode_t mode) {
  const bool canTake = S_ISCHR(mode) || S_ISFIFO(mode);
  if (rules.onlyRegular || !canTake) failToWrite(path_, describeKind(mode));
  // O_NONBLOCK keeps the call from waiting for the reader of a pipe.
  special_ = Descriptor(open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!special_.isOpen() && errno == ENXIO) failToWrite(path_, "is a pipe that nobody reads");
  if (!special_.isOpen()) failToWrite(path_, errno);
}

/// Makes a file in the folder and removes it again: permissions alone do not tell (a file system
/// may be read-only, or not take files at all).
void OutputFile::tryFolder() const {
  const TemporaryFile trial(temporaryName(target_));
  if (!trial.exists()) failToWrite(path_, errno);
}

/// Refuses what came to stand at the place since the start of a long run.
void OutputFile::checkTarget() const {
  struct stat status {};
  if (lstat(target_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    failToWrite(path_, describeKind(status.st_mode));
  }
}

void OutputFile::write(const std::string& bytes) {
  if (special_.isOpen()) {
    writeInto(bytes);
  } else {
    replace(bytes);
  }
}

void OutputFile::replace(const std::string& bytes) {
  checkTarget();
  TemporaryFile file(temporaryName(target_));
  if (!file.exists()) failToWrite(path_, errno);
  const bool isComplete = writeAll(file.number(), bytes) &&
                          (mode_ == 0 || fchmod(file.number(), mode_) == 0) &&
                          fsync(file.number()) == 0 && file.close();
  if (!isComplete || !file.rename(target_)) failToWrite(path_, errno);
  flushFolder(target_);
}

void OutputFile::take(const std::string& file) {
  checkTarget();
  const Descriptor contents(open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  const bool isComplete = contents.isOpen() &&
                          (mode_ == 0 || fchmod(contents.number(), mode_) == 0) &&
                          fsync(contents.number()) == 0;
  if (!isComplete || std::rename(file.c_str(), target_.c_str()) != 0) failToWrite(path_, errno);
  flushFolder(target_);
}

/// Writes in parts that a pipe takes at once when poll() says that it is ready, so that a reader
/// that has stopped reading cannot hold up the program for ever.
void OutputFile::writeInto(const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    pollfd ready{special_.number(), POLLOUT, 0};
    const int events = poll(&ready, 1, kReaderPatience);
    if (events < 0 && errno != EINTR) failToWrite(path_, errno);
    if (events == 0) failToWrite(path_, "nobody takes the output");
    if (events < 0) continue;
    const std::size_t size = std::min<std::size_t>(bytes.size() - done, PIPE_BUF);
    const ssize_t part = ::write(special_.number(), bytes.data() + done, size);
    if (part < 0 && errno != EINTR && errno != EAGAIN) failToWrite(path_, errno);
    if (part > 0) done += static_cast<std::size_t>(part);
  }
  if (!special_.close()) failToWrite(path_, errno);
}

void reportOutputErrors() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace cloth_sim
