// proleg verify: the proof of tests/identity for the algorithm of a user, from the folder that `proleg new algorithm`
// has written.

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "tests/cortex_m/core_costs.hpp"
#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/golden.hpp"
#include "tests/identity/verify/forbidden_symbols.hpp"
#include "tests/identity/verify/user_builds.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
using namespace proleg::verify;
using identity::Driver;
using identity::Player;
namespace fs = std::filesystem;

/// Limits of docs/user-algorithms.md, on Cortex-M4.
constexpr std::uint64_t most_instructions = 2'500;
constexpr unsigned most_stack = 512;
constexpr unsigned measured_ticks = 200;

struct VerifyOptions {
  std::string folder;
  std::optional<std::string> cases;
  std::string source;
  bool leaves_out_missing = false;
};

/// One way to compute the cases.
struct Row {
  std::string build;
  std::string kernels;  ///< "one" or "five"
  std::function<std::unique_ptr<Player>()> make;
};

class Verification {
 public:
  Verification(const VerifyOptions& options, std::uint32_t cases)
      : options_(options),
        cases_(cases),
        builds_(source_tree(options.source), fs::absolute(options.folder).lexically_normal()) {
    for (const char* program : {"cmake", "ninja"}) {
      if (!is_installed(program)) {
        throw BadInput(std::string("found no ") + program + ", expected it in a folder of PATH; install it");
      }
    }
  }

  bool run() {
    library();
    print_heading();
    // A library that has failed would only fail again, and without a guard.
    if (play({"library", "one", [] { return identity::make_native_player(Driver::whole); }})) {
      for (const char* compiler : {"g++", "clang++"}) {
        play_compiler(compiler);
      }
      play_cortex_m("stm32f405", "Cortex-M4", cortex_m::Cpu::cortex_m4);
      play_cortex_m("cortex-m0", "Cortex-M0", cortex_m::Cpu::cortex_m0);
    }
    for (const std::string& line : lines_) {
      std::cout << line << '\n';
    }
    return is_sound_;
  }

 private:
  void fail(const std::string& line) {
    is_sound_ = false;
    lines_.push_back(line);
  }

  void library() {
    progress("building the library");
    loaded_.push_back(builds_.library().string());
    if (builds_.has_test()) {
      try {
        builds_.run_test();
        lines_.push_back("test       passed: " + builds_.name() + "_test");
      } catch (const BuildError& error) {
        fail("test       fails: " + builds_.name() + "_test: " + error.what());
      }
    }
    load_algorithms(loaded_);
    algorithm_ = identity::find_algorithm(id_of_loaded());
    std::printf("%s: id %u, sources %s, %u cases of %u ticks\n\n", std::string(algorithm_->declaration().name).c_str(),
                unsigned{algorithm_->declaration().id}, hexadecimal(algorithm_->declaration().sources, 8).c_str(),
                cases_, identity::tick_count);
  }

  static std::uint8_t id_of_loaded() { return algorithm_at(algorithm_count() - 1).declaration().id; }

  static void print_heading() {
    std::printf("%-14s %-8s %-14s %-14s %s\n", "build", "kernels", "set-points", "servo", "result");
  }

  static void progress(const std::string& what) {
    if (isatty(STDERR_FILENO) != 0) {
      std::cerr << "\r\033[K" << what << std::flush << "\r\033[K";
    }
  }

  void not_run(const std::string& build, const std::string& kernels, const std::string& missing) {
    std::printf("%-14s %-8s %-14s %-14s not run: no %s\n", build.c_str(), kernels.c_str(), "", "", missing.c_str());
    if (!options_.leaves_out_missing) {
      is_sound_ = false;
      if (!says_missing_) {
        lines_.push_back("missing    compilers are not installed; --leave-out-missing accepts that");
        says_missing_ = true;
      }
    }
  }

  /// Returns whether there is a result, equal or not.
  bool play(const Row& row) {
    progress("playing " + row.build);
    std::string result;
    identity::Golden found{};
    try {
      const std::unique_ptr<Player> player = row.make();
      found = identity::hash_cases(*player, *algorithm_, cases_);
      if (!reference_) {
        reference_ = row;
        expected_ = found;
        result = "reference";
      } else if (found == expected_) {
        result = "equal";
      } else {
        const std::unique_ptr<Player> again = row.make();
        const std::unique_ptr<Player> reference = reference_->make();
        result = "DIFFERS: " + identity::first_difference(*again, *reference, *algorithm_, cases_);
        is_sound_ = false;
      }
    } catch (const std::exception& error) {
      result = std::string("FAILS: ") + error.what();
      is_sound_ = false;
    }
    std::printf("%-14s %-8s %-14s %-14s %s\n", row.build.c_str(), row.kernels.c_str(),
                found.setpoints.substr(0, 12).c_str(), found.servo_commands.substr(0, 12).c_str(), result.c_str());
    std::fflush(stdout);
    return !found.setpoints.empty();
  }

  void play_compiler(const std::string& compiler) {
    std::optional<fs::path> variants;
    if (is_installed(compiler)) {
      progress("building with " + compiler);
      variants = builds_.variants(compiler);
    }
    for (const char* level : {"O0", "O2"}) {
      const std::string build = compiler + " -" + level;
      for (const Driver driver : {Driver::whole, Driver::modules}) {
        const char* const kernels = driver == Driver::whole ? "one" : "five";
        if (!variants) {
          not_run(build, kernels, compiler);
          continue;
        }
        const std::string program = (*variants / (std::string("variant_") + level)).string();
        play({build, kernels, [=, this] { return identity::make_variant_player(program, driver, cases_); }});
      }
    }
  }

