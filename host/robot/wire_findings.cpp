#include "host/robot/wire_findings.hpp"

#include <string>
#include <utility>

#include "shared/canopen/bus_load.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

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

}  // namespace

std::optional<Finding> find_dead_bus(const BusObservations& seen, const BusAddress& address) {
  if (!seen.own.state.is_connected) {
    return lost_connection(seen.own.state.reason);
  }
  if (seen.own.statistics.received > 0) {
    return std::nullopt;
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

}  // namespace proleg::host
