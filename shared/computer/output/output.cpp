#include "shared/computer/output/output.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "shared/computer/errors/input_error.hpp"

namespace proleg {

std::filesystem::path temporary_name(const std::filesystem::path& folder) {
  static std::atomic<unsigned> count = 0;
  return folder / (".proleg-" + std::to_string(getpid()) + "-" + std::to_string(count++) + ".part");
}

std::filesystem::path follow_links(const std::filesystem::path& path) {
  constexpr int max_links = 40;  // the limit of the kernel
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    const std::filesystem::path real = std::filesystem::canonical(path, error);
    return error ? path : real;  // a pipe in /dev/fd has no path
  }
  std::filesystem::path target = std::filesystem::absolute(path, error);
  for (int link = 0; link < max_links && std::filesystem::is_symlink(target, error); ++link) {
    target = target.parent_path() / std::filesystem::read_symlink(target, error);
  }
  const std::filesystem::path folder = std::filesystem::weakly_canonical(target.parent_path(), error);
  return error ? path : folder / target.filename();
}

Output::Output(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) {
    path_ = follow_links(path);
    open_new_file();
  } else {
    descriptor_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  }
  if (descriptor_ < 0) {
    temporary_.clear();
    fail(std::strerror(errno));
  }
}

void Output::open_new_file() {
  const std::filesystem::path folder = path_.parent_path();
  descriptor_ = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  is_unnamed_ = descriptor_ >= 0;
  if (!is_unnamed_ && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
    temporary_ = temporary_name(folder);
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CLOEXEC | O_CREAT | O_EXCL, 0666);
  }
  constexpr mode_t permissions = 0777;
  struct stat before {};
  if (descriptor_ >= 0 && stat(path_.c_str(), &before) == 0) {
    fchmod(descriptor_, before.st_mode & permissions);  // it fails on file systems without permissions
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
  if (is_unnamed_) {
    temporary_ = temporary_name(path_.parent_path());
    const std::string file = "/proc/self/fd/" + std::to_string(descriptor_);
    if (linkat(AT_FDCWD, file.c_str(), AT_FDCWD, temporary_.c_str(), AT_SYMLINK_FOLLOW) != 0) {
      temporary_.clear();
      fail(std::strerror(errno));
    }
  }
  if (descriptor_ > STDOUT_FILENO) {
    // Some file systems report a full disk only when a file is closed.
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
