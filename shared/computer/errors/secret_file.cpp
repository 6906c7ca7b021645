#include "shared/computer/errors/secret_file.hpp"

#include <system_error>

namespace proleg {

std::optional<std::string> warning_on_secret(const std::filesystem::path& file) {
  using std::filesystem::perms;
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  const bool is_open = std::filesystem::is_regular_file(status) &&
                       (status.permissions() & (perms::group_read | perms::others_read)) != perms::none;
  return is_open ? std::optional(file.string() + ": others can read the key: 'chmod 600' prevents it") : std::nullopt;
}

}  // namespace proleg
