// proleg recover: brings back modules that do not start, or do not answer.

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/program_report.hpp"
#include "tools/proleg/flash/recovery.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
using host::ModuleFault;
using host::Remedy;
namespace flag = broadcast::module_flag;

struct RecoverOptions : BusOptions {
  std::optional<std::string> image;
  std::vector<std::string> serials;
  std::optional<double> wait_s;
  bool reset_settings = false;
  bool dry_run = false;
  ProgramReport report;
};

constexpr const char* row = "%-9s %-11s %-18s %s\n";

RecoverySettings parse(const RecoverOptions& options) {
  constexpr double longest_wait_s = 600;
  RecoverySettings settings;
  for (const std::string& word : options.serials) {
    const bool is_hexadecimal = word.starts_with("0x") || word.starts_with("0X");
    const auto serial = is_hexadecimal ? parse_whole<std::uint32_t>(std::string_view(word).substr(2), 16)
                                       : parse_whole<std::uint32_t>(word);
    if (!serial) {
      throw InputError("--serial", 0, in_quotes(word), "a serial number, as 'proleg scan' shows it: 0x1A2B3C4D");
    }
    settings.serials.push_back(*serial);
  }
  if (options.wait_s) {
    if (*options.wait_s < 0 || *options.wait_s > longest_wait_s) {
      throw InputError("--wait", 0, number_text(*options.wait_s), "seconds, from 0 to 600");
    }
    settings.wait_us = static_cast<Microseconds>(*options.wait_s * 1e6);
  }
  if (options.image) {
    settings.image = host::read_image(*options.image);
  }
  settings.resets_settings = options.reset_settings;
  settings.report = options.report;
  return settings;
}

std::string node_text(const host::FlashCandidate& module) {
  return module.node == 0 ? "no node" : "node " + std::to_string(module.node);
}

std::string program_text(const RecoveredModule& module) {
  const host::ModuleProgram& program = module.now.program;
  return program.image                                        ? host::version_text(*program.image)
         : program.has_answered && program.missing_words == 0 ? "none"
                                                              : "unknown";
}

/// What was found, and what follows.
void print_plan(const Recovery& recovery) {
  for (const RecoveredModule& module : recovery.modules()) {
    for (const ModuleFault& fault : module.first_faults) {
      std::printf("%-9s %-11s %s: %s\n", node_text(module.before).c_str(),
                  hexadecimal(module.before.program.serial, 8).c_str(), fault.text.c_str(), fault.to_do.c_str());
    }
  }
  std::fflush(stdout);
}

/// A line for each thing that a person has to know.
std::vector<std::string> state_lines(const RecoveredModule& module) {
  std::vector<std::string> lines;
  if (!module.is_present) {
    lines.push_back(module.tries.contains(Remedy::start)
                        ? "its program was started, and answers nothing: run 'proleg recover --serial " +
                              hexadecimal(module.now.program.serial, 8) +
                              " IMAGE.pimg', and switch the robot's supply off and on when it waits"
                        : "has answered, and answers no more: run 'proleg recover' again");
  }
  for (const ModuleFault& fault : module.faults) {
    lines.push_back(fault.text + (module.tries.contains(fault.remedy) ? "" : ": " + fault.to_do));
  }
  if (!module.problem.empty()) {
    lines.push_back(module.problem);
  }
  std::string done = lines.empty() ? "well" : "";
  for (const std::string& one : module.done) {
    done += (done.empty() ? "" : "; ") + one;
  }
  if (module.now.node != module.before.node) {
    done += (done.empty() ? "" : "; ") + std::string("its node id was ") +
            (module.before.node == 0 ? "missing" : std::to_string(module.before.node));
  }
  if (!done.empty()) {
    lines.push_back(done);
  }
  return lines;
}

void print_table(const Recovery& recovery) {
  std::printf(row, "module", "serial", "program", "state");
  for (const RecoveredModule& module : recovery.modules()) {
    std::string node = node_text(module.now);
    std::string serial = hexadecimal(module.now.program.serial, 8);
    std::string program = program_text(module);
    for (const std::string& line : state_lines(module)) {
      std::printf(row, node.c_str(), serial.c_str(), program.c_str(), line.c_str());
      node.clear();
      serial.clear();
      program.clear();
    }
  }
  for (const std::uint32_t serial : recovery.missing()) {
    std::printf(row, "-", hexadecimal(serial, 8).c_str(), "-",
                "was not seen: look at its cable and supply; without a bootloader it needs 'proleg flash --bare'");
  }
}

