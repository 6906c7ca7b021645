#include "tools/proleg/new/new_files.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/crc32.hpp"
#include "shared/gait/registry.hpp"
#include "sim/authoring/new_scenario.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::tools {
namespace {

/// The folder of the algorithm, its id, and its checkout, for the commands in README.md.
struct AlgorithmPlace {
  std::string name;
  std::uint8_t id;
  std::string folder;
  std::string source_tree;
};

std::string filled(std::string_view text, const AlgorithmPlace& place) {
  std::string result(text);
  const auto replace = [&result](std::string_view key, const std::string& value) {
    for (std::size_t at = result.find(key); at != std::string::npos; at = result.find(key, at + value.size())) {
      result.replace(at, key.size(), value);
    }
  };
  replace("@NAME@", place.name);
  replace("@ID@", std::to_string(place.id));
  replace("@SOURCE@", place.source_tree);
  replace("@FOLDER@", place.folder);
  return result;
}

/// The files: one source with a small algorithm that moves a robot, its test, CMakeLists.txt, README.md, and in robot/
/// the files of a robot of five joints that it moves.
std::vector<sim::SourceFile> algorithm_files(const AlgorithmPlace& place) {
  std::vector<sim::SourceFile> files{{"README.md", filled(algorithm_readme_text(), place)},
                                     {place.name + ".cpp", filled(algorithm_source_text(), place)},
                                     {place.name + "_test.cpp", filled(algorithm_test_text(), place)},
                                     {"CMakeLists.txt", filled(algorithm_cmake_text(), place)}};
  for (sim::SourceFile& file : sim::new_scenario_files(sim::robot_kinds().front(), "ppppp")) {
    if (file.path == "robot.actuation.xml") {
      file.text = filled(algorithm_actuation_text(), place);
    }
    files.push_back({"robot/" + file.path, std::move(file.text)});
  }
  return files;
}

struct AlgorithmOptions {
  std::string name;
  std::optional<std::string> out;
  std::optional<std::string> id;
  std::string source;
};

constexpr std::size_t longest_name = 40;

/// Words that C++ or the example needs, and names of CMake's targets: a function or a target with such a name does not
/// compile.
constexpr std::array reserved{"about",
                              "alignas",
                              "alignof",
                              "all",
                              "amplitude",
                              "and",
                              "and_eq",
                              "asm",
                              "auto",
                              "bitand",
                              "bitor",
                              "bool",
                              "break",
                              "case",
                              "catch",
                              "char",
                              "char16_t",
                              "char32_t",
                              "char8_t",
                              "class",
                              "clean",
                              "co_await",
                              "co_return",
                              "co_yield",
                              "compl",
                              "concept",
                              "const",
                              "const_cast",
                              "consteval",
                              "constexpr",
                              "constinit",
                              "continue",
                              "decltype",
                              "default",
                              "delete",
                              "depend",
                              "do",
                              "double",
                              "dynamic_cast",
                              "edit_cache",
                              "else",
                              "enum",
                              "explicit",
                              "export",
                              "extern",
                              "false",
                              "float",
                              "for",
                              "frame",
                              "frequency",
                              "friend",
                              "goto",
                              "help",
                              "if",
                              "inline",
                              "install",
                              "instance",
                              "int",
                              "internal_values",
                              "list_install_components",
                              "long",
                              "main",
                              "mutable",
                              "namespace",
                              "new",
                              "noexcept",
                              "not",
                              "not_eq",
                              "nullptr",
                              "operator",
                              "or",
                              "or_eq",
                              "package",
                              "package_source",
                              "parameters",
                              "phase_difference",
                              "preinstall",
                              "private",
                              "proleg",
                              "proleg_core",
                              "protected",
                              "public",
                              "rebuild_cache",
                              "register",
                              "reinterpret_cast",
                              "requires",
                              "return",
                              "short",
                              "signed",
                              "sine",
                              "sizeof",
                              "static",
                              "static_assert",
                              "static_cast",
                              "steepness",
                              "struct",
                              "switch",
                              "template",
                              "test",
                              "tested_algorithm",
                              "this",
                              "thread_local",
                              "throw",
                              "true",
                              "try",
                              "typedef",
                              "typeid",
                              "typename",
                              "union",
                              "unsigned",
                              "user",
                              "using",
                              "virtual",
                              "void",
                              "volatile",
                              "wchar_t",
                              "while",
                              "xor",
                              "xor_eq",
                              "Algorithm",
                              "Parameter"};

void check_name(const std::string& name) {
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  const bool well_formed =
      !name.empty() && name.size() <= longest_name && is_letter(name.front()) &&
      std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
  if (!well_formed || name.ends_with("_test") || name.find("__") != std::string::npos) {
    throw InputError("NAME", 0, in_quotes(name),
                     "a letter, then up to " + std::to_string(longest_name - 1) +
                         " letters, digits and single _, that does not end in _test");
  }
  if (std::ranges::find(reserved, name) != reserved.end()) {
    throw InputError("NAME", 0, in_quotes(name), "a name that C++ or the example does not use");
  }
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    if (lower_case(algorithm_at(i).declaration().name) == lower_case(name)) {
      throw InputError("NAME", 0, in_quotes(name) + ", a built-in algorithm", "another name");
    }
  }
}

/// Chooses the id; the default depends on the name: algorithms with different names rarely have the same one.
std::uint8_t choose_id(const AlgorithmOptions& options) {
  if (!options.id) {
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(options.name.data()), options.name.size());
    return static_cast<std::uint8_t>(first_user_id + crc32(bytes) % max_user_algorithms);
  }
  const std::optional<unsigned> id = parse_whole<unsigned>(*options.id);
  if (!id || *id > last_user_id || !is_user_algorithm(static_cast<std::uint8_t>(*id))) {
    throw InputError("--id", 0, in_quotes(*options.id),
                     std::to_string(first_user_id) + " to " + std::to_string(last_user_id));
  }
  return static_cast<std::uint8_t>(*id);
}

int write_algorithm(const AlgorithmOptions& options) {
  check_name(options.name);
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
  if (const std::string text = folder.string(); text.find_first_of(";\"\\$ \t\n") != std::string::npos) {
    throw InputError("--out", 0, in_quotes(text),
                     "a folder without blanks and ; \" \\ $, which CMake treats specially");
  }
  write_new_files(folder, algorithm_files({options.name, choose_id(options), folder.string(), tree.string()}));
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
  command_line.add_option("--source", options.source, "checkout of Proleg; by default the one of this program")
      .value_name("FOLDER");
  return command_line.run(argc, argv, [&] { return write_algorithm(options); });
}

}  // namespace proleg::tools
