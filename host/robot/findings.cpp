#include "host/robot/findings.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "shared/canopen/declared_objects.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using canopen::EmergencyCode;
using canopen::NmtState;
using Nodes = std::vector<std::uint8_t>;

constexpr double host_heartbeats_per_s = 10;
constexpr double microseconds_per_second = 1e6;

class Diagnosis {
 public:
  Diagnosis(const BusObservations& seen, const BusAddress& address, const ExpectedModules& expected)
      : seen_(seen), address_(address), expected_(expected) {}

  std::vector<Finding> run() {
    if (auto finding = find_dead_bus(seen_, address_)) {
      return {std::move(*finding)};
    }
    findings_ = find_wire_faults(seen_, address_);
    find_duplicates();
    find_second_host();
    find_second_sync();
    find_restarts();
    if (!has("bus_overload")) {
      find_drives();
    }
    find_foreign_modules();
    find_modules_without_node_id();
    find_newer_settings();
    find_stopped_modules();
    find_mute_nodes();
    if (auto finding = find_damaged_lines(seen_, address_)) {
      findings_.push_back(std::move(*finding));
    }
    find_reports();
    find_absence();
    find_unprotected_modules();
    for (Finding& finding : findings_) {
      capitalise(finding.what);
    }
    return std::move(findings_);
  }

 private:
  /// Sentences begin with "node 3" or "nodes 1, 2".
  static void capitalise(std::string& sentence) {
    if (sentence.starts_with("node")) {
      sentence.front() = 'N';
    }
  }

  void add(std::string_view code, std::string what, std::string to_do, Nodes nodes = {}) {
    findings_.push_back({code, std::move(what), std::move(to_do), std::move(nodes)});
  }
  [[nodiscard]] bool has(std::string_view code) const {
    return std::ranges::any_of(findings_, [code](const Finding& finding) { return finding.code == code; });
  }
  /// Whether a finding with this code is about the node.
  [[nodiscard]] bool has(std::string_view code, std::uint8_t node) const {
    return std::ranges::any_of(findings_, [&](const Finding& finding) {
      return finding.code == code && std::ranges::find(finding.nodes, node) != finding.nodes.end();
    });
  }
  template <typename Condition>
  [[nodiscard]] Nodes nodes_with(Condition&& condition) const {
    Nodes nodes;
    for (const ObservedNode& node : seen_.nodes) {
      if (condition(node)) {
        nodes.push_back(node.node);
      }
    }
    return nodes;
  }
  static bool has_sent(const ObservedNode& node, EmergencyCode code) {
    return std::ranges::find(node.emergencies, code) != node.emergencies.end();
  }

  void find_duplicates() {
    Nodes nodes =
        nodes_with([](const ObservedNode& node) { return has_sent(node, EmergencyCode::identifier_collision); });
    std::map<std::uint8_t, unsigned> holders;
    for (const ObservedNode& node : seen_.nodes) {
      // A module whose serial number was not read may be the silent module.
      holders[node.node] += node.answers && node.answers->is_module && node.answers->serial != 0 ? 1U : 0U;
    }
    for (const SilentModule& module : seen_.silent_modules) {
      const std::uint8_t node = module.node_id.value_or(0);
      if (node != 0 && ++holders[node] == 2 && std::ranges::find(nodes, node) == nodes.end()) {
        nodes.push_back(node);
      }
    }
    std::ranges::sort(nodes);
    if (nodes.empty()) {
      return;
    }
    std::string serials;
    for (const SilentModule& module : seen_.silent_modules) {
      if (module.node_id && std::ranges::find(nodes, *module.node_id) != nodes.end()) {
        serials += (serials.empty() ? "" : ", ") + hexadecimal(module.serial, 8);
      }
    }
    add("duplicate_node_id",
        "Several modules have the same node id: " + nodes_text(nodes) + ". They have stopped" +
            (serials.empty() ? std::string(".") : " (serial numbers " + serials + ")."),
        "Run 'proleg recover': one keeps the node id, the others get free ones. Then 'proleg assign' gives each its "
        "place.",
        nodes);
  }

