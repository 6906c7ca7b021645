#include "shared/computer/errors/file_error.hpp"

#include <system_error>

namespace proleg {

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