  void play_cortex_m(const std::string& preset, const std::string& cpu_name, cortex_m::Cpu cpu) {
    if (!is_installed("arm-none-eabi-g++")) {
      not_run(cpu_name, "five", "arm-none-eabi-g++");
      return;
    }
    progress("building for " + cpu_name);
    const fs::path object = builds_.cortex_m_object(preset);
    if (cpu == cortex_m::Cpu::cortex_m4) {
      look_at_symbols(object);
    }
    fs::path image;
    try {
      image = builds_.cortex_m_image(preset);
    } catch (const BuildError& error) {
      std::printf("%-14s %-8s %-14s %-14s FAILS: %s\n", cpu_name.c_str(), "five", "", "", error.what());
      is_sound_ = false;
      return;
    }
    play({cpu_name, "five", [=] { return identity::make_cortex_m_player(cpu, image); }});
    if (cpu == cortex_m::Cpu::cortex_m4) {
      measure(image);
    }
  }

  void look_at_symbols(const fs::path& object) {
    std::FILE* const pipe = popen(("arm-none-eabi-nm -C '" + object.string() + "'").c_str(), "r");
    std::string listing;
    std::array<char, 4096> bytes{};
    for (std::size_t size = 0; pipe != nullptr && (size = std::fread(bytes.data(), 1, bytes.size(), pipe)) > 0;) {
      listing.append(bytes.data(), size);
    }
    if (pipe == nullptr || pclose(pipe) != 0 || listing.empty()) {
      throw std::runtime_error("arm-none-eabi-nm does not read " + object.string());
    }
    const std::vector<std::string> found = forbidden_symbols(listing);
    for (const std::string& each : found) {
      fail("code       FORBIDDEN: " + builds_.name() + ".cpp " + each);
    }
    if (found.empty()) {
      lines_.push_back("code       uses neither floating point nor heap nor variables of its own");
    }
  }

  void measure(const fs::path& image_file) {
    try {
      const cortex_m::ElfImage image(image_file);
      cortex_m::Machine machine(image, cortex_m::Cpu::cortex_m4);
      const cortex_m::TickCost cost = cortex_m::measure_tick(machine, algorithm_->declaration().id, measured_ticks);
      const bool fits = cost.total.worst <= most_instructions;
      std::ostringstream line;
      line << "cost       " << (fits ? "" : "TOO HIGH: ") << cost.total.worst << " instructions a tick at worst, "
           << static_cast<std::uint64_t>(cost.total.mean) << " on average, with default parameters; limit "
           << most_instructions;
      fits ? lines_.push_back(line.str()) : fail(line.str());
    } catch (const std::exception& error) {
      fail(std::string("cost       FAILS: ") + error.what());
    }
    std::ifstream bounds(fs::path(image_file).replace_extension(".stack.tsv"));
    std::string function;
    std::string deepest;
    unsigned bytes = 0;
    unsigned worst = 0;
    while (bounds >> function >> bytes) {
      if (bytes > worst) {
        worst = bytes;
        deepest = function;
      }
    }
    const std::string line =
        std::to_string(worst) + " bytes at most, in " + deepest + "; limit " + std::to_string(most_stack);
    worst > 0 && worst <= most_stack ? lines_.push_back("stack      " + line) : fail("stack      TOO MUCH: " + line);
  }

  const VerifyOptions& options_;
  std::uint32_t cases_;
  UserBuilds builds_;
  std::vector<std::string> loaded_;
  const ActuationModule* algorithm_ = nullptr;
  std::optional<Row> reference_;
  identity::Golden expected_{};
  std::vector<std::string> lines_;  ///< what follows the table
  bool is_sound_ = true;
  bool says_missing_ = false;
};

int verify_algorithm(const VerifyOptions& options) {
  const std::optional<std::uint32_t> cases =
      options.cases ? parse_whole<std::uint32_t>(*options.cases) : std::optional(identity::quick_cases);
  if (!cases || *cases == 0 || *cases > 100'000) {
    throw InputError("--cases", 0, in_quotes(*options.cases), "a whole number from 1 to 100000");
  }
  try {
    Verification verification(options, *cases);
    const bool is_sound = verification.run();
    std::cout << (is_sound ? "verified: the same bits everywhere\n" : "NOT verified\n");
    return is_sound ? exit_success : exit_failed;
  } catch (const BuildError& error) {
    throw BadInput(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg verify",
      "Proves that an algorithm of your own computes the same bits with gcc and clang, with and without optimisation, "
      "in one kernel and in five modules, and on emulated Cortex-M4 and Cortex-M0; prints what it costs.");
  VerifyOptions options;
  command_line.add_option("FOLDER", options.folder, "of the algorithm, as 'proleg new algorithm' has written it")
      .required()
      .value_name("");
  command_line.add_option("--cases", options.cases, "random cases of 1000 ticks; by default 50").value_name("N");
  command_line.add_option("--source", options.source, "checkout of Proleg; by default the one of this program")
      .value_name("FOLDER");
  command_line.add_flag("--leave-out-missing", options.leaves_out_missing,
                        "success even if a compiler is not installed");
  return command_line.run(argc, argv, [&] { return verify_algorithm(options); });
}
