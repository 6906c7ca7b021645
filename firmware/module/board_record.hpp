#pragma once

// The settings of a board, kept in its flash: written when the board is made, by LSS (its node id) and by object
// 0x1010; read at every start. Records have 32 bytes and are appended to a log in two sectors of flash; the newest one
// counts. Flash can only be programmed once after it was erased, and only whole sectors can be erased: so the log fills
// one sector, then the other.
//
// A record (little-endian):
//   0  u32  sequence number, 1 for the first; the newest record has the highest
//   4  u8   schema version, 2
//   5  u8   node id; 0: none
//   6  u8   flags; bit 0: a feedback potentiometer is fitted; bit 1: the module is the gateway
//   7  u8   0
//   8  u16  feedback at -90 degrees, as the ADC reads it (12 bits)
//  10  u16  feedback at +90 degrees
//  12  i32  lowest joint angle that the mechanics allow, 90 degrees = 2^30
//  16  i32  highest joint angle
//  20  u16  over-current limit in mA; 0: off
//  22  u16  time above the limit that leads to a fault, in ms
//  24  4 bytes of 0
//  28  u32  CRC-32 (shared/fixed/crc32.hpp) of the 28 bytes before
//
// The fixed part is the same in every schema: the size, bytes 0 to 5 and the checksum. A program reads no more of a
// record with a newer version, so that a board keeps its node id when an older image is flashed. A schema that only
// gives a meaning to bytes and bits that are 0 here keeps version 2: readers ignore what they have no meaning for.
// Version 1 ends at byte 12; its readers have the default values for the rest.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/canopen/messages.hpp"
#include "shared/gait/declaration.hpp"

namespace proleg::firmware {

/// Flash that can be erased sector by sector. Both operations take long (RM0090: up to half a second to erase), and the
/// program stands still meanwhile.
class FlashPort {
 public:
  /// Sets all bytes of a sector to 0xFF. Returns whether it succeeded.
  [[nodiscard]] virtual bool erase(unsigned sector) = 0;
  /// Programs bytes of a sector that are 0xFF. offset and size: multiples of 4. Returns whether it succeeded.
  [[nodiscard]] virtual bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) = 0;
  /// The bytes of a sector.
  [[nodiscard]] virtual std::span<const std::uint8_t> contents(unsigned sector) const = 0;

 protected:
  ~FlashPort() = default;
};

struct BoardRecord {
  static constexpr std::size_t size = 32;    ///< size in flash [bytes]
  static constexpr std::uint8_t schema = 2;  ///< the version that is written
  static constexpr std::uint8_t max_node = canopen::max_node_id;
  static constexpr std::uint16_t max_reading = 4095;  ///< greatest reading of the 12-bit ADC
  static constexpr std::int32_t max_angle = quarter_turn;
  static constexpr std::uint16_t max_current_ma = 0x7FFF;

  std::uint8_t node = 0;  ///< 1 to 126; 0: none
  bool has_feedback = false;
  /// Readings of the feedback potentiometer by the ADC, at most max_reading. They differ if it is fitted.
  std::uint16_t feedback_at_minus_90 = 0;
  std::uint16_t feedback_at_plus_90 = 0;
  bool is_gateway = false;
  /// Joint angles that the mechanics allow, 90 degrees = 2^30. The safe pose, 0, is one of them.
  std::int32_t lowest_angle = -max_angle;
  std::int32_t highest_angle = max_angle;
  /// Limits of the servo's current; default values of object 0x200A.
  std::uint16_t current_limit_ma = 2'000;
  std::uint16_t current_limit_time_ms = 500;

  /// Whether all values are in their ranges.
  [[nodiscard]] bool valid() const;

  friend bool operator==(const BoardRecord&, const BoardRecord&) = default;
};

/// The bytes of a record.
[[nodiscard]] std::array<std::uint8_t, BoardRecord::size> encode(const BoardRecord& record, std::uint32_t sequence);

/// The newest record: the one with the highest sequence number among those that have a schema version, the right
/// checksum and a node id in its range. Records that were cut off or damaged are skipped. If it has a newer schema
/// version, or another value out of its range, only its node id is taken. The sectors may have any size.
[[nodiscard]] std::optional<BoardRecord> newest(std::span<const std::uint8_t> sector_1,
                                                std::span<const std::uint8_t> sector_2);

/// Node id of the newest record; 0: none.
[[nodiscard]] std::uint8_t newest_node(std::span<const std::uint8_t> sector_1, std::span<const std::uint8_t> sector_2);

/// Whether the newest record has a schema version that is newer than those of this program.
[[nodiscard]] bool has_newer_schema(std::span<const std::uint8_t> sector_1, std::span<const std::uint8_t> sector_2);

enum class AppendResult : std::uint8_t {
  ok,              ///< written, or it is the newest record already, in a schema that is known
  invalid_record,  ///< BoardRecord::valid() does not hold; nothing was written
  erase_failed,    ///< the record before is still the newest
  program_failed,  ///< the record before is still the newest, or the flash does not hold what was written
};

/// Appends a record to the log in sectors 0 and 1 of the port. If the power fails meanwhile, at any instant, the newest
/// record is the one before or this one.
[[nodiscard]] AppendResult append(FlashPort& flash, const BoardRecord& record);
/// Appends a copy of the newest record, in any schema, that differs from it in the node id only.
[[nodiscard]] AppendResult append_node(FlashPort& flash, std::uint8_t node);

/// The settings of the board of a running module, as they are in flash and as they are in force.
class BoardStore {
 public:
  explicit BoardStore(FlashPort& flash) : flash_(flash) {}

  /// Reads the flash after power-on. Without a record the settings have their default values.
  void load();
  /// Returns to the settings in flash. Settings in force that were not saved are lost.
  void reset() { in_force = stored_; }
  /// Appends a record to the flash, which stops the program for up to half a second.
  [[nodiscard]] AppendResult save(const BoardRecord& record);
  /// Appends a record with this node id; the other settings stay as they are in the flash, in any schema.
  [[nodiscard]] AppendResult save_node(std::uint8_t node);

  /// Whether the flash has_newer_schema(). save() ends it.
  [[nodiscard]] bool has_newer() const { return has_newer_; }

  /// The settings in flash, which take effect at the next reset.
  [[nodiscard]] const BoardRecord& stored() const { return stored_; }

  /// The settings in force, without the node id and the limits of over-current, which other parts have.
  BoardRecord in_force;

 private:
  FlashPort& flash_;
  BoardRecord stored_;
  bool has_newer_ = false;
};

}  // namespace proleg::firmware
