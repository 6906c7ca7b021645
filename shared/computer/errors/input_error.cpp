#include "shared/computer/errors/input_error.hpp"

#include <system_error>

#include "shared/computer/text/text.hpp"

namespace proleg {

namespace {

std::string place(const std::string& file, int line) {
  return one_line(file + (line > 0 ? ":" + std::to_string(line) : std::string()) + ": ");
}

}  // namespace

InputError::InputError(const std::string& file, int line, const std::string& found, const std::string& expected)
    : std::runtime_error(place(file, line) + one_line("found " + found + ", expected " + expected)),
      line_(line),
      place_size_(place(file, line).size()) {}

std::optional<std::string> found_instead_of_file(const std::filesystem::path& path) {
  if (path.empty()) {
    return "an empty path";
  }
  std::error_code error;
  switch (std::filesystem::status(path, error).type()) {
    case std::filesystem::file_type::regular:
      return std::nullopt;
    case std::filesystem::file_type::not_found:
      return "no such file";
    case std::filesystem::file_type::none:
      return "a path that cannot be looked at (" + error.message() + ")";
    case std::filesystem::file_type::directory:
      return "a folder";
    default:
      return "a device, a pipe or a socket";
  }
}

}  // namespace proleg
