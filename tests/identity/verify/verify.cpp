// proleg verify: the proof of tests/identity for the algorithm of a user, from the folder that `proleg new algorithm`
// has written.

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "shared/computer/algorithm_library/algorithm_library.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/registry.hpp"
#include "tests/cortex_m/core_costs.hpp"
#include "tests/identity/cortex_m_player.hpp"
#include "tests/identity/golden.hpp"
#include "tests/identity/verify/forbidden_symbols.hpp"
#include "tests/identity/verify/proof.hpp"
#include "tests/identity/verify/user_builds.hpp"
#include "tools/proleg/common/child_program.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
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
  bool json = false;
};

/// What a program prints on standard output and standard error. Throws std::runtime_error if it fails.
std::string output_of(const std::vector<std::string>& command) {
  constexpr std::chrono::milliseconds period{2};
  ChildProgram program(command, "/");
  std::string output;
  while (!program.status()) {
    output += program.read();
    std::this_thread::sleep_for(period);
  }
  output += program.read();
  if (program.status() != 0) {
    throw std::runtime_error(command.front() + " fails: " + one_line(output));
  }
  return output;
}

/// Says what is done, on standard error: with --json each step has a line, for programs; else a terminal has one line
/// for all of them, which goes.
class Progress {
 public:
  Progress(bool is_for_programs, unsigned steps) : is_for_programs_(is_for_programs), steps_(steps) {}

  void begin(const std::string& step) {
    ++step_;
    if (is_for_programs_) {
      std::cerr << "proleg verify: " << step_ << " of " << steps_ << ": " << step << '\n' << std::flush;
    } else if (isatty(STDERR_FILENO) != 0) {
      std::cerr << "\r\033[K" << step << std::flush << "\r\033[K";
    }
  }

 private:
  bool is_for_programs_;
  unsigned steps_;
  unsigned step_ = 0;
};

/// As long as it exists, what is printed on standard output appears on standard error.
class OutputAside {
 public:
  OutputAside() : output_(fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)) {
    dup2(STDERR_FILENO, STDOUT_FILENO);
  }
  ~OutputAside() {
    std::cout.flush();
    std::fflush(stdout);
    dup2(output_, STDOUT_FILENO);
    close(output_);
  }
  OutputAside(const OutputAside&) = delete;
  OutputAside& operator=(const OutputAside&) = delete;

 private:
  int output_;
};

constexpr std::array<const char*, 2> compilers{"g++", "clang++"};
constexpr const char* arm_compiler = "arm-none-eabi-g++";

unsigned step_count() {
  constexpr unsigned of_compiler = 5;
  constexpr unsigned of_arm = 5;
  unsigned steps = 2;
  for (const char* compiler : compilers) {
    steps += is_installed(compiler) ? of_compiler : 0;
  }
  return steps + (is_installed(arm_compiler) ? of_arm : 0);
}

/// How a row is played.
using PlayerMaker = std::function<std::unique_ptr<Player>()>;

class Verification {
 public:
  Verification(const VerifyOptions& options, std::uint32_t cases)
      : prints_(!options.json),
        builds_(source_tree(options.source), fs::absolute(options.folder).lexically_normal()),
        progress_(options.json, step_count()) {
    for (const char* program : {"cmake", "ninja"}) {
      if (!is_installed(program)) {
        throw BadInput(std::string("found no ") + program +
                       ", expected it in a folder of PATH: " + installing_command({program}));
      }
    }
    proof_.cases = cases;
    proof_.ticks = identity::tick_count;
    proof_.leaves_out_missing = options.leaves_out_missing;
  }

  Proof run() {
    if (builds_.are_aside()) {
      std::cerr << "proleg verify: cannot write to the folder of the algorithm; builds are in "
                << builds_.place().string() << '\n';
    }
    library();
    print(heading_text(proof_));
    // A library that has failed would only fail again, and without a guard.
    if (play("library", Driver::whole, [] { return identity::make_native_player(Driver::whole); })) {
      for (const char* compiler : compilers) {
        play_compiler(compiler);
      }
      play_cortex_m("stm32f405", "Cortex-M4", cortex_m::Cpu::cortex_m4);
      play_cortex_m("cortex-m0", "Cortex-M0", cortex_m::Cpu::cortex_m0);
    }
    for (const std::string& line : result_lines(proof_)) {
      print(line);
    }
    return proof_;
  }

 private:
  void print(const std::string& line) const {
    if (prints_) {
      std::cout << line << std::endl;  // rows appear as they are played
    }
  }

  void library() {
    progress_.begin("building the library");
    loaded_.push_back(builds_.library().string());
    if (builds_.has_test()) {
      proof_.test = TestResult{builds_.name() + "_test", ""};
      try {
        builds_.run_test();
      } catch (const BuildError& error) {
        proof_.test->error = error.what();
      }
    }
    load_algorithms(loaded_);
    algorithm_ = identity::find_algorithm(id_of_loaded());
    proof_.algorithm = algorithm_->declaration().name;
    proof_.id = algorithm_->declaration().id;
    proof_.sources = algorithm_->declaration().sources;
  }

  static std::uint8_t id_of_loaded() { return algorithm_at(algorithm_count() - 1).declaration().id; }

  void add_row(ProofRow row) {
    print(row_text(row));
    proof_.rows.push_back(std::move(row));
  }

  void not_run(const std::string& build, Driver driver, const std::string& missing) {
    add_row({build, kernels_of(driver), ProofRow::Result::not_run, "", "", missing});
  }

  static unsigned kernels_of(Driver driver) { return driver == Driver::whole ? 1 : identity::joint_count; }

