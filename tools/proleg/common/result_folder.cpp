#include "tools/proleg/common/result_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// The folder itself, or the nearest existing folder above it.
fs::path existing_part(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder).lexically_normal();
  while (!fs::exists(path, error) && path.has_relative_path()) {
    path = path.parent_path();
  }
  return path;
}

}  // namespace

fs::path chosen_folder(const std::optional<std::string>& out, const std::optional<std::string>& resume,
                       const std::string& name, const std::string& what) {
  if (resume && out && *out != *resume) {
    throw BadInput("found --out " + *out + " beside --resume " + *resume + ", expected one of them: a resumed " + what +
                   " stays in its folder");
  }
  const std::string folder = resume ? *resume : out.value_or(name);
  if (folder.empty()) {
    throw InputError(resume ? "--resume" : "--out", 0, "an empty name", "the name of a folder");
  }
  return folder;
}

void check_result_folder(const fs::path& folder, std::span<const std::string_view> files) {
  if (folder.empty()) {
    throw InputError("--out", 0, "an empty name", "the name of a folder");
  }
  const fs::path existing = existing_part(folder);
  std::error_code error;
  if (!fs::is_directory(existing, error)) {
    throw InputError(existing.string(), 0, "something that is not a folder", "a folder for the results (--out)");
  }
  for (const std::string_view name : files) {
    if (fs::exists(fs::symlink_status(folder / name, error))) {
      throw BadInput((folder / name).string() +
                     ": found an existing file, expected none; --out FOLDER names another folder");
    }
  }
  if (access(existing.c_str(), W_OK | X_OK) != 0) {
    throw InputError(existing.string(), 0,
                     std::string("a folder that cannot be written (") + std::strerror(errno) + ")",
                     "one with write permission (--out)");
  }
}

void create_result_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw BadInput("cannot create the folder " + folder.string() + ": " + error.message());
  }
}

ResultFolder::ResultFolder(const fs::path& path, std::span<const std::string_view> files)
    : path_(path), is_new_(!fs::exists(path)) {
  create_result_folder(path);
  descriptor_ = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  try {
    if (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      throw BadInput(path.string() +
                     ": found a folder into which another program writes its results, expected one of " +
                     "this program alone; --out FOLDER names another folder");
    }
    check_result_folder(path, files);  // again: another program may have ended meanwhile
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

ResultFolder::~ResultFolder() {
  if (is_new_) {
    rmdir(path_.c_str());  // it fails unless the folder is empty
  }
  close(descriptor_);
}

}  // namespace proleg::tools
