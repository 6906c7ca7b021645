#pragma once

// The last line of a program that cannot continue.

#include <unistd.h>

#include <array>
#include <cstddef>

namespace proleg {

/// Writes one line to standard error, without a lock or memory of the C library: a signal handler may print it, also if
/// that library is damaged. A text of 1000 bytes and more is cut.
class LastLine {
 public:
  LastLine& operator<<(const char* text) {
    while (*text != '\0' && length_ < text_.size() - 1) {
      text_[length_++] = *text++;
    }
    return *this;
  }

  /// Prints the line; the exit status is 1.
  [[noreturn]] void end_program() {
    text_[length_++] = '\n';
    // A failure cannot be reported anywhere.
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text_.data(), length_);
    _exit(1);
  }

 private:
  std::array<char, 1000> text_{};
  std::size_t length_ = 0;
};

}  // namespace proleg
