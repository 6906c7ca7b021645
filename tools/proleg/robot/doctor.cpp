// proleg doctor: what is wrong with a bus and the robot on it, and what to do.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/robot/bus_examination.hpp"
#include "host/robot/findings.hpp"
#include "host/robot/state_text.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;
using host::BusAddress;
using host::BusObservations;
using host::Finding;

struct DoctorOptions : BusOptions {
  bool json = false;
};

/// What was found, and of which bus.
struct Report {
  std::string bus;
  std::vector<Finding> findings;
  std::optional<BusObservations> observations;  ///< nothing: the bus was not opened
};

/// The bus of `--bus auto`; if there is none to examine, the findings say why.
std::optional<std::string> choose_bus(std::vector<Finding>& findings) {
  const std::vector<std::string> addresses = present_buses();
  if (addresses.size() == 1) {
    return addresses.front();
  }
  if (addresses.empty()) {
    findings.push_back({"no_adapter",
                        "This computer has no CAN interface and no serial adapter.",
                        "Plug the adapter in, or name the bus with --bus. ls /dev/ttyUSB* /dev/ttyACM* shows adapters "
                        "without a stable name.",
                        {}});
    return std::nullopt;
  }
  try {
    return find_bus();
  } catch (const std::runtime_error& error) {
    findings.push_back({"no_bus_found",
                        std::string(error.what()) + ".",
                        "Name the bus that is to be examined: " + listed(addresses) + ", each with --bus.",
                        {}});
    return std::nullopt;
  }
}

host::ConnectionFacts read_facts(const BusAddress& address) {
  host::ConnectionFacts facts;
  facts.address = address;
  if (address.kind == BusAddress::Kind::can) {
    facts.can = host::read_can_interface(address.name);
  } else if (address.kind == BusAddress::Kind::serial) {
    facts.serial = host::read_serial_device(address.name);
  }
  return facts;
}

BusObservations examine(BusAccess& bus) {
  host::BusConnection& connection = bus.connection();
  host::BusExamination examination(connection, [&connection] {
    return host::OwnEnd{connection.state(), connection.statistics()};
  });
  constexpr Microseconds longest = 60'000'000;
  const host::BusAttachment attachment(connection, examination);
  examination.start(connection.now());
  connection.run_until(connection.now() + longest, [&] { return examination.is_done() || interrupted(); });
  if (!examination.is_done()) {
    throw std::runtime_error(interrupted() ? "interrupted" : "the examination has not ended in time");
  }
  return examination.observations();
}

Report examine(const std::string& word) {
  Report report;
  const auto chosen = word == "auto" ? choose_bus(report.findings) : std::optional(word);
  report.bus = chosen.value_or(word);
  if (!chosen) {
    return report;
  }
  host::ConnectionFacts facts = read_facts(host::parse_bus_address(*chosen));
  report.findings = find_connection_faults(facts);
  if (std::ranges::any_of(report.findings, host::blocks)) {
    return report;
  }
  try {
    BusOptions options;
    options.bus = *chosen;
    BusAccess bus(options);
    report.bus = bus.connection().description();
    report.observations = examine(bus);
    std::vector<Finding> faults = find_bus_faults(*report.observations, facts.address, {core_fingerprint});
    // What slows this computer down is less urgent.
    report.findings.insert(report.findings.begin(), faults.begin(), faults.end());
  } catch (const host::TransportError& error) {
    facts.failure = {error.problem(), error.what()};
    report.findings = find_connection_faults(facts);
  }
  return report;
}

Json json_of(const Finding& finding) {
  Json nodes = Json::empty_array();
  for (const std::uint8_t node : finding.nodes) {
    nodes.append(unsigned{node});
  }
  return {{"code", finding.code}, {"what", finding.what}, {"to_do", finding.to_do}, {"nodes", nodes}};
}

Json json_of(const std::vector<canopen::EmergencyCode>& codes) {
  Json list = Json::empty_array();
  for (const canopen::EmergencyCode code : codes) {
    list.append(canopen::describe(code));
  }
  return list;
}

Json json_of(const host::ObservedNode& node) {
  const auto& answers = node.answers;
  const bool is_module = answers && answers->is_module;
  return {{"node", unsigned{node.node}},
          {"answers", answers.has_value()},
          {"state", node.state ? Json(host::state_text(*node.state)) : Json()},
          {"boot_ups", node.boot_ups},
          {"joint_module", is_module},
          {"drive", is_module ? Json(host::drive_text(answers->statusword)) : Json()},
          {"error_register", is_module ? Json(unsigned{answers->error_register}) : Json()},
          {"images", is_module && answers->update_key ? Json(host::image_key_text(*answers->update_key)) : Json()},
          {"current_sensor", is_module ? Json(node.has_current_sensor) : Json()},
          {"core_fingerprint", is_module ? Json(answers->core_fingerprint) : Json()},
          {"produces_sync", node.produces_sync},
          {"emergencies", json_of(node.emergencies)},
          {"past_errors", json_of(node.past_errors)}};
}

