// proleg receipt: a run in one line, and whether it can be repeated here.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/reduced/reduced_world.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/run_progress.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/run/receipt_text.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct ReceiptOptions : ScenarioOptions {
  std::string measure = "distance";
  std::vector<std::string> receipt;  ///< its words; only for `check`
};

/// Of the texts of a scenario's files, in the order in which they name each other. Paths and names of files do not
/// count.
std::string hash_of_files(const sim::Scenario& scenario) {
  std::string text;
  for (const sim::SourceFile& source : scenario.sources) {
    text += std::to_string(source.text.size()) + '\n' + source.text;
  }
  return sha256_hex(text);
}

/// Runs the scenario of the options in the reduced engine.
Receipt run(const ReceiptOptions& options) {
  const std::optional<sim::Measure> measure = sim::find_measure(options.measure);
  if (!measure) {
    throw InputError("--measure", 0, in_quotes(options.measure), "one of " + listed(sim::measure_names()));
  }
  ScenarioOptions with_engine = options;
  with_engine.overrides.engine = "reduced";
  const ScenarioRun setup = prepare_run(with_engine);
  sim::Simulation simulation(setup.scenario);
  RunProgress progress("simulating", setup.scenario.duration_s);
  while (simulation.tick() < setup.ticks) {
    simulation.advance();
    progress.show(simulation.time_s());
  }
  Receipt receipt;
  receipt.scenario = hash_of_files(setup.scenario);
  receipt.core = hexadecimal(core_fingerprint, 8);
  receipt.engine = "reduced-" + std::to_string(sim::reduced::engine_version);
  receipt.seconds = exact_text(setup.scenario.duration_s);
  receipt.overrides = sim::words_of(setup.scenario.overrides);
  receipt.overrides.engine.reset();
  receipt.settings = options.settings;
  receipt.measure = options.measure;
  receipt.value = exact_text(simulation.measures()[*measure]);
  receipt.world = simulation.world_hash().value();
  return receipt;
}

int print_receipt(const ReceiptOptions& options) {
  const Receipt receipt = run(options);
  if (options.json) {
    std::cout << Json{{"receipt", text_of(receipt)}, {"world_hash", receipt.world}}.text() << '\n';
  } else {
    std::cout << text_of(receipt) << '\n';
  }
  return exit_success;
}

/// Values of an equal motion differ by rounding at most, where a measure uses the system's mathematics.
bool are_equal(const std::string& a, const std::string& b) {
  const std::optional<double> value_a = parse_number(a);
  const std::optional<double> value_b = parse_number(b);
  return a == b || (value_a && value_b && std::abs(*value_a - *value_b) <= 1e-9 * std::abs(*value_a));
}

/// What makes a repetition impossible; empty: nothing.
std::string other_version(const Receipt& stated, const Receipt& here) {
  if (stated.scenario != here.scenario) {
    return "the files of the scenario are not those of the receipt: their hash is " + here.scenario +
           ", the receipt has " + stated.scenario;
  }
  if (stated.engine != here.engine) {
    return "the receipt is of the engine " + stated.engine + ", this program has " + here.engine;
  }
  if (stated.core != here.core) {
    return "the receipt is of other algorithms: core " + stated.core + ", this program has " + here.core;
  }
  return {};
}

int check(const ReceiptOptions& options) {
  std::string text;
  for (const std::string& word : options.receipt) {
    text += word + ' ';
  }
  const Receipt stated = read_receipt(text);
  ReceiptOptions again;
  again.file = options.file;
  again.seconds = stated.seconds;
  again.overrides = stated.overrides;
  again.settings = stated.settings;
  again.measure = stated.measure;
  const auto start = std::chrono::steady_clock::now();
  const Receipt here = run(again);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string reason = other_version(stated, here);
  const bool same_world = stated.world == here.world;
  const bool same_value = are_equal(stated.value, here.value);
  const bool holds = reason.empty() && same_world && same_value;
  if (options.json) {
    std::cout << Json{{"holds", holds},           {"reason", reason},          {"same_world", same_world},
                      {"same_value", same_value}, {"measure", stated.measure}, {"stated_value", stated.value},
                      {"value", here.value},      {"wall_s", seconds}}
                     .text()
              << '\n';
  } else if (holds) {
    std::printf("the receipt holds: %s %s, the same world in all %s s, bit for bit (%.2f s)\n", stated.measure.c_str(),
                here.value.c_str(), stated.seconds.c_str(), seconds);
  }
  if (!holds) {
    std::cerr << "proleg receipt: the receipt does not hold: "
              << (!reason.empty() ? reason
                  : !same_world   ? "the world moves otherwise; " + stated.measure + " is " + here.value +
                                      ", the receipt has " + stated.value
                                : stated.measure + " is " + here.value + ", the receipt has " + stated.value)
              << '\n';
  }
  return holds ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  ReceiptOptions options;
  if (argc > 1 && std::string_view(argv[1]) == "check") {
    CommandLine command_line("proleg receipt check",
                             "Repeats the run of a receipt and compares it, bit for bit.\n"
                             "Without RECEIPT, the receipt is read from standard input.");
    command_line.add_option("FILE", options.file, "scenario, a *.simulation.xml file").required();
    command_line.add_option("RECEIPT", options.receipt, "the line that 'proleg receipt FILE' printed").takes_several();
    command_line.add_flag("--json", options.json, "print one JSON object");
    command_line.add_algorithms_option();
    return command_line.run(argc - 1, argv + 1, [&] {
      if (options.receipt.empty()) {
        std::string line;
        std::getline(std::cin, line);
        options.receipt.push_back(line);
      }
      return check(options);
    });
  }
  CommandLine command_line(
      "proleg receipt",
      "Runs a scenario in the reduced engine and prints a receipt: one line that repeats the run on "
      "another machine.\n'proleg receipt check FILE RECEIPT' verifies it.");
  add_start_options(command_line, options);
  command_line.add_option("--measure", options.measure, "the measure that the receipt states (docs/gait-measures.md)")
      .shows_default();
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return print_receipt(options); });
}
