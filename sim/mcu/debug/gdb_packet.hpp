#pragma once

// Packets of the GDB remote serial protocol: "Debugging with GDB", appendix E.1, Overview.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::sim {

/// `$`, the payload with `# $ } *` escaped, `#`, and the sum of the bytes between modulo 256, in hexadecimal.
[[nodiscard]] std::string gdb_packet(std::string_view payload);

/// Convert bytes to hexadecimal digits, and back; nothing for an odd number of digits or another character.
[[nodiscard]] std::string to_hex(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<std::vector<std::uint8_t>> from_hex(std::string_view digits);

/// Parses a number of only hexadecimal digits, at most 0xFFFFFFFF.
[[nodiscard]] std::optional<std::uint32_t> hex_number(std::string_view digits);

/// One input that a client sends.
struct GdbInput {
  enum class Kind : std::uint8_t {
    packet,
    damaged,    ///< a packet whose checksum is wrong
    too_long,   ///< a packet of more than GdbDecoder::max_packet bytes
    interrupt,  ///< the byte 0x03 between packets
    accepted,   ///< `+`
    refused,    ///< `-`: the client requests the last packet again
  };
  Kind kind = Kind::packet;
  std::string payload;  ///< payload of a packet, without escapes
};

/// Splits a stream of bytes into packets and signs. It ignores other bytes between packets; a `$` within a packet
/// starts a new one.
class GdbDecoder {
 public:
  /// Largest number of bytes between `$` and `#`, with escapes.
  static constexpr std::size_t max_packet = 0x4000;

  /// Appends received bytes. Memory is bounded if the caller takes all inputs before it feeds more.
  void feed(std::string_view bytes);
  [[nodiscard]] std::optional<GdbInput> next();

 private:
  enum class State : std::uint8_t { between, payload, first_digit, second_digit };

  [[nodiscard]] std::optional<GdbInput> take(char byte);
  [[nodiscard]] std::optional<GdbInput> take_between(char byte);
  void take_payload(char byte);
  [[nodiscard]] GdbInput finish(char second_digit);

  std::string received_;
  std::size_t taken_ = 0;
  State state_ = State::between;
  std::string payload_;
  bool escaped_ = false;
  std::size_t length_ = 0;
  std::uint8_t sum_ = 0;
  char first_digit_ = '0';
};

}  // namespace proleg::sim
