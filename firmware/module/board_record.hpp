#pragma once

// What a board is, kept in its flash: written when the board is made, read at every start. Records have 32 bytes and
// are appended to a log in two sectors of flash; the newest one counts. Flash can only be programmed once after it was
// erased, and only whole sectors can be erased: so the log fills one sector, then the other.
//
// A record (little-endian):
//   0  u32  sequence number, 1 for the first; the newest record has the highest
//   4  u8   schema version, 1
//   5  u8   node id
//   6  u8   flags; bit 0: a feedback potentiometer is fitted
//   7  u8   0
//   8  u16  feedback at -90 degrees, as the ADC reads it (12 bits)
//  10  u16  feedback at +90 degrees
//  12  16 bytes of 0
//  28  u32  CRC-32 (shared/fixed/crc32.hpp) of the 28 bytes before

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/canopen/messages.hpp"

namespace proleg::firmware {

/// Flash that can be erased sector by sector. Both operations take long (RM0090: up to half a second to erase), and
/// nothing else runs meanwhile.
class FlashPort {
 public:
  /// All bytes of a sector become 0xFF. Whether it succeeded.
  [[nodiscard]] virtual bool erase(unsigned sector) = 0;
  /// Programs bytes of a sector that are 0xFF. offset and size: multiples of 4. Whether it succeeded.
  [[nodiscard]] virtual bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) = 0;
  /// The bytes of a sector.
  [[nodiscard]] virtual std::span<const std::uint8_t> contents(unsigned sector) const = 0;

 protected:
  ~FlashPort() = default;
};

struct BoardRecord {
  static constexpr std::size_t size = 32;  ///< bytes in flash
  static constexpr std::uint8_t max_node = canopen::max_node_id;
  static constexpr std::uint16_t max_reading = 4095;  ///< of the 12-bit ADC

  std::uint8_t node = 0;  ///< 1 to 126
  bool has_feedback = false;
  /// Of the feedback potentiometer, as the ADC reads it, at most max_reading; different, if it is fitted.
  std::uint16_t feedback_at_minus_90 = 0;
  std::uint16_t feedback_at_plus_90 = 0;

  /// Whether everything is in its range.
  [[nodiscard]] bool valid() const;

  friend bool operator==(const BoardRecord&, const BoardRecord&) = default;
};

/// The bytes of a record.
[[nodiscard]] std::array<std::uint8_t, BoardRecord::size> encode(const BoardRecord& record, std::uint32_t sequence);

/// The record with the highest sequence number among those that are right: a known schema version, everything in its
/// range, the right checksum. Other records are skipped: those that were cut off or damaged, or have an unknown
/// schema. Sectors of any size.
[[nodiscard]] std::optional<BoardRecord> newest(std::span<const std::uint8_t> sector_1,
                                                std::span<const std::uint8_t> sector_2);

enum class AppendResult : std::uint8_t {
  ok,
  invalid_record,  ///< not BoardRecord::valid(); nothing was written
  erase_failed,    ///< the record before is still the newest
  program_failed,  ///< the record before is still the newest, or the flash does not hold what was written
};

/// Appends a record to the log in sectors 0 and 1 of the port. If the power fails meanwhile, at any instant, the newest
/// record is the one before or this one.
[[nodiscard]] AppendResult append(FlashPort& flash, const BoardRecord& record);

}  // namespace proleg::firmware