  void find_second_host() {
    const double seconds = static_cast<double>(seen_.listened_us) / microseconds_per_second;
    if (seen_.host_heartbeats < 3 || seen_.host_heartbeats < 1.5 * host_heartbeats_per_s * seconds) {
      return;
    }
    add("two_hosts",
        std::to_string(seen_.host_heartbeats) + " heartbeats of hosts came in " + number_text(seconds) +
            " s, twice as many as one host sends: two programs or computers drive the robot.",
        "End all but one of them. While there are two, the robot does not stop when one of them fails.");
  }

  void find_second_sync() {
    const Nodes early = nodes_with([](const ObservedNode& node) { return has_sent(node, EmergencyCode::early_sync); });
    const Nodes producers = nodes_with([](const ObservedNode& node) { return node.produces_sync; });
    const bool has_jumps = seen_.sync_jumps >= 3 && 3 * seen_.sync_jumps > seen_.syncs;
    if (has("bus_overload") || (early.empty() && producers.size() < 2 && !has_jumps && seen_.foreign_syncs == 0)) {
      return;
    }
    const std::string what = producers.size() >= 2 ? nodes_text(producers) + " are set to produce it."
                             : seen_.foreign_syncs > 0
                                 ? "some SYNCs have no counter, so no module of Proleg has sent them."
                                 : std::to_string(seen_.sync_jumps) + " of " + std::to_string(seen_.syncs) +
                                       " SYNCs do not follow the one before" +
                                       (producers.empty() ? std::string(".")
                                                          : ", and only node " + std::to_string(producers.front()) +
                                                                " is set to produce it.");
    add("two_sync_producers", "More than one node produces SYNC, the clock of the robot: " + what,
        producers.size() >= 2 ? "Reset the modules (proleg nmt reset-node all), and start the robot again: the start "
                                "chooses one producer."
                              : "Unplug the node that is no module of this robot, or end the program that sends SYNC. "
                                "Then start the robot "
                                "again.",
        producers);
  }

  void find_restarts() {
    const Nodes nodes = nodes_with(
        [this](const ObservedNode& node) { return node.boot_ups >= 2 && !has("duplicate_node_id", node.node); });
    if (!nodes.empty()) {
      const bool is_one = nodes.size() == 1;
      add("restarting_module",
          nodes_text(nodes) + (is_one ? " restarts" : " restart") + " again and again" + reset_causes(nodes) + ".",
          "Check the supply: a plug that is loose, a battery that is empty, or a servo that blocks and pulls the "
          "voltage "
          "down. If the supply is good, flash the module again.",
          nodes);
    }
    const Nodes others =
        nodes_with([&](const ObservedNode& node) { return node.boot_ups < 2 && !reset_causes({node.node}).empty(); });
    if (!others.empty()) {
      add("module_was_reset", nodes_text(others) + " had to restart" + reset_causes(others) + ".",
          "Switch the robot off and on. If it happens again: check the supply, then flash the module again, or replace "
          "it.",
          others);
    }
  }
  [[nodiscard]] std::string reset_causes(const Nodes& nodes) const {
    for (const ObservedNode& node : seen_.nodes) {
      if (std::ranges::find(nodes, node.node) == nodes.end()) {
        continue;
      }
      for (const EmergencyCode code :
           {EmergencyCode::watchdog_reset, EmergencyCode::software_fault, EmergencyCode::clock_failure}) {
        if (has_sent(node, code) || std::ranges::find(node.past_errors, code) != node.past_errors.end()) {
          return " (" + std::string(canopen::describe(code)) + ")";
        }
      }
    }
    return {};
  }

