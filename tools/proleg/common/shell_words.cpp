#include "tools/proleg/common/shell_words.hpp"

#include "shared/computer/algorithm_library/algorithm_library.hpp"

namespace proleg::tools {

std::string shell_word(const std::string& word) {
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,@%+";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
    return word;
  }
  std::string quoted = "'";
  for (const char character : word) {
    quoted += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return quoted + "'";
}

std::string algorithm_options() {
  std::string options;
  for (const std::string& library : loaded_libraries()) {
    options += " --algorithms " + shell_word(library);
  }
  return options;
}

}  // namespace proleg::tools
