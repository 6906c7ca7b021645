#include "shared/computer/output/output_check.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"

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

void check_outputs(std::span<const PlannedOutput> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    check(outputs[i]);
    for (std::size_t other = 0; other < i; ++other) {
      require_different(outputs[other], outputs[i]);
    }
  }
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
