#pragma once

// The parts of messages in a DBC file, inferred from the encoders of the protocol; and the messages that do not depend
// on the robot.

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "shared/can/can_frame.hpp"
#include "shared/canopen/messages.hpp"
#include "shared/gait/declaration.hpp"
#include "tools/proleg/describe/dbc_file.hpp"

namespace proleg::tools {

/// The name of the node of all host programs.
inline constexpr const char* dbc_host = "Host";

/// Factor from raw value to unit. dropped_bits: number of the value's lowest bits that the frame does not have.
[[nodiscard]] double factor_of(UnitScale scale, unsigned dropped_bits = 0);
/// Text of the unit; empty for a ratio.
[[nodiscard]] std::string unit_of(UnitScale scale);

/// A signal that is a whole number.
[[nodiscard]] DbcSignal plain(std::string name, unsigned start, unsigned bits, std::string comment = {});

/// The bits in which frames differ, as a signal: an encoder writes the field whose values differ there. Throws
/// std::logic_error if they are not adjacent.
[[nodiscard]] DbcSignal difference(std::string name, const CanFrame& frame, std::span<const CanFrame> others);

/// The signal of a member of a message of shared/canopen/messages.hpp.
template <typename Message, typename Member>
[[nodiscard]] DbcSignal member(std::string name, Member Message::*pointer, std::string comment = {}) {
  std::array<std::uint8_t, sizeof(Member)> ones{};
  ones.fill(0xFF);
  Message other{};
  other.*pointer = std::bit_cast<Member>(ones);
  const std::array others{encode(other)};
  DbcSignal signal = difference(std::move(name), encode(Message{}), others);
  signal.is_signed = std::is_signed_v<Member>;
  signal.comment = std::move(comment);
  set_full_range(signal);
  return signal;
}

template <typename Message>
[[nodiscard]] unsigned length_of() {
  return encode(Message{}).length;
}

template <typename Code>
[[nodiscard]] DbcChoice choice(Code code, std::string text) {
  return {static_cast<std::int64_t>(code), std::move(text)};
}

/// The signal with names for its values.
[[nodiscard]] DbcSignal chosen(DbcSignal signal, std::vector<DbcChoice> choices);
/// Sets the receiver of all signals of a message.
void set_receiver(DbcMessage& message, const std::string& node);
/// Name of a signal: target_position for "Target position".
[[nodiscard]] std::string signal_name(std::string_view text);

[[nodiscard]] std::vector<DbcChoice> emergency_codes();
/// The controlwords that a host writes (CiA 402, command coding).
[[nodiscard]] std::vector<DbcChoice> controlwords();
/// The statuswords of a walk through the states of the drive.
[[nodiscard]] std::vector<DbcChoice> statuswords();

[[nodiscard]] DbcMessage nmt_message();
/// The message SYNC. producer: name of the node that sends it.
[[nodiscard]] DbcMessage sync_message(const std::string& producer);
[[nodiscard]] DbcMessage tick_message(const std::string& producer);
[[nodiscard]] DbcMessage commit_message();
/// The heartbeat of a node. name: name of the node.
[[nodiscard]] DbcMessage heartbeat_message(std::uint8_t node, const std::string& name);
[[nodiscard]] DbcMessage lss_request_message();
[[nodiscard]] DbcMessage lss_answer_message();
[[nodiscard]] DbcMessage sdo_request_message(std::uint8_t node, const std::string& name);
[[nodiscard]] DbcMessage sdo_answer_message(std::uint8_t node, const std::string& name);

}  // namespace proleg::tools
