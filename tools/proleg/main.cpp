// The dispatcher: `proleg simulate ...` runs `proleg-simulate ...` in the same folder. Subcommands are separate
// programs, so that none needs the libraries of another; those that need the same ones are one program.

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/build_id.hpp"

namespace {

struct Subcommand {
  std::string_view name;
  std::string_view summary;
  /// What follows "proleg-" in the name of its program; empty: its own name. The program gets the name as argument 0.
  std::string_view program = {};
};

constexpr std::array subcommands{
    Subcommand{"algorithms", "list the algorithms that move a robot, and their parameters"},
    Subcommand{"scenarios", "list the robots and gaits that ship with Proleg"},
    Subcommand{"new", "write the files of a new robot, or of an algorithm of your own"},
    Subcommand{"import", "make a scenario of a robot in URDF"},
    Subcommand{"verify", "prove that an algorithm of your own computes the same bits everywhere"},
    Subcommand{"simulate", "run a scenario in the physics simulation"},
    Subcommand{"ui", "show and drive a robot in the browser"},
    Subcommand{"sweep", "run a scenario with all combinations of some values"},
    Subcommand{"hil", "run a scenario with the program of the modules on a simulated bus"},
    Subcommand{"faults", "list what can be made to fail in a run of hil, or write a schedule of it"},
    Subcommand{"replay", "recompute the gait of a recording and compare it bit for bit"},
    Subcommand{"receipt", "state a run in one line that another machine can verify"},
    Subcommand{"export", "write a recording as a table or a page, or a robot for other simulators"},
    Subcommand{"plot", "draw joint angles, contacts and path of a recording"},
    Subcommand{"optimise", "search for the parameters of a gait"},
    Subcommand{"atlas", "fill a map of many different gaits, and write the scenario of any of them", "optimise"},
    Subcommand{"confirm", "say whether a gait is real or lives on an error of the physics"},
    Subcommand{"adapt", "find a gait that a damaged robot can do, in a few trials", "optimise"},
    Subcommand{"learn-selector", "learn from recordings by which rules a robot chooses its gait", "optimise"},
    Subcommand{"experiment", "repeat an experiment of the thesis and compare with its published numbers"},
    Subcommand{"bus", "serve a simulated robot that other programs reach as a real one"},
    Subcommand{"drive", "move a robot of modules as its scenario says"},
    Subcommand{"scan", "list the modules on a bus"},
    Subcommand{"assign", "give the modules on a bus their places in a robot"},
    Subcommand{"calibrate", "teach a module the feedback potentiometer of its joint"},
    Subcommand{"doctor", "say what is wrong with a bus and the robot on it"},
    Subcommand{"info", "show what a module says of itself"},
    Subcommand{"get", "read objects of modules"},
    Subcommand{"set", "write an object of modules"},
    Subcommand{"monitor", "show what the modules on a bus do"},
    Subcommand{"params", "keep the settings of modules in a text file"},
    Subcommand{"nmt", "start, stop and reset modules"},
    Subcommand{"flash", "bring an image to the modules of a robot"},
    Subcommand{"recover", "bring back modules that do not start, or do not answer"},
    Subcommand{"image", "show and make the images that are flashed into modules"},
    Subcommand{"objects", "list the objects of a module that can be read and set over the bus"},
};

void print_help(std::ostream& out) {
  out << "Usage: proleg SUBCOMMAND [OPTIONS]\n\nSubcommands:\n";
  for (const Subcommand& subcommand : subcommands) {
    out << "  " << subcommand.name << std::string(16 - subcommand.name.size(), ' ') << subcommand.summary << '\n';
  }
  out << "\n'proleg SUBCOMMAND --help' explains a subcommand; 'proleg --version' prints version and build.\n";
}

/// What an unknown word was probably meant to be, as a message ends.
std::string hint(std::string_view word) {
  std::vector<std::string> names;
  names.reserve(subcommands.size());
  for (const Subcommand& subcommand : subcommands) {
    names.emplace_back(subcommand.name);
  }
  const std::optional<std::string> similar = proleg::most_similar(word, names);
  return similar ? "; did you mean 'proleg " + *similar + "'?" : "";
}

/// How a user gets a program that is missing in the folder of this one.
std::string remedy(const std::filesystem::path& folder, const std::string& program) {
  const std::filesystem::path build = folder.parent_path();
  if (!std::filesystem::exists(build / "CMakeCache.txt")) {
    return "install all programs of Proleg into one folder";
  }
  return "build it: cmake --build " + build.string() + " --target " + program;
}

/// The exit status of a program that has printed all it has to.
int finish_output() {
  if (!std::cout.flush()) {
    std::cerr << "proleg: cannot write to standard output\n";
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    print_help(std::cerr);
    return 2;
  }
  const std::string_view word = argv[1];
  if (word == "--help" || word == "-h" || word == "help") {
    print_help(std::cout);
    return finish_output();
  }
  if (word == "--version") {
    std::cout << "proleg " << proleg::tools::build_id << '\n';
    return finish_output();
  }
  const auto subcommand = std::ranges::find(subcommands, word, &Subcommand::name);
  if (subcommand == subcommands.end()) {
    std::cerr << "proleg: found unknown subcommand " << proleg::one_line(proleg::in_quotes(word))
              << ", expected one that 'proleg --help' lists" << hint(word) << '\n';
    return 2;
  }
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::string name = "proleg-" + std::string(subcommand->program.empty() ? word : subcommand->program);
  const std::string program = (folder / name).string();
  std::vector<char*> arguments(argv + 1, argv + argc);
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  std::cerr << "proleg: cannot start " << program << ": "
            << (errno == ENOENT ? "it is not there; " + remedy(folder, name) : std::strerror(errno)) << '\n';
  return 1;
}
