/// \file Inputs and outputs: what may stand at the name of a file, and what happens to it.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "support/input_file.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Returns the error of an action in one line; "" if there is none.
template <typename Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

/// A test with an empty folder of its own.
class Files : public testing::Test {
 protected:
  void SetUp() override {
    const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::temp_directory_path() / ("cloth_sim_" + test + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename());
    }
    return names;
  }
  static void put(const std::string& path, const std::string& text) { std::ofstream(path) << text; }
  static std::string contents(const std::string& path) { return readInputFile(path, {}); }
  /// Returns a character device: 3 is /dev/null, 7 is /dev/full. It is one of the folder's own
  /// where the system lets us make one, so that an error here cannot destroy that of the machine.
  std::string device(unsigned minor) const {
    const std::string own = path("device" + std::to_string(minor));
    if (::mknod(own.c_str(), S_IFCHR | 0600, makedev(1, minor)) == 0 &&
        Descriptor(::open(own.c_str(), O_WRONLY)).isOpen()) {
      return own;
    }
    fs::remove(own);
    fs::create_symlink(minor == 3 ? "/dev/null" : "/dev/full", own);
    return own;
  }
  std::string makeSocket() const {
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path("socket").copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::close(descriptor);
    return path("socket");
  }

  fs::path folder_;
};

using Outputs = Files;
using Inputs = Files;

std::string outputError(const std::string& path, const OutputRules& rules = {}) {
  return errorOf([&] { OutputFile(path, rules).write("x"); });
}

TEST_F(Outputs, ReplaceARegularFileWholeAndKeepItsPermissions) {
  const std::string big(3000000, 'x');
  put(path("a"), "first");
  fs::permissions(path("a"), fs::perms::owner_read | fs::perms::owner_write);
  OutputFile place(path("a"));
  EXPECT_EQ(contents(path("a")), "first") << "the constructor touches nothing";
  EXPECT_THAT(names(), ElementsAre("a"));
  place.write(big);
  EXPECT_EQ(contents(path("a")), big);
  EXPECT_EQ(fs::status(path("a")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(Outputs, KeepALinkAndReplaceItsTarget) {
  put(path("target"), "old");
  fs::create_symlink("target", path("link"));
  fs::create_symlink(path("link"), path("second"));
  OutputFile(path("second")).write("new");
  EXPECT_TRUE(fs::is_symlink(path("second")));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_FALSE(fs::is_symlink(path("target")));
  EXPECT_EQ(contents(path("target")), "new");
  fs::remove(path("target"));
  OutputFile(path("link")).write("newer");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(contents(path("target")), "newer");
  fs::create_symlink("loop", path("loop"));
  EXPECT_THAT(outputError(path("loop")), HasSubstr("links"));
}

TEST_F(Outputs, RefuseALinkWhereLinksAreNotFollowed) {
  put(path("target"), "kept");
  fs::create_symlink(path("target"), path("link"));
  EXPECT_THAT(outputError(path("link"), {Links::kRefused, true}), HasSubstr("is a link"));
  EXPECT_EQ(contents(path("target")), "kept");
  EXPECT_TRUE(fs::is_symlink(path("link")));
}

TEST_F(Outputs, GoIntoADevice) {
  fs::create_symlink(device(3), path("link"));
  for (const std::string& null : {device(3), path("link")}) {
    EXPECT_EQ(outputError(null), "");
    EXPECT_THAT(outputError(null, {Links::kFollowed, true}), HasSubstr("character device"));
    EXPECT_TRUE(fs::is_character_file(null));
  }
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_THAT(outputError(device(7)), HasSubstr("device7: cannot be written (No space left"));
  EXPECT_TRUE(fs::is_character_file(path("device7")));
}

TEST_F(Outputs, GoIntoAPipeToItsReader) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(outputError(path("pipe")), HasSubstr("nobody reads"));  // and does not wait for one
  const std::string big(300000, 'y');                                 // more than a pipe holds
  std::string read;
  std::thread reader([&] {
    std::ostringstream all;
    all << std::ifstream(path("pipe")).rdbuf();
    read = all.str();
  });
  std::string error = "nobody reads";
  const auto isReady = [&] { return error.find("nobody reads") == std::string::npos; };
  while (!isReady()) error = errorOf([&] { OutputFile(path("pipe")).write(big); });
  reader.join();  // the pipe ends with the output
  EXPECT_EQ(error, "");
  EXPECT_EQ(read, big);
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
}

TEST_F(Outputs, LetTheReaderOfAPipeGoIfNothingIsWritten) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const Descriptor reader(::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK));
  { const OutputFile place(path("pipe")); }
  char byte = 0;
  EXPECT_EQ(::read(reader.number(), &byte, 1), 0) << "the end of the file";
}

TEST_F(Outputs, FailIfTheReaderOfAPipeGoes) {
  reportOutputErrors();
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  Descriptor reader(::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK));
  OutputFile place(path("pipe"));
  reader.close();
  EXPECT_THAT(errorOf([&] { place.write("x"); }), HasSubstr("Broken pipe"));
}

