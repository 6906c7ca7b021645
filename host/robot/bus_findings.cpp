#include "host/robot/findings.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "shared/canopen/power_state.hpp"
#include "shared/canopen/robot_configuration.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

using canopen::EmergencyCode;

constexpr double full_load = canopen::max_bus_load_permille / 1000.0;
/// Load of one message above which its node is faulty. No message of a robot reaches it: a state frame in the shortest
/// tick, 1 ms, takes 0.135.
constexpr double babbling_load = 0.25;
/// Smallest number of errors that counts: a plug that was just put in can cause fewer.
constexpr std::uint64_t few_errors = 3;

constexpr std::string_view wires =
    "check the plugs and the cable (CAN-H and CAN-L not exchanged, no short circuit, ground connected), and that there "
    "are exactly two terminators of 120 ohms, one at each end: without power there are 60 ohms between CAN-H and CAN-L";

std::string percent(double share) { return std::to_string(static_cast<int>(share * 100 + 0.5)) + " %"; }

bool has_error(const BusObservations& seen, CanErrorKind kind) { return seen.own.state.errors.contains(kind); }

/// Whether there were errors in the bits themselves.
bool has_bit_errors(const BusObservations& seen) {
  return has_error(seen, CanErrorKind::crc) || has_error(seen, CanErrorKind::form) ||
         has_error(seen, CanErrorKind::stuff) || has_error(seen, CanErrorKind::bit_dominant) ||
         has_error(seen, CanErrorKind::bit_recessive);
}

/// Whether other nodes send, or the wires are damaged. A node that is only not acknowledged never becomes bus-off, and
/// its receive error counter stays 0 (ISO 11898-1). Drivers of Linux report kinds of errors only on request.
bool has_signals(const BusObservations& seen) {
  return has_bit_errors(seen) || seen.own.state.controller.receive_errors > 0 ||
         seen.worst_controller_state == CanState::bus_off;
}

std::string restart_hint(const BusAddress& address) {
  return address.kind == BusAddress::Kind::can ? " Then sudo ip link set " + address.name + " down; sudo ip link set " +
                                                     address.name + " up type can bitrate 1000000 restart-ms 100"
                                               : std::string();
}

Finding lost_connection(const std::string& reason) {
  return {"connection_lost",
          "The connection to the bus was lost" + (reason.empty() ? std::string(".") : ": " + one_line(reason) + "."),
          "Check the cable of the adapter and its power, then try again.",
          {}};
}

/// The node that sends frames with an identifier; nothing if the identifier does not say it.
std::optional<std::uint8_t> sender_of(std::uint16_t identifier) {
  const std::uint16_t base = canopen::identifier::base_of(identifier);
  const std::uint8_t node = canopen::identifier::node_of(identifier);
  for (const std::uint16_t known :
       {canopen::identifier::emergency, canopen::identifier::state_frame, canopen::identifier::second_state,
        canopen::identifier::monitoring, canopen::identifier::sdo_answer, canopen::identifier::heartbeat}) {
    if (base == known && node != 0) {
      return node;
    }
  }
  return std::nullopt;
}

std::optional<Finding> find_overload(const BusObservations& seen) {
  const bool babbles = seen.busiest_load > babbling_load;
  if (!babbles && seen.load <= full_load) {
    return std::nullopt;
  }
  const auto sender = sender_of(seen.busiest_identifier);
  const std::string identifier = hexadecimal(seen.busiest_identifier, 3);
  return Finding{"bus_overload",
                 "The bus is full: frames take " + percent(seen.load) + " of its time, those with the identifier " +
                     identifier + " alone " + percent(seen.busiest_load) + ". Other frames wait, or come too late.",
                 babbles
                     ? (sender ? "Unplug node " + std::to_string(*sender) + ", which sends them"
                               : std::string("Find the node that sends them: unplug one after the other")) +
                           ". If it was the program of a module, reset it (proleg nmt reset-node) or flash it again."
                     : "Use a longer tick or fewer modules on one bus, and unplug what does not belong to the robot.",
                 sender ? std::vector<std::uint8_t>{*sender} : std::vector<std::uint8_t>{}};
}

