#pragma once
/// \file Writes the files that users name: summaries, saved states, tables, bags.

#include <string>

#include "descriptor.h"
#include "file_error.h"

namespace cloth_sim {

/// Restrictions on the place of an output.
struct OutputRules {
  Links links = Links::kFollowed;
  bool onlyRegular = false;  ///< refuse devices and pipes, too: for a writer that seeks (rosbag)
};

/// The place of one output. What is there decides:
/// - A regular file or nothing: the output is written under another name in the same folder,
///   flushed to the disk, and renamed. The old contents stay until then; permissions are kept.
/// - A symbolic link stays, and the rule applies to its target.
/// - A character device, a pipe with a reader, or one of the process's own descriptors ("-",
///   /dev/stdout, /dev/fd/N): the output is written into it. The pipe is opened at once, and ends
///   at the end of this object, so that its reader does not wait for ever.
/// - Everything else (a directory, a block device, a socket, a pipe without a reader) is refused.
class OutputFile {
 public:
  /// Finds out whether the output can be written; a file of this name is not touched.
  /// \throws FileError if not.
  explicit OutputFile(const std::string& path, const OutputRules& rules = {});

  /// Writes the whole output. Call it once. \throws FileError; then nothing is left behind.
  void write(const std::string& bytes);
  /// Gives the place to a regular file in its folder, which is complete. Call it once, instead of
  /// `write`. \throws FileError; then `file` is still there.
  void take(const std::string& file);

  /// Returns the file behind all links, or the name itself if it is not one of a regular file.
  const std::string& target() const { return target_; }

 private:
  void openDescriptor(int number, const OutputRules& rules);
  void openPlace(const OutputRules& rules);
  void openSpecial(const OutputRules& rules, mode_t mode);
  void tryFolder() const;
  void checkTarget() const;
  void replace(const std::string& bytes);
  void writeInto(const std::string& bytes);

  std::string path_;    ///< as the user named it
  std::string target_;  ///< see target()
  Descriptor special_;  ///< open if the output goes into something that is no regular file
  mode_t mode_ = 0;     ///< permissions of the file that is replaced; 0 if there is none
};

/// Lets a broken pipe and a full disk be errors of write(), instead of the end of the process
/// (SIGPIPE and SIGXFSZ). Programs call it at their start.
void reportOutputErrors();

}  // namespace cloth_sim
