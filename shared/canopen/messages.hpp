#pragma once

// All messages of the protocol except SDO: their identifiers, encoders and decoders (docs/protocol.md). A decoder
// returns nothing for a frame of another message, or with a length or content that the protocol does not allow.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "shared/can/can_frame.hpp"
#include "shared/gait/state_frame.hpp"

namespace proleg::canopen {

inline constexpr std::uint8_t min_node_id = 1;
inline constexpr std::uint8_t max_node_id = 126;
inline constexpr std::uint8_t host_node = 127;

/// Identifiers: the predefined connection set (CiA 301, 7.3.5) and those of the manufacturer.
namespace identifier {
inline constexpr std::uint16_t nmt = 0x000;
inline constexpr std::uint16_t sync = 0x080;
inline constexpr std::uint16_t emergency = 0x080;     ///< + node
inline constexpr std::uint16_t state_frame = 0x180;   ///< + node; state frame of the first broadcasting slot
inline constexpr std::uint16_t command = 0x200;       ///< + node
inline constexpr std::uint16_t second_state = 0x280;  ///< + node; state frame of the second broadcasting slot
inline constexpr std::uint16_t monitoring = 0x380;    ///< + node
inline constexpr std::uint16_t sdo_answer = 0x580;    ///< + node
inline constexpr std::uint16_t sdo_request = 0x600;   ///< + node
inline constexpr std::uint16_t commit = 0x680;
inline constexpr std::uint16_t tick = 0x681;
inline constexpr std::uint16_t heartbeat = 0x700;    ///< + node
inline constexpr std::uint16_t lss_answer = 0x7E4;   ///< answers of LSS slaves
inline constexpr std::uint16_t lss_request = 0x7E5;  ///< requests of the LSS master

/// Identifiers of the state frames without the node, by channel.
inline constexpr std::array<std::uint16_t, 2> state_frames{state_frame, second_state};

/// The bits of an identifier that hold the node.
inline constexpr std::uint16_t node_bits = 0x7F;
/// Node of an identifier of the form base + node; 0 for other messages with that base.
[[nodiscard]] constexpr std::uint8_t node_of(std::uint16_t identifier) { return identifier & node_bits; }
[[nodiscard]] constexpr std::uint16_t base_of(std::uint16_t identifier) {
  return static_cast<std::uint16_t>(identifier & ~unsigned{node_bits});
}
/// Whether only one node may send with the identifier: node_of(). Not for identifiers of node 0, such as SYNC.
[[nodiscard]] constexpr bool has_one_sender(std::uint16_t identifier) {
  switch (base_of(identifier)) {
    case emergency:
    case state_frame:
    case second_state:
    case monitoring:
    case sdo_answer:
    case heartbeat:
      return true;
    default:
      return false;
  }
}
}  // namespace identifier

/// Commands of NMT (CiA 301, table 5). node 0: all nodes.
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};
struct NmtRequest {
  NmtCommand command;
  std::uint8_t node;

  friend bool operator==(const NmtRequest&, const NmtRequest&) = default;
};
[[nodiscard]] CanFrame encode(const NmtRequest& request);
[[nodiscard]] std::optional<NmtRequest> decode_nmt(const CanFrame& frame);

/// States of NMT (CiA 301, 7.2.8.3.2.2).
enum class NmtState : std::uint8_t { boot_up = 0x00, stopped = 0x04, operational = 0x05, pre_operational = 0x7F };
struct Heartbeat {
  std::uint8_t node;
  NmtState state;  ///< boot_up in the boot-up message

  friend bool operator==(const Heartbeat&, const Heartbeat&) = default;
};
[[nodiscard]] CanFrame encode(const Heartbeat& heartbeat);
[[nodiscard]] std::optional<Heartbeat> decode_heartbeat(const CanFrame& frame);

/// The counter in SYNC is 1 to 128.
inline constexpr std::uint8_t sync_counters = 128;
/// Counter in the SYNC of a tick.
[[nodiscard]] constexpr std::uint8_t sync_counter(std::uint32_t tick) {
  return static_cast<std::uint8_t>(tick % sync_counters + 1U);
}
/// Number of ticks from a tick to the next one whose SYNC has the counter: 0 to 127.
[[nodiscard]] constexpr std::uint32_t ticks_until_counter(std::uint32_t tick, std::uint8_t counter) {
  return (std::uint32_t{counter} - sync_counter(tick)) % sync_counters;
}
[[nodiscard]] CanFrame encode_sync(std::uint32_t tick);
/// Counter of a SYNC, 1 to 128.
[[nodiscard]] std::optional<std::uint8_t> decode_sync(const CanFrame& frame);

/// The message TICK, which announces the SYNC that follows.
struct TickMessage {
  std::uint32_t tick;
  std::uint32_t configuration_crc;

  friend bool operator==(const TickMessage&, const TickMessage&) = default;
};
[[nodiscard]] CanFrame encode(const TickMessage& message);
[[nodiscard]] std::optional<TickMessage> decode_tick(const CanFrame& frame);

struct CommitMessage {
  std::uint16_t transaction;
  std::uint32_t tick;
  std::uint16_t robot;