  /// Returns whether there is a result, equal or not.
  bool play(const std::string& build, Driver driver, const PlayerMaker& make) {
    progress_.begin("playing " + build + (driver == Driver::whole ? ", one kernel" : ", five modules"));
    ProofRow row{build, kernels_of(driver), ProofRow::Result::failed, "", "", ""};
    try {
      const std::unique_ptr<Player> player = make();
      const identity::Golden found = identity::hash_cases(*player, *algorithm_, proof_.cases);
      row.setpoint_hash = found.setpoints;
      row.servo_hash = found.servo_commands;
      if (!reference_) {
        reference_ = make;
        expected_ = found;
        row.result = ProofRow::Result::reference;
      } else if (found == expected_) {
        row.result = ProofRow::Result::equal;
      } else {
        row.result = ProofRow::Result::differs;
        const std::unique_ptr<Player> again = make();
        const std::unique_ptr<Player> reference = reference_();
        row.text = identity::first_difference(*again, *reference, *algorithm_, proof_.cases);
      }
    } catch (const std::exception& error) {
      row.result = ProofRow::Result::failed;
      row.text = error.what();
    }
    const bool was_played = !row.setpoint_hash.empty();
    add_row(std::move(row));
    return was_played;
  }

  void play_compiler(const std::string& compiler) {
    std::optional<fs::path> variants;
    if (is_installed(compiler)) {
      progress_.begin("building with " + compiler);
      variants = builds_.variants(compiler);
    }
    for (const char* level : {"O0", "O2"}) {
      const std::string build = compiler + " -" + level;
      for (const Driver driver : {Driver::whole, Driver::modules}) {
        if (!variants) {
          not_run(build, driver, compiler);
          continue;
        }
        const std::string program = (*variants / (std::string("variant_") + level)).string();
        play(build, driver, [=, this] { return identity::make_variant_player(program, driver, proof_.cases); });
      }
    }
  }

  void play_cortex_m(const std::string& preset, const std::string& cpu_name, cortex_m::Cpu cpu) {
    if (!is_installed(arm_compiler)) {
      not_run(cpu_name, Driver::modules, arm_compiler);
      return;
    }
    progress_.begin("building for " + cpu_name);
    const fs::path object = builds_.cortex_m_object(preset);
    if (cpu == cortex_m::Cpu::cortex_m4) {
      proof_.forbidden = forbidden_symbols(output_of({"arm-none-eabi-nm", "-C", object.string()}));
      proof_.flash_bytes = flash_bytes(output_of({"arm-none-eabi-size", object.string()}));
    }
    fs::path image;
    try {
      image = builds_.cortex_m_image(preset);
    } catch (const BuildError& error) {
      add_row({cpu_name, kernels_of(Driver::modules), ProofRow::Result::failed, "", "", error.what()});
      return;
    }
    play(cpu_name, Driver::modules, [=] { return identity::make_cortex_m_player(cpu, image); });
    if (cpu == cortex_m::Cpu::cortex_m4) {
      measure(image);
    }
  }

  void measure(const fs::path& image_file) {
    progress_.begin("measuring on Cortex-M4");
    proof_.cost = TickInstructions{0, 0, most_instructions, ""};
    try {
      const cortex_m::ElfImage image(image_file);
      cortex_m::Machine machine(image, cortex_m::Cpu::cortex_m4);
      const cortex_m::TickCost cost = cortex_m::measure_tick(machine, algorithm_->declaration().id, measured_ticks);
      proof_.cost->worst = cost.total.worst;
      proof_.cost->mean = cost.total.mean;
    } catch (const std::exception& error) {
      proof_.cost->error = error.what();
    }
    proof_.stack = StackBound{0, "", most_stack};
    std::ifstream bounds(fs::path(image_file).replace_extension(".stack.tsv"));
    std::string function;
    unsigned bytes = 0;
    while (bounds >> function >> bytes) {
      if (bytes > proof_.stack->bytes) {
        proof_.stack->bytes = bytes;
        proof_.stack->function = function;
      }
    }
  }

  bool prints_;
  UserBuilds builds_;
  Progress progress_;
  Proof proof_;
  std::vector<std::string> loaded_;
  const ActuationModule* algorithm_ = nullptr;
  PlayerMaker reference_;
  identity::Golden expected_{};
};

Proof prove(const VerifyOptions& options, std::uint32_t cases) {
  // What the algorithm prints may not come between the lines of the object.
  std::optional<OutputAside> aside;
  if (options.json) {
    aside.emplace();
  }
  return Verification(options, cases).run();
}

int verify_algorithm(const VerifyOptions& options) {
  const std::optional<std::uint32_t> cases =
      options.cases ? parse_whole<std::uint32_t>(*options.cases) : std::optional(identity::quick_cases);
  if (!cases || *cases == 0 || *cases > 100'000) {
    throw InputError("--cases", 0, in_quotes(*options.cases), "a whole number from 1 to 100000");
  }
  try {
    const Proof proof = prove(options, *cases);
    if (options.json) {
      std::cout << proof_json(proof) << '\n';
    }
    return is_sound(proof) ? exit_success : exit_failed;
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
  command_line.add_option("--source", options.source, "sources of Proleg; by default those of this program")
      .value_name("FOLDER");
  command_line.add_flag("--leave-out-missing", options.leaves_out_missing,
                        "success even if a compiler is not installed");
  command_line.add_flag("--json", options.json, "print one JSON object; standard error says what is done");
  return command_line.run(argc, argv, [&] { return verify_algorithm(options); });
}