std::optional<Finding> find_errors(const BusObservations& seen, const BusAddress& address) {
  const CanState state = seen.worst_controller_state;
  const CanStatus& now = seen.own.state.controller;
  const std::string counters = " (error counters: " + std::to_string(now.transmit_errors) + " sending, " +
                               std::to_string(now.receive_errors) + " receiving)";
  if (seen.errors >= few_errors && seen.frames > 0) {
    return Finding{"damaged_frames",
                   std::to_string(seen.errors) + " errors among " + std::to_string(seen.frames) +
                       " frames while only listening: frames are damaged on the wires" + counters + ".",
                   "A terminator is missing or there is one too many, a plug is loose, or a branch is long: " +
                       std::string(wires) + ". Keep the cable away from motor wires.",
                   {}};
  }
  if (state == CanState::bus_off) {
    return Finding{
        "bus_off",
        "The adapter of this computer could not send, and has switched itself off (bus-off). It does receive frames.",
        "Its own wires or its transceiver are the first suspects: try another plug or adapter. If that does not "
        "help, " +
            std::string(wires) + "." + restart_hint(address),
        {}};
  }
  if (state == CanState::error_passive) {
    return Finding{"error_passive",
                   "The adapter of this computer meets so many errors that it is error passive" + counters + ".",
                   "Plugs, cable and terminators: " + std::string(wires) + ".",
                   {}};
  }
  if (seen.own.state.bus_errors >= few_errors && has_bit_errors(seen)) {
    return Finding{"damaged_frames",
                   std::to_string(seen.own.state.bus_errors) +
                       " errors while requests were sent: frames are damaged on the wires" + counters + ".",
                   "A terminator is missing or there is one too many, a plug is loose, or a branch is long: " +
                       std::string(wires) + ".",
                   {}};
  }
  return std::nullopt;
}

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

std::string nodes_text(const std::vector<std::uint8_t>& nodes) {
  std::string text = nodes.size() == 1 ? "node " : "nodes ";
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(nodes[i]);
  }
  return text;
}

std::optional<Finding> find_dead_bus(const BusObservations& seen, const BusAddress& address) {
  if (!seen.own.state.is_connected) {
    return lost_connection(seen.own.state.reason);
  }
  if (seen.own.statistics.received > 0) {
    return std::nullopt;
  }
  if (auto finding = find_damaged_lines(seen, address)) {
    return finding;
  }
  const bool is_off = seen.worst_controller_state == CanState::bus_off;
  if (has_signals(seen)) {
    return Finding{"wrong_bit_rate",
                   "There are signals on the bus, but not one frame can be read" +
                       std::string(is_off ? ", and the adapter has switched itself off (bus-off)." : ".") +
                       " Somebody sends with another bit rate than 1 Mbit/s, or the signals are damaged.",
                   "Set every adapter and node on the bus to 1 Mbit/s. If that is so, " + std::string(wires) + "." +
                       restart_hint(address),
                   {}};
  }
  if (seen.was_asked && (seen.own.statistics.transmitted == 0 || has_error(seen, CanErrorKind::acknowledgement))) {
    return Finding{"no_acknowledgement",
                   "No node acknowledges a frame: this computer is alone on the bus.",
                   "Check that the robot has power and that its cable is plugged in at both ends. If that is so, " +
                       std::string(wires) + ".",
                   {}};
  }
  return Finding{
      "nobody_answers",
      "No node sends a frame or answers.",
      "Check that this is the right bus, that the robot has power, and that its cable is plugged in. If that is "
      "so, " +
          std::string(wires) + ".",
      {}};
}

std::optional<Finding> find_damaged_lines(const BusObservations& seen, const BusAddress& address) {
  constexpr std::uint64_t most_at_opening = 2;  // lines that can be the rest of another program's output
  const Statistics& numbers = seen.own.statistics;
  if (numbers.malformed == 0 || (numbers.received > 0 && numbers.malformed <= most_at_opening)) {
    return std::nullopt;
  }
  return Finding{
      "damaged_lines",
      std::to_string(numbers.malformed) + " lines from the adapter were not understood. The last one was " +
          numbers.malformed_line + ", expected slcan: a line such as t1230.",
      "If lines are cut or have strange characters, they were damaged on their way to this computer: check the cable "
      "between adapter and computer, its length and its ground" +
          std::string(address.kind == BusAddress::Kind::serial ? ", and the baud rate" : "") +
          ". If not, the adapter speaks another dialect: docs/adapters.md lists what works.",
      {}};
}

std::vector<Finding> find_wire_faults(const BusObservations& observations, const BusAddress& address) {
  std::vector<Finding> findings;
  if (auto errors = find_errors(observations, address)) {
    findings.push_back(std::move(*errors));
  }
  if (auto overload = find_overload(observations)) {
    findings.push_back(std::move(*overload));
  }
  return findings;
}

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
