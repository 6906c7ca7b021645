#include "tools/proleg/simulate_command.hpp"

#include <optional>

namespace proleg::tools {
namespace {

/// In quotes for a shell, if it needs them.
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

}  // namespace

std::string simulate_command(const std::string& file, const sim::OverrideWords& overrides,
                             const std::vector<std::string>& settings, const std::vector<std::string>& moves) {
  std::string command = "proleg simulate " + shell_word(file);
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = overrides.*declaration.word) {
      command += " --" + std::string(declaration.name) + ' ' + shell_word(*word);
    }
  }
  for (const std::string& word : settings) {
    command += " --set " + shell_word(word);
  }
  for (const std::string& word : moves) {
    command += " --move " + shell_word(word);
  }
  return command;
}

}  // namespace proleg::tools
