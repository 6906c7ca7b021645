#include "shared/computer/output/output.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"

namespace proleg {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const PlannedOutput& output, const std::string& found, const std::string& expected) {
  throw InputError(output.path.string(), 0, found, expected + " (" + output.option + ")");
}

void require_permission(const PlannedOutput& output, const fs::path& path, int mode) {
  if (access(path.c_str(), mode) != 0) {
    refuse(output, std::string("a name that cannot be written (") + std::strerror(errno) + ")",
           "a file in a folder with write permission");
  }
}

void check_existing(const PlannedOutput& output, const fs::path& target) {
  if (fs::is_directory(target)) {
    refuse(output, "a folder", "the name of a file");
  }
  std::error_code error;
  if (!fs::is_regular_file(target)) {
    if (output.must_be_file) {
      refuse(output, "something that is not a file", "the name of a file");
    }
  } else if (fs::file_size(target, error) > 0 && !output.is_of_kind(target)) {
    refuse(output, "a file that is no " + output.kind, "no file, or an earlier " + output.kind + " to replace");
  }
  require_permission(output, target, W_OK);
}

void check(const PlannedOutput& output) {
  if (output.path.empty()) {
    throw InputError(output.option, 0, "an empty name", "the name of a file");
  }
  std::error_code error;
  if (fs::exists(output.path, error)) {
    check_existing(output, output.path);
    return;
  }
  const fs::path folder = follow_links(output.path).parent_path();
  require_permission(output, folder, W_OK | X_OK);
}

/// Whether two names are those of one file, which need not exist yet. A device may be the target of several outputs.
bool is_one_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::exists(a, error) && fs::exists(b, error)) {
    return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
  }
  return follow_links(a) == follow_links(b);
}

/// The files of an output: its own file first, then its companions.
std::vector<fs::path> files_of(const PlannedOutput& output) {
  const fs::path target = follow_links(output.path);
  std::vector<fs::path> files{target};
  for (const std::string& suffix : output.companions) {
    files.push_back(target.string() + suffix);
  }
  return files;
}

void require_different(const PlannedOutput& a, const PlannedOutput& b) {
  for (const fs::path& file_of_a : files_of(a)) {
    for (const fs::path& file_of_b : files_of(b)) {
      if (is_one_file(file_of_a, file_of_b)) {
        refuse(b, "twice, for " + a.option + " and " + b.option, "a different file for each output");
      }
    }
  }
}

}  // namespace

fs::path temporary_name(const fs::path& folder) {
  static std::atomic<unsigned> count = 0;
  return folder / (".proleg-" + std::to_string(getpid()) + "-" + std::to_string(count++) + ".part");
}

fs::path follow_links(const fs::path& path) {
  constexpr int max_links = 40;  // the limit of the kernel
  std::error_code error;
  if (fs::exists(path, error)) {
    const fs::path real = fs::canonical(path, error);
    return error ? path : real;  // a pipe in /dev/fd has no path
  }
  fs::path target = fs::absolute(path, error);
  for (int link = 0; link < max_links && fs::is_symlink(target, error); ++link) {
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  const fs::path folder = fs::weakly_canonical(target.parent_path(), error);
  return error ? path : folder / target.filename();
}

Output::Output(const fs::path& path) : path_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status) || fs::is_regular_file(status)) {
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
  const fs::path folder = path_.parent_path();
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
  if (buffer_.size() + text.size() < enough) {
    buffer_ += text;
    return;
  }
  flush();
  write_now(text);
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
  write_now(buffer_);
  buffer_.clear();
}

void Output::write_now(std::string_view rest) {
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
}

void Output::fail(const std::string& what) const { throw FileError(path_, "cannot be written: " + what); }

void write_file(const fs::path& path, std::string_view text) {
  Output output(path);
  output.write(text);
  output.finish();
}

void check_outputs(std::span<const PlannedOutput> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    check(outputs[i]);
    for (std::size_t other = 0; other < i; ++other) {
      require_different(outputs[other], outputs[i]);
    }
  }
}

std::string read_whole_file(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string text;
  std::array<char, 1U << 16U> part{};
  ssize_t count = file < 0 ? -1 : 1;
  while (count > 0 || (count < 0 && file >= 0 && errno == EINTR)) {
    count = read(file, part.data(), part.size());
    text.append(part.data(), count > 0 ? static_cast<std::size_t>(count) : 0U);
  }
  const int reason = errno;
  if (file >= 0) {
    close(file);
  }
  if (count < 0) {
    throw FileError(path, std::string("cannot be read: ") + std::strerror(reason));
  }
  return text;
}

std::string first_bytes(const fs::path& path, std::size_t size) {
  std::string text(size, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

std::function<bool(const fs::path&)> starts_with(std::string_view text) {
  return [start = std::string(text)](const fs::path& path) { return first_bytes(path, start.size()) == start; };
}

}  // namespace proleg
