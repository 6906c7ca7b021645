#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstring>
#include <utility>

namespace proleg::host {

/// Owns a file descriptor of the system.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  /// The number of the descriptor; -1 if there is none.
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  [[nodiscard]] int release() { return std::exchange(number_, -1); }
  void close() {
    if (is_open()) {
      ::close(release());
    }
  }

 private:
  int number_ = -1;
};

/// Makes reads and writes return at once from now on, and keeps programs that are started from inheriting the
/// descriptor. Returns false if there is no such descriptor; errno says why.
[[nodiscard]] inline bool make_private(const Descriptor& descriptor) {
  const int flags = fcntl(descriptor.number(), F_GETFL);
  return flags >= 0 && fcntl(descriptor.number(), F_SETFL, flags | O_NONBLOCK) == 0 &&
         fcntl(descriptor.number(), F_SETFD, FD_CLOEXEC) == 0;
}

/// The text of an error of the system, such as "Permission denied" for EACCES.
[[nodiscard]] inline const char* system_text(int error) {
  const char* const text = strerrordesc_np(error);
  return text != nullptr ? text : "unknown error";
}

}  // namespace proleg::host
