// proleg receipt: prints a run in one line, or checks whether it can be repeated here.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/hash/sha256.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/measure/measure.hpp"
#include "sim/physics/physics_error.hpp"
#include "sim/reduced/reduced_world.hpp"
#include "sim/scenario/overrides.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/scenario_run.hpp"
#include "tools/proleg/common/shipped_scenarios.hpp"
#include "tools/proleg/common/terminal.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

/// The inputs that repeat a run, and its result: one line that another computer can verify.
///
///   proleg-receipt:1 scenario=9f86... core=1a2b3c4d engine=reduced-1 seconds=30 seed=7 set=amplitude=41
///   distance=1.6408 world=0f81...
struct Receipt {
  std::string scenario;               ///< SHA-256 of the texts of its files
  std::string core;                   ///< fingerprint of the algorithms
  std::string engine;                 ///< name of the engine with its version
  std::string seconds;                ///< value of --seconds
  sim::OverrideWords overrides;       ///< values of the options, without engine
  std::vector<std::string> settings;  ///< values of --set, in their order
  std::string measure;                ///< name of the measure
  std::string value;                  ///< value of the measure
  std::string world;                  ///< hash of the states of the world

  bool operator==(const Receipt&) const = default;
};

constexpr std::string_view first_word = "proleg-receipt:1";

struct Word {
  std::string_view name;
  std::string Receipt::*text;
};
constexpr Word required_words[] = {{"scenario", &Receipt::scenario},
                                   {"core", &Receipt::core},
                                   {"engine", &Receipt::engine},
                                   {"seconds", &Receipt::seconds},
                                   {"world", &Receipt::world}};

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
  throw InputError("the receipt", 0, found, expected);
}

void take(std::string& place, std::string_view name, std::string_view text) {
  if (!place.empty()) {
    refuse("two words for " + in_quotes(name), "one");
  }
  place = text;
}

const sim::OverrideDeclaration* find_override(std::string_view name) {
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (declaration.name == name && name != "engine") {
      return &declaration;
    }
  }
  return nullptr;
}

void read_word(std::string_view word, Receipt& receipt) {
  const std::size_t equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  const std::string_view text = equals == std::string_view::npos ? "" : word.substr(equals + 1);
  if (text.empty()) {
    refuse(in_quotes(word), "NAME=TEXT");
  }
  for (const Word& required : required_words) {
    if (required.name == name) {
      take(receipt.*required.text, name, text);
      return;
    }
  }
  if (name == "set") {
    receipt.settings.emplace_back(text);
  } else if (const sim::OverrideDeclaration* const declaration = find_override(name)) {
    std::optional<std::string>& place = receipt.overrides.*declaration->word;
    if (place) {
      refuse("two words for " + in_quotes(name), "one");
    }
    place = text;
  } else if (sim::find_measure(name)) {
    take(receipt.measure, "the measure", name);
    receipt.value = text;
  } else {
    refuse(in_quotes(word), "a word of 'proleg receipt': another version may have written it");
  }
}

/// Text of a receipt, without a line feed. The parts must not contain white space.
std::string text_of(const Receipt& receipt) {
  std::string text(first_word);
  const auto add = [&](std::string_view name, const std::string& value) {
    text += ' ' + std::string(name) + '=' + value;
  };
  add("scenario", receipt.scenario);
  add("core", receipt.core);
  add("engine", receipt.engine);
  add("seconds", receipt.seconds);
  for (const sim::OverrideDeclaration& declaration : sim::override_declarations()) {
    if (const std::optional<std::string>& word = receipt.overrides.*declaration.word) {
      add(declaration.name, *word);
    }
  }
  for (const std::string& setting : receipt.settings) {
    add("set", setting);
  }
  add(receipt.measure, receipt.value);
  add("world", receipt.world);
  return text;
}

/// Parses a receipt, with any white space between the words. Throws InputError.
Receipt read_receipt(std::string_view text) {
  const std::vector<std::string_view> all = words(text);
  if (all.empty() || all.front() != first_word) {
    refuse(all.empty() ? "nothing" : in_quotes(all.front()),
           in_quotes(first_word) + " and more, as 'proleg receipt FILE' prints it");
  }
  Receipt receipt;
  for (std::size_t i = 1; i < all.size(); ++i) {
    read_word(all[i], receipt);
  }
  for (const Word& required : required_words) {
    if ((receipt.*required.text).empty()) {
      refuse("no word " + in_quotes(std::string(required.name) + "="), "the whole line");
    }
  }
  if (receipt.measure.empty()) {
    refuse("no measure", "the whole line");
  }
  return receipt;
}

struct ReceiptOptions : ScenarioOptions {
  std::string measure = "distance";
  std::vector<std::string> receipt;  ///< its words; only for `check`
};

/// Hash of the texts of a scenario's files, in the order in which they name each other, without paths and names of
/// files.
std::string hash_of_files(const sim::Scenario& scenario) {
  std::string text;
  for (const sim::SourceFile& source : scenario.sources) {
    text += std::to_string(source.text.size()) + '\n' + source.text.str();
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

/// Whether two values are equal except for rounding: a measure may use the system's mathematics.
bool are_equal(const std::string& a, const std::string& b) {
  const std::optional<double> value_a = parse_number(a);
  const std::optional<double> value_b = parse_number(b);
  return a == b || (value_a && value_b && std::abs(*value_a - *value_b) <= 1e-9 * std::abs(*value_a));
}

/// Text with the version that makes a repetition impossible; empty if it is possible.
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
    add_scenario(command_line, options.file, "scenario").required();
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
