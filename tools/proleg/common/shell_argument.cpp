#include "tools/proleg/common/shell_argument.hpp"

#include "shared/computer/algorithm_library/algorithm_library.hpp"

namespace proleg::tools {

std::string shell_argument(const std::string& argument) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,@%+";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) {
    return argument;
  }
  std::string quoted = "'";
  for (const char character : argument) {
    quoted += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return quoted + "'";
}

std::string algorithm_options() {
  std::string options;
  for (const std::string& library : loaded_libraries()) {
    options += " --algorithms " + shell_argument(library);
  }
  return options;
}

}  // namespace proleg::tools
