#include "tools/proleg/new/new_files.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/declaration.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/program_run.hpp"
#include "tools/proleg/new/algorithm_files.hpp"

namespace proleg::tools {
namespace {

struct AlgorithmOptions {
  std::string name;
  std::optional<std::string> out;
  std::optional<std::string> id;
  std::string source;
};

constexpr std::size_t longest_name = 40;

std::uint8_t choose_id(const AlgorithmOptions& options) {
  if (!options.id) {
    return usual_id(options.name);
  }
  const std::optional<unsigned> id = parse_whole<unsigned>(*options.id);
  if (!id || *id > last_user_id || !is_user_algorithm(static_cast<std::uint8_t>(*id))) {
    throw InputError("--id", 0, in_quotes(*options.id),
                     std::to_string(first_user_id) + " to " + std::to_string(last_user_id));
  }
  return static_cast<std::uint8_t>(*id);
}

int write_algorithm(const AlgorithmOptions& options) {
  check_algorithm_name(options.name, longest_name, "NAME");
  const std::string out = options.out.value_or(options.name);
  if (out.empty()) {
    throw InputError("--out", 0, "an empty name", "the name of a folder");
  }
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::absolute(out).lexically_normal();
  if (std::filesystem::exists(std::filesystem::symlink_status(folder, error))) {
    throw BadInput(folder.string() + ": found an existing folder or file, expected none; --out FOLDER names another");
  }
  const std::filesystem::path tree = source_tree(options.source);
  check_algorithm_folder(folder.string(), "--out");
  write_new_files(folder, algorithm_files(example_form(options.name, choose_id(options)), tree.string()));
  const auto inside = [&folder](const std::string& path) { return shell_argument((folder / path).string()); };
  std::cout << "build it:  cmake -S " << shell_argument(folder.string()) << " -B " << inside("build")
            << " -G Ninja && cmake --build " << inside("build") << '\n'
            << "then run:  proleg simulate " << inside("robot/robot.simulation.xml") << " --algorithms "
            << inside("build/" + options.name + ".so") << '\n';
  return exit_success;
}

}  // namespace

int new_algorithm(int argc, char** argv) {
  CommandLine command_line("proleg new algorithm",
                           "Writes the folder of an actuation algorithm of your own: one source with a small example, "
                           "its test, a CMake file, and a robot that it moves (docs/user-algorithms.md).");
  AlgorithmOptions options;
  command_line.add_option("NAME", options.name, "of the algorithm: letters, digits and _").required().value_name("");
  command_line.add_option("--out", options.out, "the folder, which must not exist; by default NAME")
      .value_name("FOLDER");
  command_line.add_option("--id", options.id, "of the algorithm, 96 to 126; by default one that follows from NAME")
      .value_name("N");
  command_line.add_option("--source", options.source, "sources of Proleg; by default those of this program")
      .value_name("FOLDER");
  return command_line.run(argc, argv, [&] { return write_algorithm(options); });
}

}  // namespace proleg::tools
