#include "tools/proleg/run/simulate_command.hpp"

#include <optional>

#include "tools/proleg/common/shell_words.hpp"

namespace proleg::tools {

std::string simulate_command(const std::string& file, const sim::OverrideWords& overrides,
                             const std::vector<std::string>& settings, const std::vector<std::string>& moves) {
  std::string command = "proleg simulate " + shell_word(file) + algorithm_options();
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