  /// Finds drives that do not work. A robot with a drive in Fault does not start, so that SYNC is missing, too. A
  /// drive that holds its safe pose waits for SYNC, for its host, or for a stable bus.
  void find_drives() {
    std::vector<Finding> faults = find_drive_faults(seen_);
    findings_.insert(findings_.end(), faults.begin(), faults.end());
    if (faults.empty()) {
      find_missing_sync();
    }
    if (auto quick_stop = find_quick_stop(seen_); quick_stop && findings_.empty()) {
      findings_.push_back(std::move(*quick_stop));
    }
  }

  void find_missing_sync() {
    const Nodes running = nodes_with([](const ObservedNode& node) { return node.state == NmtState::operational; });
    // A host that sets a robot up starts SYNC last.
    if (running.empty() || seen_.syncs > 0 || seen_.foreign_syncs > 0 || seen_.host_heartbeats > 0 ||
        has("duplicate_node_id") || has("restarting_module")) {
      return;
    }
    const Nodes producers = nodes_with([](const ObservedNode& node) { return node.produces_sync; });
    add("sync_missing",
        "The modules are in operation, but no module sends SYNC, the clock of the robot: they stand still (quick "
        "stop).",
        producers.empty()
            ? "The module that produced SYNC, mostly the gateway or the head, is off or unplugged: connect it. Then "
              "start "
              "the robot again (proleg drive)."
            : "Node " + std::to_string(producers.front()) +
                  " is set to produce SYNC and does not: reset the modules (proleg nmt reset-node all), and start the "
                  "robot again (proleg drive).",
        running);
  }

  void find_foreign_modules() {
    std::map<std::uint16_t, Nodes> versions;
    std::map<std::uint32_t, Nodes> cores;
    for (const ObservedNode& node : seen_.nodes) {
      if (!node.answers || !node.answers->is_module || node.answers->core_fingerprint == 0) {
        continue;  // 0: the value was not read
      }
      if (node.answers->protocol >> 8U != canopen::protocol_version >> 8U) {
        versions[node.answers->protocol].push_back(node.node);
      } else if (node.answers->core_fingerprint != expected_.core_fingerprint) {
        cores[node.answers->core_fingerprint].push_back(node.node);
      }
    }
    for (const auto& [version, nodes] : versions) {
      add("other_protocol",
          "The program of " + nodes_text(nodes) + " speaks version " + std::to_string(version >> 8U) + "." +
              std::to_string(version & 0xFFU) + " of the protocol, this computer version " +
              std::to_string(canopen::protocol_version >> 8U) + ".",
          "Flash the image that belongs to this version of Proleg.", nodes);
    }
    for (const auto& [core, nodes] : cores) {
      add("other_core",
          "The program of " + nodes_text(nodes) + " computes with another core (" + hexadecimal(core, 8) +
              ") than this computer (" + hexadecimal(expected_.core_fingerprint, 8) +
              "): the joints would move differently, so the robot does not start.",
          "Flash the image that belongs to this version of Proleg.", nodes);
    }
  }

  void find_modules_without_node_id() {
    std::string serials;
    for (const SilentModule& module : seen_.silent_modules) {
      if (!module.node_id) {
        serials += (serials.empty() ? "" : ", ") + hexadecimal(module.serial, 8);
      }
    }
    if (!serials.empty() || seen_.has_fresh_modules) {
      add("module_without_node_id",
          "There are modules without a node id" +
              (serials.empty() ? std::string(".") : " (serial numbers " + serials + ")."),
          "A module from the factory has none. 'proleg assign FILE' gives each its place in a robot.");
    }
  }

  void find_newer_settings() {
    const Nodes nodes = nodes_with([](const ObservedNode& node) {
      constexpr unsigned of_the_project = 1U << 7U;  // in the error register (0x1001)
      const bool lasts = node.answers && (node.answers->error_register & of_the_project) != 0;
      return lasts && (has_sent(node, EmergencyCode::newer_settings) ||
                       std::ranges::find(node.past_errors, EmergencyCode::newer_settings) != node.past_errors.end());
    });
    if (!nodes.empty()) {
      add("newer_settings",
          nodes_text(nodes) +
              ": the stored settings are those of a later program. This one does not know the limits of the joint, and "
              "gives the servo no power.",
          "Flash the later program again. Or store default settings with 'proleg recover --reset-settings', and set "
          "the limits of the joint again (0x2005:4, 0x2005:5).",
          nodes);
    }
  }

