#pragma once

// Packets of Dynamixel Protocol 2.0 (ROBOTIS e-manual, "Protocol 2.0"):
//
//   FF FF FD 00, id, length (u16), instruction, parameters, CRC (u16)
//
// The length counts from the instruction to the CRC. Numbers are little-endian. Byte stuffing: in instruction and
// parameters an FD is inserted after each FF FF FD, so that no header stands inside a packet. Length and CRC count the
// inserted bytes. In a status packet the first parameter is the error byte.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace proleg::host {

enum class Instruction : std::uint8_t {
  ping = 0x01,
  read = 0x02,
  write = 0x03,
  reboot = 0x08,
  status = 0x55,
  sync_read = 0x82,
  sync_write = 0x83,
};

/// The id that addresses all servos.
inline constexpr std::uint8_t broadcast_id = 0xFE;
inline constexpr std::uint8_t max_servo_id = 252;

/// Number of bytes of a packet beside its parameters: header, id, length, instruction, CRC.
inline constexpr std::size_t packet_overhead = 10;
/// Number of bytes of a status packet beside its parameters: it also has an error byte.
inline constexpr std::size_t status_overhead = packet_overhead + 1;

/// CRC-16 with the polynomial 0x8005, from 0, most significant bit first (e-manual, "CRC Calculation").
[[nodiscard]] std::uint16_t packet_crc(std::span<const std::uint8_t> bytes);

/// Makes a whole packet, with byte stuffing and CRC. parameters: at most 1000 bytes.
[[nodiscard]] std::vector<std::uint8_t> instruction_packet(std::uint8_t id, Instruction instruction,
                                                           std::span<const std::uint8_t> parameters);

/// The answer of a servo.
struct StatusPacket {
  static constexpr unsigned alert = 0x80;         ///< bit of `error`: Hardware Error Status(70) is not 0
  static constexpr unsigned crc_error = 3;        ///< error number: the servo received a damaged instruction
  static constexpr unsigned error_number = 0x7F;  ///< bits of `error`: why the instruction failed; 0: it succeeded

  std::uint8_t id = 0;
  std::uint8_t error = 0;
  std::vector<std::uint8_t> parameters;  ///< without the error byte

  friend bool operator==(const StatusPacket&, const StatusPacket&) = default;
};

/// The name of a status packet's error number, such as "Data Range Error".
[[nodiscard]] const char* describe_error_number(std::uint8_t error);

/// Finds status packets in received bytes. Skips everything else: noise, damaged packets, and the echo of instructions,
/// which some half-duplex adapters return.
class StatusParser {
 public:
  /// A packet with a greater length than this is damaged: no answer that a host requests is longer.
  static constexpr std::size_t max_length = 256;

  void add(std::span<const std::uint8_t> bytes);
  /// Takes the next complete packet; nothing if there is none.
  [[nodiscard]] std::optional<StatusPacket> next();
  /// Forgets an incomplete packet.
  void reset() { buffer_.clear(); }
  /// Forgets an incomplete packet that would have more than this number of parameters: its length may be damaged.
  void forget_longer_than(std::size_t parameters);

  /// Number of packets so far with a wrong CRC, an impossible length or wrong byte stuffing.
  [[nodiscard]] std::uint32_t damaged() const { return damaged_; }
  /// Whether a packet has begun and is not complete.
  [[nodiscard]] bool is_incomplete() const { return buffer_.size() >= 4; }

 private:
  bool find_header();
  void skip_damaged();

  std::vector<std::uint8_t> buffer_;
  std::uint32_t damaged_ = 0;
};

}  // namespace proleg::host
