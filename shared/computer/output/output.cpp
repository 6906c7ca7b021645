#include "shared/computer/output/output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "shared/computer/errors/file_error.hpp"

namespace proleg {

Output::Output(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  int flags = O_WRONLY | O_CLOEXEC;
  std::filesystem::path target = path;
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) {
    // A symbolic link stays one: the file that it names is replaced.
    const std::filesystem::path real = std::filesystem::weakly_canonical(path, error);
    path_ = error ? path : real;
    temporary_ = path_.string() + ".part" + std::to_string(getpid());
    target = temporary_;
    flags |= O_CREAT | O_EXCL;
  }
  descriptor_ = open(target.c_str(), flags, 0666);
  if (descriptor_ < 0) {
    temporary_.clear();
    fail(std::strerror(errno));
  }
}

Output::Output() : path_("standard output"), descriptor_(STDOUT_FILENO) {}

Output::~Output() {
  if (descriptor_ > STDOUT_FILENO) {
    close(descriptor_);
  }
  if (!temporary_.empty()) {
    unlink(temporary_.c_str());
  }
}

void Output::write(std::string_view text) {
  constexpr std::size_t enough = 1U << 16U;
  buffer_ += text;
  if (buffer_.size() >= enough) {
    flush();
  }
}

void Output::finish() {
  flush();
  if (descriptor_ > STDOUT_FILENO) {
    // Some file systems report a full disk only here.
    const int result = close(descriptor_);
    descriptor_ = -1;
    if (result != 0) {
      fail(std::strerror(errno));
    }
  }
  if (!temporary_.empty()) {
    if (rename(temporary_.c_str(), path_.c_str()) != 0) {
      fail(std::strerror(errno));
    }
    temporary_.clear();
  }
}

void Output::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EPIPE) {
      throw ReaderGone();
    } else if (errno != EINTR) {
      fail(std::strerror(errno));
    }
  }
  buffer_.clear();
}

void Output::fail(const std::string& what) const { throw FileError(path_, "cannot be written: " + what); }

void write_file(const std::filesystem::path& path, std::string_view text) {
  Output output(path);
  output.write(text);
  output.finish();
}

}  // namespace proleg