TEST_F(Outputs, GoIntoAnOpenDescriptorAfterWhatIsThere) {
  const Descriptor log(
      ::open(path("log").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  ASSERT_EQ(::write(log.number(), "a", 1), 1);
  OutputFile("/dev/fd/" + std::to_string(log.number())).write("b");
  EXPECT_EQ(contents(path("log")), "ab");
  EXPECT_THAT(outputError("/dev/fd/999999"), HasSubstr("cannot be written"));
}

TEST_F(Outputs, RefuseEverythingElse) {
  fs::create_directory(path("folder"));
  EXPECT_THAT(outputError(path("folder")), HasSubstr("is a directory"));
  EXPECT_THAT(outputError(path("folder") + "/"), HasSubstr("is a directory"));
  EXPECT_THAT(outputError(makeSocket()), HasSubstr("is a socket"));
  EXPECT_THAT(outputError(""), HasSubstr("got nothing"));
  EXPECT_THAT(outputError(path("nowhere/a")), HasSubstr("nowhere/a: cannot be written"));
  EXPECT_THAT(outputError("/proc/cloth_sim"), HasSubstr("/proc/cloth_sim: cannot be written"));
  EXPECT_THAT(outputError("-", {Links::kFollowed, true}), HasSubstr("no name of a regular file"));
  EXPECT_EQ(names().size(), 2U) << "nothing is left behind";
}

TEST_F(Outputs, RefuseWhatCameToStandThereMeanwhile) {
  OutputFile place(path("a"));
  ASSERT_EQ(::mkfifo(path("a").c_str(), 0600), 0);
  EXPECT_THAT(errorOf([&] { place.write("x"); }), HasSubstr("is a pipe"));
  EXPECT_TRUE(fs::is_fifo(path("a")));
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(Outputs, TakeAFileThatSomebodyElseWrote) {
  put(path("target"), "old");
  fs::create_symlink("target", path("link"));
  OutputFile place(path("link"), {Links::kFollowed, true});
  EXPECT_EQ(place.target(), path("target"));
  put(place.target() + ".active", "new");
  place.take(place.target() + ".active");
  EXPECT_EQ(contents(path("target")), "new");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(names().size(), 2U);
}

std::string inputError(const std::string& path, const InputRules& rules = {}) {
  return errorOf([&] { readInputFile(path, rules); });
}

TEST_F(Inputs, AreRegularFiles) {
  put(path("a"), "text");
  fs::create_symlink("a", path("link"));
  EXPECT_EQ(contents(path("link")), "text");
  EXPECT_NE(contents("/proc/self/status"), "") << "of a size that the system does not tell";
  EXPECT_THAT(inputError(path("link"), {100, Links::kRefused}), HasSubstr("is a link"));
  EXPECT_THAT(inputError(path("nothing")), HasSubstr("nothing: cannot be read (No such file"));
  EXPECT_THAT(inputError(""), HasSubstr("got nothing"));
}

TEST_F(Inputs, ThatAreNoFilesAreRefusedAtOnce) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", path("link"));
  EXPECT_THAT(inputError(path("pipe")), HasSubstr("is a pipe"));
  EXPECT_THAT(inputError(path("link")), HasSubstr("is a pipe"));
  EXPECT_THAT(inputError("/dev/zero"), HasSubstr("is a character device"));
  EXPECT_THAT(inputError(folder_), HasSubstr("is a directory"));
  EXPECT_THAT(inputError(makeSocket()), HasSubstr("is a socket"));
  EXPECT_THAT(errorOf([&] { checkInputFile(path("pipe"), {}); }), HasSubstr("is a pipe"));
}

TEST_F(Inputs, AndOutputsWithUnusualNamesAreToldOnOneLine) {
  EXPECT_EQ(inputError("/no\nwhere/a\tb"),
            "/no where/a b: cannot be read (No such file or directory)");
  put(path("a"), "1");
  const std::string cut = path("a") + std::string("\0.obj", 5);
  EXPECT_THAT(inputError(cut), HasSubstr("zero byte"));
  EXPECT_THAT(errorOf([&] { OutputFile output(cut, {}); }), HasSubstr("zero byte"));
}

TEST_F(Inputs, OfAHugeSizeAreRefusedBeforeTheyAreRead) {
  put(path("a"), "12345");
  EXPECT_EQ(inputError(path("a"), {5, Links::kFollowed}), "");
  EXPECT_THAT(inputError(path("a"), {4, Links::kFollowed}), HasSubstr("at most 4 bytes"));
  fs::resize_file(path("a"), 1ULL << 40);  // without blocks on the disk
  EXPECT_THAT(inputError(path("a")), HasSubstr("at most 1024 MiB"));
  EXPECT_THAT(inputError("/proc/self/status", {10, Links::kFollowed}), HasSubstr("too large"));
}

}  // namespace
}  // namespace cloth_sim
