#include "tools/proleg/ui/desktop_start.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

std::string desktop_folder() {
  namespace fs = std::filesystem;
  const char* home = std::getenv("HOME");
  const fs::path folder = fs::path(home == nullptr ? "" : home) / "Proleg";
  std::error_code error;
  if (folder.is_absolute()) {
    fs::create_directories(folder, error);
    if (!error && ::access(folder.c_str(), W_OK) == 0) {
      return folder.string();
    }
  }
  const fs::path other = fs::temp_directory_path();
  print_warning("proleg ui", "cannot write in " + folder.string() +
                                 ", the folder of robots and recordings; what you save goes to " + other.string());
  return other.string();
}

}  // namespace proleg::tools