Json faults_json(const std::vector<ModuleFault>& faults) {
  Json list = Json::empty_array();
  for (const ModuleFault& fault : faults) {
    list.append(Json{{"code", code_of(fault.kind)},
                     {"what", fault.text},
                     {"to_do", fault.to_do},
                     {"by_hand", fault.remedy == Remedy::by_hand}});
  }
  return list;
}

Json module_json(const RecoveredModule& module) {
  Json done = Json::empty_array();
  for (const std::string& one : module.done) {
    done.append(one);
  }
  const auto& image = module.now.program.image;
  return {{"serial", module.now.program.serial},
          {"board", unsigned{module.now.board_id}},
          {"node_before", unsigned{module.before.node}},
          {"node", unsigned{module.now.node}},
          {"version", image ? Json(host::version_number_text(image->version)) : Json()},
          {"running", module.now.program.is(flag::runs_program)},
          {"present", module.is_present},
          {"well", module.is_well()},
          {"found", faults_json(module.first_faults)},
          {"done", done},
          {"remains", faults_json(module.faults)},
          {"problem", module.problem.empty() ? Json() : Json(module.problem)}};
}

Json result_json(const RecoverOptions& options, BusAccess& bus, const Recovery& recovery) {
  Json modules = Json::empty_array();
  for (const RecoveredModule& module : recovery.modules()) {
    modules.append(module_json(module));
  }
  Json missing = Json::empty_array();
  for (const std::uint32_t serial : recovery.missing()) {
    missing.append(serial);
  }
  return {{"bus", bus.connection().description()}, {"image", options.image}, {"dry_run", options.dry_run},
          {"well", recovery.are_all_well()},       {"modules", modules},     {"missing", missing}};
}

void report_wait(const ProgramReport& report, const SupplyWait& wait) {
  if (!report.has_events() && wait.rest == wait.longest) {
    std::cerr << "proleg recover: waits up to " << wait.longest / 1'000'000
              << " s for modules whose program does not start: they are silent most of the time; if one answers "
                 "nothing at all, switch the robot's supply off and on now\n";
  }
  report.print_event("waits", {{"seconds", static_cast<double>(wait.longest) / 1e6},
                               {"left_s", static_cast<double>(wait.rest) / 1e6},
                               {"seen", wait.seen}});
}

void report_found(const ProgramReport& report, const Recovery& recovery) {
  if (report.is_text()) {
    print_plan(recovery);
  }
  Json modules = Json::empty_array();
  for (const RecoveredModule& module : recovery.modules()) {
    modules.append({{"node", unsigned{module.before.node}},
                    {"serial", module.before.program.serial},
                    {"found", faults_json(module.first_faults)}});
  }
  report.print_event("found", {{"modules", modules}});
}

int run(const RecoverOptions& options) {
  RecoverySettings settings = parse(options);
  settings.on_wait = [&](const SupplyWait& wait) { report_wait(options.report, wait); };
  BusAccess bus(options);
  catch_interrupts();
  options.report.begin();
  require_no_host(bus);
  Recovery recovery(bus, settings);
  recovery.examine();
  report_found(options.report, recovery);
  if (!options.dry_run) {
    recovery.recover();
  }
  if (options.report.is_text() && !options.dry_run) {
    print_table(recovery);
  }
  options.report.print_result(result_json(options, bus, recovery));
  for (const std::uint8_t node : recovery.silent()) {
    print_warning("proleg recover", "node " + std::to_string(node) +
                                        " sends, and answers nothing: it is no module of Proleg, or has lost its "
                                        "program and its bootloader ('proleg flash --bare')");
  }
  return recovery.are_all_well() ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg recover",
      "Finds modules that do not start, have no program, no node id or that of another module, are Stopped, or do not "
      "know their settings, and brings them back. A module that is well is left alone. Exit status 1: one is not well "
      "in the end; the last table says what to do.");
  RecoverOptions options;
  command_line.add_option("IMAGE", options.image, "the image for modules without a good program, a .pimg file");
  command_line
      .add_option("--wait", options.wait_s,
                  "how long to look for modules: one whose program hangs is silent for 5 s, then in its bootloader. "
                  "Without it 8")
      .value_name("SECONDS");
  command_line
      .add_option("--serial", options.serials,
                  "wait for the module with this serial number, and no longer than that. May be repeated.")
      .value_name("NUMBER");
  command_line.add_flag("--reset-settings", options.reset_settings,
                        "settings that only a later program knows are lost, all but the node id");
  command_line.add_flag("--dry-run", options.dry_run,
                        "only say what is wrong with each module, and what would be done");
  options.report.add_options(command_line);
  add_bus_option(command_line, options);
  return command_line.run(argc, argv, [&] { return run(options); });
}
