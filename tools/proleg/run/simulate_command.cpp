#include "tools/proleg/run/simulate_command.hpp"

#include <optional>

#include "tools/proleg/common/program_run.hpp"

namespace proleg::tools {

std::string simulate_command(const std::string& file, const sim::OverrideWords& overrides,
                             const std::vector<std::string>& settings, const std::vector<std::string>& moves) {
  std::string command = "proleg simulate " + shell_argument(file) + algorithm_options();
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& argument = overrides.*declaration.word) {
      command += " --" + std::string(declaration.name) + ' ' + shell_argument(*argument);
    }
  }
  for (const std::string& argument : settings) {
    command += " --set " + shell_argument(argument);
  }
  for (const std::string& argument : moves) {
    command += " --move " + shell_argument(argument);
  }
  return command;
}

}  // namespace proleg::tools