  void find_stopped_modules() {
    Nodes nodes = nodes_with([&](const ObservedNode& node) { return node.state == NmtState::stopped; });
    for (const SilentModule& module : seen_.silent_modules) {
      const std::uint8_t node = module.node_id.value_or(0);
      const auto known = std::ranges::find(seen_.nodes, node, &ObservedNode::node);
      const bool answers = known != seen_.nodes.end() && known->answers;
      if (node != 0 && !answers && std::ranges::find(nodes, node) == nodes.end()) {
        nodes.push_back(node);
      }
    }
    std::erase_if(nodes, [this](std::uint8_t node) { return has("duplicate_node_id", node); });
    std::ranges::sort(nodes);
    if (!nodes.empty()) {
      add("stopped_module",
          nodes_text(nodes) + (nodes.size() == 1 ? " is" : " are") +
              " Stopped: by a command, or because another module had the same node id.",
          "Start again with proleg nmt reset-node, and examine the bus once more.", nodes);
    }
  }

  void find_mute_nodes() {
    const Nodes nodes = nodes_with([&](const ObservedNode& node) {
      return !node.answers && seen_.is_complete && seen_.was_asked && node.state != NmtState::stopped &&
             !has("duplicate_node_id", node.node) && !has("stopped_module", node.node) &&
             !has("restarting_module", node.node);
    });
    // Modules do not answer requests that do not reach them.
    const bool is_explained = has("bus_overload") || has("damaged_frames") || has("bus_off") || has("error_passive");
    if (!nodes.empty() && !is_explained) {
      add("no_answer", nodes_text(nodes) + " can be received but answers no request.",
          "Switch the module off and on. If that does not help, flash it again.", nodes);
    }
  }

  /// Finds errors that modules have reported during the observation, if no other finding explains them.
  void find_reports() {
    std::map<EmergencyCode, Nodes> reports;
    for (const ObservedNode& node : seen_.nodes) {
      for (const EmergencyCode code : node.emergencies) {
        if (code != EmergencyCode::rejoined) {
          reports[code].push_back(node.node);
        }
      }
    }
    if (!findings_.empty()) {
      return;
    }
    for (const auto& [code, nodes] : reports) {
      add("module_report",
          nodes_text(nodes) + " reported: " + std::string(canopen::describe(code)) + " (EMCY " +
              hexadecimal(static_cast<unsigned>(code), 4) + ").",
          "docs/protocol.md explains the code. Start the robot again; if the report comes back, look at its cause.",
          nodes);
    }
  }

  void find_unprotected_modules() {
    const Nodes nodes = nodes_with([](const ObservedNode& node) { return !node.has_brown_out_reset; });
    if (!nodes.empty()) {
      add("no_brown_out_reset",
          nodes_text(nodes) +
              ": the brown-out reset of the chip is not set to its highest level. If the supply fails, only the "
              "program "
              "itself stops the servo.",
          "Set it with a probe: proleg flash --bare --probe stlink (docs/board.md).", nodes);
    }
  }

  void find_absence() {
    const bool has_module = std::ranges::any_of(
        seen_.nodes, [](const ObservedNode& node) { return node.answers && node.answers->is_module; });
    if (findings_.empty() && seen_.is_complete && !has_module) {
      add("no_module", "There are frames on the bus, but no module of Proleg answers.",
          "Check that this is the right bus and that the robot has power.");
    }
  }

  const BusObservations& seen_;
  const BusAddress& address_;
  const ExpectedModules& expected_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> find_bus_faults(const BusObservations& observations, const BusAddress& address,
                                     const ExpectedModules& expected) {
  return Diagnosis(observations, address, expected).run();
}

}  // namespace proleg::host