std::string_view text_of(CanState state) {
  switch (state) {
    case CanState::error_active:
      return "error active";
    case CanState::error_warning:
      return "error warning";
    case CanState::error_passive:
      return "error passive";
    case CanState::bus_off:
      return "bus-off";
  }
  return "unknown";
}

Json json_of(const BusObservations& seen) {
  Json nodes = Json::empty_array();
  for (const host::ObservedNode& node : seen.nodes) {
    nodes.append(json_of(node));
  }
  Json silent = Json::empty_array();
  for (const host::SilentModule& module : seen.silent_modules) {
    silent.append(Json{{"serial", module.serial}, {"node", module.node_id ? Json(unsigned{*module.node_id}) : Json()}});
  }
  return {{"listened_s", static_cast<double>(seen.listened_us) / 1e6},
          {"frames", seen.frames},
          {"bus_load", seen.load},
          {"syncs", seen.syncs},
          {"sync_jumps", seen.sync_jumps},
          {"host_heartbeats", seen.host_heartbeats},
          {"nodes", nodes},
          {"modules_that_answer_lss_only", silent},
          {"modules_without_node_id", seen.has_fresh_modules},
          {"received", seen.own.statistics.received},
          {"sent", seen.own.statistics.transmitted},
          {"refused", seen.own.statistics.refused},
          {"bus_errors", seen.own.state.bus_errors},
          {"controller", text_of(seen.worst_controller_state)},
          {"transmit_errors", unsigned{seen.own.state.controller.transmit_errors}},
          {"receive_errors", unsigned{seen.own.state.controller.receive_errors}}};
}

/// What was examined, in one line.
std::string summary(const BusObservations& seen) {
  std::vector<std::uint8_t> nodes;
  for (const host::ObservedNode& node : seen.nodes) {
    nodes.push_back(node.node);
  }
  const double seconds = static_cast<double>(seen.listened_us) / 1e6;
  return host::nodes_text(nodes) + "; " +
         (seen.syncs > 0 ? std::to_string(std::lround(seen.syncs / seconds)) + " SYNCs a second"
                         : std::string("no SYNC: the robot is not in operation")) +
         "; bus load " + std::to_string(static_cast<int>(seen.load * 100 + 0.5)) + " %; " +
         (seen.host_heartbeats > 0 ? "driven by a host" : "no host drives it");
}

/// Which images the modules take, in a line for each key.
void print_keys(const BusObservations& seen) {
  std::map<std::uint32_t, std::vector<std::uint8_t>> by_key;
  for (const host::ObservedNode& node : seen.nodes) {
    if (node.answers && node.answers->is_module && node.answers->update_key) {
      by_key[*node.answers->update_key].push_back(node.node);
    }
  }
  for (const auto& [key, nodes] : by_key) {
    std::cout << "Images: " << host::nodes_text(nodes) << ": "
              << (key == 0 ? "any image, because there is no key ('proleg flash --public-key' sets one)"
                           : "only those signed with " + host::image_key_text(key))
              << '\n';
  }
}

/// The modules that cannot detect over-current: their boards have no sensor, which is no fault of theirs.
void print_missing_sensors(const BusObservations& seen) {
  std::vector<std::uint8_t> nodes;
  for (const host::ObservedNode& node : seen.nodes) {
    if (!node.has_current_sensor) {
      nodes.push_back(node.node);
    }
  }
  if (!nodes.empty()) {
    std::cout << "Without a current sensor: " << host::nodes_text(nodes)
              << ". A servo that is blocked there is not switched off.\n";
  }
}

void print(const Report& report) {
  std::cout << report.bus << '\n';
  unsigned number = 0;
  for (const Finding& finding : report.findings) {
    std::cout << '\n' << ++number << ". " << finding.what << "\n   To do: " << finding.to_do << '\n';
  }
  if (report.findings.empty()) {
    std::cout << "no fault found\n";
  }
  if (report.observations && !report.observations->nodes.empty()) {
    std::cout << (report.findings.empty() ? "" : "\n") << "Examined: " << summary(*report.observations) << '\n';
    print_keys(*report.observations);
    print_missing_sensors(*report.observations);
  }
}

void print_json(const Report& report) {
  Json findings = Json::empty_array();
  for (const Finding& finding : report.findings) {
    findings.append(json_of(finding));
  }
  std::cout << Json{{"bus", report.bus},
                    {"findings", findings},
                    {"observations", report.observations ? json_of(*report.observations) : Json()}}
                   .text()
            << '\n';
}

int doctor(const DoctorOptions& options) {
  if (options.address() != "auto") {
    (void)host::parse_bus_address(options.address());  // bad words end the program here
  }
  catch_interrupts();
  const Report report = examine(options.address());
  options.json ? print_json(report) : print(report);
  return report.findings.empty() ? exit_success : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line("proleg doctor",
                           "Says what is wrong with a bus and the robot on it, the most important fault first, and "
                           "what to do. Reads only: it "
                           "disturbs no robot that moves. Takes two seconds or more. Exit status 1: there are faults.");
  DoctorOptions options;
  add_bus_option(command_line, options);
  command_line.add_flag("--json", options.json, "print one JSON object");
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return doctor(options); });
}
