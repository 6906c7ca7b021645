#include "shared/canopen/messages.hpp"

#include <algorithm>

#include "shared/fixed/arithmetic.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::canopen {
namespace {

constexpr CanFrame make(unsigned identifier, std::uint8_t length) {
  return {static_cast<std::uint16_t>(identifier), length, {}};
}

/// The node that sent a frame with the identifier base + node and this length; nothing for any other frame.
std::optional<std::uint8_t> sender(const CanFrame& frame, std::uint16_t base, unsigned length, unsigned max_node) {
  const unsigned node = static_cast<unsigned>(frame.identifier) - base;
  if (frame.identifier < base || node < min_node_id || node > max_node || frame.length != length) {
    return std::nullopt;
  }
  return static_cast<std::uint8_t>(node);
}

bool known(NmtCommand command) {
  switch (command) {
    case NmtCommand::start:
    case NmtCommand::stop:
    case NmtCommand::enter_pre_operational:
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      return true;
  }
  return false;
}

bool known(NmtState state) {
  switch (state) {
    case NmtState::boot_up:
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational:
      return true;
  }
  return false;
}

}  // namespace

CanFrame encode(const NmtRequest& request) {
  return {identifier::nmt, 2, {static_cast<std::uint8_t>(request.command), request.node}};
}

std::optional<NmtRequest> decode_nmt(const CanFrame& frame) {
  const auto command = static_cast<NmtCommand>(frame.data[0]);
  if (frame.identifier != identifier::nmt || frame.length != 2 || !known(command) || frame.data[1] > host_node) {
    return std::nullopt;
  }
  return NmtRequest{command, frame.data[1]};
}

CanFrame encode(const Heartbeat& heartbeat) {
  CanFrame frame = make(unsigned{identifier::heartbeat} + heartbeat.node, 1);
  frame.data[0] = static_cast<std::uint8_t>(heartbeat.state);
  return frame;
}

std::optional<Heartbeat> decode_heartbeat(const CanFrame& frame) {
  const std::optional<std::uint8_t> node = sender(frame, identifier::heartbeat, 1, host_node);
  const auto state = static_cast<NmtState>(frame.data[0]);
  return node && known(state) ? std::optional(Heartbeat{*node, state}) : std::nullopt;
}

CanFrame encode_sync(std::uint32_t tick) { return {identifier::sync, 1, {sync_counter(tick)}}; }

std::optional<std::uint8_t> decode_sync(const CanFrame& frame) {
  const std::uint8_t counter = frame.data[0];
  if (frame.identifier != identifier::sync || frame.length != 1 || counter < 1 || counter > sync_counters) {
    return std::nullopt;
  }
  return counter;
}

CanFrame encode(const TickMessage& message) {
  CanFrame frame = make(identifier::tick, 8);
  write_little_endian(frame.data, 0, 4, message.tick);
  write_little_endian(frame.data, 4, 4, message.configuration_crc);
  return frame;
}

std::optional<TickMessage> decode_tick(const CanFrame& frame) {
  if (frame.identifier != identifier::tick || frame.length != 8) {
    return std::nullopt;
  }
  return TickMessage{read_little_endian(frame.data, 0, 4), read_little_endian(frame.data, 4, 4)};
}

CanFrame encode(const CommitMessage& message) {
  CanFrame frame = make(identifier::commit, 8);
  write_little_endian(frame.data, 0, 2, message.transaction);
  write_little_endian(frame.data, 2, 4, message.tick);
  write_little_endian(frame.data, 6, 2, message.robot);
  return frame;
}

std::optional<CommitMessage> decode_commit(const CanFrame& frame) {
  if (frame.identifier != identifier::commit || frame.length != 8) {
    return std::nullopt;
  }
  return CommitMessage{static_cast<std::uint16_t>(read_little_endian(frame.data, 0, 2)),
                       read_little_endian(frame.data, 2, 4),
                       static_cast<std::uint16_t>(read_little_endian(frame.data, 6, 2))};
}

CanFrame encode(const Emergency& emergency) {
  CanFrame frame = make(unsigned{identifier::emergency} + emergency.node, 8);
  write_little_endian(frame.data, 0, 2, static_cast<std::uint16_t>(emergency.code));
  frame.data[2] = emergency.error_register;
  write_little_endian(frame.data, 3, 4, emergency.detail);
  return frame;
}