  friend bool operator==(const CommitMessage&, const CommitMessage&) = default;
};
[[nodiscard]] CanFrame encode(const CommitMessage& message);
[[nodiscard]] std::optional<CommitMessage> decode_commit(const CanFrame& frame);

/// Emergency error codes (CiA 301, table 26, and CiA 402, error codes); 0xFFxx are the protocol's own.
enum class EmergencyCode : std::uint16_t {
  none = 0x0000,  ///< the error is over
  over_current = 0x2310,
  supply_low = 0x3220,  ///< under-voltage of the chip's supply
  over_temperature = 0x4210,
  sensors_failed = 0x5210,  ///< the measuring circuit (ADC) gives no new readings
  /// The module was reset because a clock of its chip failed; detail: where the program was, 0: not known.
  clock_failure = 0x5220,
  watchdog_reset = 0x6010,  ///< the watchdog has reset the module; detail: where the program was, 0: not known
  /// The module was reset after a fault of its program; detail: where the program was, 0: not known.
  software_fault = 0x6100,
  not_configured = 0x6300,  ///< started before it was configured; detail: the kernel's last refusal (0x2001:8), or 0
  frames_lost = 0x8110,  ///< frames were received, but there was no room for them; detail: their number since the start
  heartbeat_lost = 0x8130,
  bus_off_recovered = 0x8140,     ///< the module was bus-off; detail: the duration in ms
  identifier_collision = 0x8150,  ///< another module sends with this node's id
  wrong_length = 0x8210,          ///< a PDO has a wrong length
  sync_lost = 0x8700,
  commit_too_late = 0xFF01,
  commit_not_staged = 0xFF02,
  foreign_configuration = 0xFF03,  ///< the CRC in TICK is not the module's own
  rejoined = 0xFF04,               ///< not a fault: the module has joined the moving robot again
  unknown_label = 0xFF05,          ///< state frames of a joint carry labels that fit no tick
  /// A SYNC within half a period of the one before is no tick; detail: time by which it was early, in us.
  early_sync = 0xFF06,
  /// The stored settings are those of a later program, of which this one knows only the node id: the drive gets no
  /// power, because the limits of the joint are not known.
  newer_settings = 0xFF07,
};
/// An emergency message. The decoder also accepts codes that are not listed above.
struct Emergency {
  std::uint8_t node;
  EmergencyCode code;
  std::uint8_t error_register;  ///< object 0x1001
  std::uint32_t detail = 0;     ///< bytes 3 to 6: a tick, a transaction, a joint, ... as the code says; byte 7 is 0

  friend bool operator==(const Emergency&, const Emergency&) = default;
};
[[nodiscard]] CanFrame encode(const Emergency& emergency);
[[nodiscard]] std::optional<Emergency> decode_emergency(const CanFrame& frame);
/// A short phrase that describes the code, for people.
[[nodiscard]] std::string_view describe(EmergencyCode code);

/// Encodes a state frame. channel: 0 or 1.
[[nodiscard]] CanFrame encode_state(std::uint8_t node, unsigned channel, const StateFrame& state);
/// The state in the 8 bytes of a frame with any identifier; nothing if the frame is shorter.
[[nodiscard]] std::optional<StateFrame> decode_state(const CanFrame& frame);

/// A command to a module, which a host may send at any time (RPDO1).
struct Command {
  std::uint8_t node;
  std::uint16_t controlword;
  std::int32_t target;  ///< joint angle; 90 degrees = 2^30

  friend bool operator==(const Command&, const Command&) = default;
};
[[nodiscard]] CanFrame encode(const Command& command);
/// Decodes a command. A longer frame is accepted: bytes behind the mapped ones are not used (CiA 301, 7.2.2.5.1).
[[nodiscard]] std::optional<Command> decode_command(const CanFrame& frame);

/// Numbers of SYNCs between two monitoring frames of a module: the usual one, and that of a robot that fills the bus
/// (robot_configuration.hpp).
inline constexpr std::uint32_t monitoring_periods[] = {10, 100};

/// The measurements that a module sends at every 10th or 100th SYNC.
struct Monitoring {
  static constexpr std::int16_t not_measured = -0x8000;

  std::uint8_t node;
  std::int16_t angle;         ///< angle of the joint, 90 degrees = 2^14; or not_measured
  std::uint16_t current_ma;   ///< current of the servo; modules send at most 32,767
  std::int8_t temperature_c;  ///< temperature of the chip, degrees Celsius
  std::uint8_t faults;        ///< object 0x1001

  friend bool operator==(const Monitoring&, const Monitoring&) = default;
};
/// Converts a measured angle for monitoring: 90 degrees = 2^30, rounded half up, to 90 degrees = 2^14. Nothing becomes
/// not_measured.
[[nodiscard]] std::int16_t monitored_angle(std::optional<std::int32_t> angle);
[[nodiscard]] CanFrame encode(const Monitoring& monitoring);
[[nodiscard]] std::optional<Monitoring> decode_monitoring(const CanFrame& frame);

}  // namespace proleg::canopen
