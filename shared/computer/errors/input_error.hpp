#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace proleg {

/// Input that cannot be used. what() is one line for the person who wrote it:
///   FILE:LINE: found ..., expected ...
/// For input on the command line, FILE is the option or the argument, and the line is 0, which the message omits.
/// Control characters and bytes that are not UTF-8 are replaced, so the message is always one printable line.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, int line, const std::string& found, const std::string& expected);
  /// what(): that of another InputError, which was thrown in another process.
  explicit InputError(const std::string& what) : std::runtime_error(what) {}

  /// 0: of none.
  [[nodiscard]] int line() const { return line_; }
  /// what() without file and line: "found ..., expected ...".
  [[nodiscard]] const char* problem() const { return what() + place_size_; }

 private:
  int line_ = 0;
  std::size_t place_size_ = 0;
};

/// The kind of thing that a path names instead of a file whose bytes can be read to an end, for messages with "found
/// ...": "a folder", "a device, a pipe or a socket", "no such file", "an empty path", or the system's reason why the
/// kind is unknown. Nothing if it is a regular file, or a link to one.
[[nodiscard]] std::optional<std::string> found_instead_of_file(const std::filesystem::path& path);

/// A file that cannot be written or read although the request is right: a full disk, a read-only folder, a device
/// error. what() is one line: the path and the error.
class FileError : public std::runtime_error {
 public:
  FileError(const std::filesystem::path& path, const std::string& what)
      : std::runtime_error(path.string() + ": " + what) {}
};

}  // namespace proleg
