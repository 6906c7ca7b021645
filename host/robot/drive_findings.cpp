#include "host/robot/drive_findings.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>

#include "shared/canopen/power_state.hpp"

namespace proleg::host {
namespace {

using canopen::EmergencyCode;

// Statusword: the bits of the state, and the states that matter here (CiA 402, table 30).
constexpr unsigned fault_bits = 0x4F;
constexpr unsigned fault = 0x08;
constexpr unsigned fault_reaction = 0x0F;

/// A cause of Fault: its bit in the error register (0x1001, CiA 301), and its remedy.
struct Cause {
  EmergencyCode code;
  unsigned register_bit;
  std::string_view finding;
  std::string_view what;
  std::string_view to_do;
};
constexpr std::array causes{
    Cause{EmergencyCode::over_current, 1U << 1U, "over_current",
          "has switched its servo off because the servo took too much current",
          "Switch off, and look for what blocks the joint: a stone, a cable, a limit of the mechanics, a broken gear. "
          "Turn "
          "the joint by hand. Then"},
    Cause{EmergencyCode::supply_low, 1U << 2U, "supply_low",
          "has switched its servo off because the supply voltage is too low",
          "Charge or replace the battery, and check the plugs of the supply. Then"},
    Cause{EmergencyCode::over_temperature, 1U << 3U, "over_temperature",
          "has switched its servo off because it is too hot (95 degrees Celsius)",
          "Let it cool below 85 degrees, and look for what blocks the joint or keeps the air away. Then"},
    Cause{EmergencyCode::sensors_failed, 1U << 5U, "sensors_failed",
          "has switched its servo off because current and temperature are not measured any more",
          "Switch the module off and on. If it happens again, replace it. If not,"},
};
constexpr std::string_view clear_fault =
    " start the robot again (proleg drive resets the modules), or reset the module "
    "(proleg nmt reset-node).";

bool contains(const std::vector<EmergencyCode>& codes, EmergencyCode code) {
  return std::ranges::find(codes, code) != codes.end();
}

/// The cause of the Fault of a node: the present cause, or the one that the node reported last.
const Cause* cause_of(const ObservedNode& node) {
  for (const Cause& cause : causes) {
    if ((node.answers->error_register & cause.register_bit) != 0) {
      return &cause;
    }
  }
  for (const EmergencyCode code : node.past_errors) {
    for (const Cause& cause : causes) {
      if (cause.code == code) {
        return &cause;
      }
    }
  }
  for (const Cause& cause : causes) {
    if (contains(node.emergencies, cause.code)) {
      return &cause;
    }
  }
  return nullptr;
}

bool is_module(const ObservedNode& node) { return node.answers && node.answers->is_module; }

bool is_in_fault(const ObservedNode& node) {
  const unsigned state = node.answers->statusword & fault_bits;
  return state == fault || state == fault_reaction;
}

Finding finding_of(const Cause* cause, const std::vector<std::uint8_t>& nodes) {
  if (cause == nullptr) {
    return {"drive_fault", nodes_text(nodes) + ": the servo is switched off after a fault (CiA 402: Fault).",
            "Look at the module with proleg info and proleg monitor. Then" + std::string(clear_fault), nodes};
  }
  return {cause->finding, nodes_text(nodes) + ": the module " + std::string(cause->what) + ".",
          std::string(cause->to_do) + std::string(clear_fault), nodes};
}

std::string quick_stop_cause(const std::vector<const ObservedNode*>& nodes) {
  for (const EmergencyCode code :
       {EmergencyCode::heartbeat_lost, EmergencyCode::sync_lost, EmergencyCode::bus_off_recovered}) {
    if (std::ranges::any_of(nodes, [code](const ObservedNode* node) {
          return contains(node->past_errors, code) || contains(node->emergencies, code);
        })) {
      return ", because of this: " + std::string(canopen::describe(code));
    }
  }
  return {};
}

}  // namespace

std::vector<Finding> find_drive_faults(const BusObservations& observations) {
  std::map<const Cause*, std::vector<std::uint8_t>> faults;
  for (const ObservedNode& node : observations.nodes) {
    if (is_module(node) && is_in_fault(node)) {
      faults[cause_of(node)].push_back(node.node);
    }
  }
  std::vector<Finding> findings;
  for (const Cause& cause : causes) {
    if (const auto found = faults.find(&cause); found != faults.end()) {
      findings.push_back(finding_of(&cause, found->second));
    }
  }
  if (const auto found = faults.find(nullptr); found != faults.end()) {
    findings.push_back(finding_of(nullptr, found->second));
  }
  return findings;
}

std::optional<Finding> find_quick_stop(const BusObservations& observations) {
  std::vector<const ObservedNode*> stopped;
  std::vector<std::uint8_t> nodes;
  for (const ObservedNode& node : observations.nodes) {
    if (is_module(node) && (node.answers->statusword & canopen::drive_state_bits) == canopen::drive_quick_stop_active) {
      stopped.push_back(&node);
      nodes.push_back(node.node);
    }
  }
  if (nodes.empty()) {
    return std::nullopt;
  }
  return Finding{"quick_stop",
                 nodes_text(nodes) + ": the joints hold their safe pose (quick stop)" + quick_stop_cause(stopped) +
                     ". The servos have power.",
                 "Start the robot again (proleg drive), or take the power from the servos: proleg nmt reset-node all.",
                 nodes};
}

}  // namespace proleg::host
