#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace proleg {

/// Where a tool writes its result to. A file appears under its name when it is complete, and never before: what is
/// written goes to a temporary file beside it, which is renamed at the end and removed after a failure. (A target that
/// is there and is not an ordinary file, such as a pipe or a device, is written directly.)
class Output {
 public:
  /// Throws FileError if the file cannot be created.
  explicit Output(const std::filesystem::path& path);
  /// Standard output.
  Output();
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  /// Throws FileError if the system refuses, ReaderGone if the program at the other end of a pipe has ended.
  void write(std::string_view text);
  /// Writes what is left and gives the file its name. Throws as write() does.
  void finish();

 private:
  void flush();
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path path_;
  std::filesystem::path temporary_;  ///< empty: written directly
  int descriptor_;
  std::string buffer_;
};

/// Writes a whole file. Throws as Output does.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Nobody reads any more; not an error to report.
class ReaderGone {};

}  // namespace proleg