std::optional<Emergency> decode_emergency(const CanFrame& frame) {
  const std::optional<std::uint8_t> node = sender(frame, identifier::emergency, 8, host_node);
  if (!node || frame.data[7] != 0) {
    return std::nullopt;
  }
  return Emergency{*node, static_cast<EmergencyCode>(read_little_endian(frame.data, 0, 2)), frame.data[2],
                   read_little_endian(frame.data, 3, 4)};
}

std::string_view describe(EmergencyCode code) {
  switch (code) {
    case EmergencyCode::none:
      return "no error";
    case EmergencyCode::over_current:
      return "over-current";
    case EmergencyCode::supply_low:
      return "supply voltage too low";
    case EmergencyCode::over_temperature:
      return "over-temperature";
    case EmergencyCode::sensors_failed:
      return "the sensors of the servo do not measure";
    case EmergencyCode::clock_failure:
      return "reset after a failure of the crystal or the PLL";
    case EmergencyCode::watchdog_reset:
      return "reset by the watchdog";
    case EmergencyCode::software_fault:
      return "reset after a fault of the program";
    case EmergencyCode::not_configured:
      return "started without a configuration";
    case EmergencyCode::frames_lost:
      return "received frames lost";
    case EmergencyCode::heartbeat_lost:
      return "heartbeat of the host lost";
    case EmergencyCode::bus_off_recovered:
      return "back after bus-off";
    case EmergencyCode::identifier_collision:
      return "another module has the same node id";
    case EmergencyCode::wrong_length:
      return "PDO of wrong length";
    case EmergencyCode::sync_lost:
      return "SYNC lost";
    case EmergencyCode::commit_too_late:
      return "COMMIT came too late";
    case EmergencyCode::commit_not_staged:
      return "COMMIT of what was not staged";
    case EmergencyCode::foreign_configuration:
      return "configuration differs from that of the SYNC producer";
    case EmergencyCode::rejoined:
      return "joined the moving robot again";
    case EmergencyCode::early_sync:
      return "a SYNC came too early";
    case EmergencyCode::unknown_label:
      return "labels of state frames fit no tick";
    case EmergencyCode::newer_settings:
      return "settings of a later program";
  }
  return "unknown emergency code";
}

CanFrame encode_state(std::uint8_t node, unsigned channel, const StateFrame& state) {
  const std::uint16_t base = identifier::state_frames[channel];
  return {static_cast<std::uint16_t>(base + node), 8, state.bytes};
}

std::optional<StateFrame> decode_state(const CanFrame& frame) {
  return frame.length == 8 ? std::optional(StateFrame{frame.data}) : std::nullopt;
}

CanFrame encode(const Command& command) {
  CanFrame frame = make(unsigned{identifier::command} + command.node, 6);
  write_little_endian(frame.data, 0, 2, command.controlword);
  write_little_endian(frame.data, 2, 4, static_cast<std::uint32_t>(command.target));
  return frame;
}

std::optional<Command> decode_command(const CanFrame& frame) {
  constexpr std::uint8_t mapped_bytes = 6;
  const std::optional<std::uint8_t> node = sender(frame, identifier::command, frame.length, max_node_id);
  if (!node || frame.length < mapped_bytes) {
    return std::nullopt;
  }
  return Command{*node, static_cast<std::uint16_t>(read_little_endian(frame.data, 0, 2)),
                 static_cast<std::int32_t>(read_little_endian(frame.data, 2, 4))};
}

std::int16_t monitored_angle(std::optional<std::int32_t> angle) {
  if (!angle) {
    return Monitoring::not_measured;
  }
  return static_cast<std::int16_t>(std::clamp<std::int64_t>(shift_right_rounding(*angle, 16), -0x7FFF, 0x7FFF));
}

CanFrame encode(const Monitoring& monitoring) {
  CanFrame frame = make(unsigned{identifier::monitoring} + monitoring.node, 6);
  write_little_endian(frame.data, 0, 2, static_cast<std::uint16_t>(monitoring.angle));
  write_little_endian(frame.data, 2, 2, monitoring.current_ma);
  frame.data[4] = static_cast<std::uint8_t>(monitoring.temperature_c);
  frame.data[5] = monitoring.faults;
  return frame;
}

std::optional<Monitoring> decode_monitoring(const CanFrame& frame) {
  const std::optional<std::uint8_t> node = sender(frame, identifier::monitoring, 6, max_node_id);
  if (!node) {
    return std::nullopt;
  }
  return Monitoring{*node, static_cast<std::int16_t>(read_little_endian(frame.data, 0, 2)),
                    static_cast<std::uint16_t>(read_little_endian(frame.data, 2, 2)),
                    static_cast<std::int8_t>(frame.data[4]), frame.data[5]};
}

}  // namespace proleg::canopen
