#include "firmware/module/board_record.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::firmware {
namespace {

constexpr std::uint8_t first_schema = 1;
constexpr unsigned flag_feedback = 1U << 0U;
constexpr unsigned flag_gateway = 1U << 1U;
constexpr std::size_t version_at = 4;
constexpr std::size_t node_at = 5;
constexpr std::size_t flags_at = 6;
constexpr std::size_t minus_90_at = 8;
constexpr std::size_t plus_90_at = 10;
constexpr std::size_t lowest_angle_at = 12;
constexpr std::size_t highest_angle_at = 16;
constexpr std::size_t current_limit_at = 20;
constexpr std::size_t current_limit_time_at = 22;
constexpr std::size_t crc_at = 28;
constexpr std::uint8_t erased = 0xFF;

using Bytes = std::span<const std::uint8_t>;
using RecordBytes = std::array<std::uint8_t, BoardRecord::size>;

std::uint16_t half_word(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(read_little_endian(bytes, at, 2));
}

/// Reads all fields of the schema versions 1 and 2, without a check.
BoardRecord decode_all(Bytes bytes) {
  BoardRecord record;
  record.node = bytes[node_at];
  record.has_feedback = (bytes[flags_at] & flag_feedback) != 0;
  record.feedback_at_minus_90 = half_word(bytes, minus_90_at);
  record.feedback_at_plus_90 = half_word(bytes, plus_90_at);
  if (bytes[version_at] != first_schema) {
    record.is_gateway = (bytes[flags_at] & flag_gateway) != 0;
    record.lowest_angle = static_cast<std::int32_t>(read_little_endian(bytes, lowest_angle_at, 4));
    record.highest_angle = static_cast<std::int32_t>(read_little_endian(bytes, highest_angle_at, 4));
    record.current_limit_ma = half_word(bytes, current_limit_at);
    record.current_limit_time_ms = half_word(bytes, current_limit_time_at);
  }
  return record;
}

/// Whether the part that is the same in every schema is right.
bool is_right(Bytes bytes) {
  return bytes[version_at] >= first_schema && bytes[node_at] <= BoardRecord::max_node &&
         read_little_endian(bytes, crc_at, 4) == crc32(bytes.first(crc_at));
}

/// Decodes a record that is right.
BoardRecord decode(Bytes bytes) {
  if (bytes[version_at] <= BoardRecord::schema) {
    if (const BoardRecord record = decode_all(bytes); record.valid()) {
      return record;
    }
  }
  BoardRecord fixed_part;
  fixed_part.node = bytes[node_at];
  return fixed_part;
}

bool is_erased(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != erased) {
      return false;
    }
  }
  return true;
}

struct NewestRecord {
  Bytes bytes;  ///< empty if there is no record
  std::uint32_t sequence = 0;
  unsigned sector = 0;
};

NewestRecord find_newest(const std::array<Bytes, 2>& sectors) {
  NewestRecord found;
  for (unsigned sector = 0; sector < sectors.size(); ++sector) {
    for (Bytes rest = sectors[sector]; rest.size() >= BoardRecord::size; rest = rest.subspan(BoardRecord::size)) {
      const Bytes bytes = rest.first(BoardRecord::size);
      const std::uint32_t sequence = read_little_endian(bytes, 0, 4);
      if (sequence > found.sequence && !is_erased(bytes) && is_right(bytes)) {
        found = {bytes, sequence, sector};
      }
    }
  }
  return found;
}

/// Offset of the next record of a sector: behind everything that was written there; the end of the sector if it is
/// full.
std::size_t free_offset(Bytes sector) {
  std::size_t offset = sector.size() / BoardRecord::size * BoardRecord::size;
  while (offset > 0 && is_erased(sector.subspan(offset - BoardRecord::size, BoardRecord::size))) {
    offset -= BoardRecord::size;
  }
  return offset;
}

/// Writes the fields that all records of a log have.
void complete(RecordBytes& bytes, std::uint32_t sequence) {
  write_little_endian(bytes, 0, 4, sequence);
  write_little_endian(bytes, crc_at, 4, crc32(Bytes(bytes).first(crc_at)));
}

AppendResult write(FlashPort& flash, const NewestRecord& before, const RecordBytes& bytes) {
  unsigned sector = before.sector;
  std::size_t offset = free_offset(flash.contents(sector));
  if (offset + BoardRecord::size > flash.contents(sector).size()) {
    // The sector is erased even if it reads as erased: an erase that was cut off can leave bits that read as 1 for a
    // while.
    sector ^= 1U;
    offset = 0;
    if (!flash.erase(sector)) {
      return AppendResult::erase_failed;
    }
  }
  if (!flash.program(sector, static_cast<std::uint32_t>(offset), bytes) ||
      !std::ranges::equal(bytes, flash.contents(sector).subspan(offset, BoardRecord::size))) {
    return AppendResult::program_failed;
  }
  return AppendResult::ok;
}

}  // namespace

bool BoardRecord::valid() const {
  return node <= max_node && feedback_at_minus_90 <= max_reading && feedback_at_plus_90 <= max_reading &&
         (!has_feedback || feedback_at_minus_90 != feedback_at_plus_90) && lowest_angle >= -max_angle &&
         lowest_angle <= 0 && highest_angle >= 0 && highest_angle <= max_angle && current_limit_ma <= max_current_ma;
}

std::array<std::uint8_t, BoardRecord::size> encode(const BoardRecord& record, std::uint32_t sequence) {
  RecordBytes bytes{};
  bytes[version_at] = BoardRecord::schema;
  bytes[node_at] = record.node;
  bytes[flags_at] =
      static_cast<std::uint8_t>((record.has_feedback ? flag_feedback : 0U) | (record.is_gateway ? flag_gateway : 0U));
  write_little_endian(bytes, minus_90_at, 2, record.feedback_at_minus_90);
  write_little_endian(bytes, plus_90_at, 2, record.feedback_at_plus_90);
  write_little_endian(bytes, lowest_angle_at, 4, static_cast<std::uint32_t>(record.lowest_angle));
  write_little_endian(bytes, highest_angle_at, 4, static_cast<std::uint32_t>(record.highest_angle));
  write_little_endian(bytes, current_limit_at, 2, record.current_limit_ma);
  write_little_endian(bytes, current_limit_time_at, 2, record.current_limit_time_ms);
  complete(bytes, sequence);
  return bytes;
}

std::optional<BoardRecord> newest(Bytes sector_1, Bytes sector_2) {
  const Bytes bytes = find_newest({sector_1, sector_2}).bytes;
  return bytes.empty() ? std::nullopt : std::optional(decode(bytes));
}

std::uint8_t newest_node(Bytes sector_1, Bytes sector_2) {
  const Bytes bytes = find_newest({sector_1, sector_2}).bytes;
  return bytes.empty() ? std::uint8_t{0} : bytes[node_at];
}

bool has_newer_schema(Bytes sector_1, Bytes sector_2) {
  const Bytes bytes = find_newest({sector_1, sector_2}).bytes;
  return !bytes.empty() && bytes[version_at] > BoardRecord::schema;
}

AppendResult append(FlashPort& flash, const BoardRecord& record) {
  if (!record.valid()) {
    return AppendResult::invalid_record;
  }
  const NewestRecord before = find_newest({flash.contents(0), flash.contents(1)});
  // What this program reads of a newer schema is not all that the record holds.
  const bool is_known = !before.bytes.empty() && before.bytes[version_at] <= BoardRecord::schema;
  if (is_known && decode(before.bytes) == record) {
    return AppendResult::ok;
  }
  return write(flash, before, encode(record, before.sequence + 1U));
}

AppendResult append_node(FlashPort& flash, std::uint8_t node) {
  if (node > BoardRecord::max_node) {
    return AppendResult::invalid_record;
  }
  const NewestRecord before = find_newest({flash.contents(0), flash.contents(1)});
  RecordBytes bytes = encode(BoardRecord{}, 0);
  if (!before.bytes.empty()) {
    if (before.bytes[node_at] == node) {
      return AppendResult::ok;
    }
    std::ranges::copy(before.bytes, bytes.begin());
  }
  bytes[node_at] = node;
  complete(bytes, before.sequence + 1U);
  return write(flash, before, bytes);
}

void BoardStore::load() {
  stored_ = newest(flash_.contents(0), flash_.contents(1)).value_or(BoardRecord{});
  has_newer_ = has_newer_schema(flash_.contents(0), flash_.contents(1));
  reset();
}

AppendResult BoardStore::save(const BoardRecord& record) {
  const AppendResult result = append(flash_, record);
  if (result == AppendResult::ok) {
    stored_ = record;
    has_newer_ = false;
  }
  return result;
}

AppendResult BoardStore::save_node(std::uint8_t node) {
  const AppendResult result = append_node(flash_, node);
  if (result == AppendResult::ok) {
    stored_.node = node;
  }
  return result;
}

}  // namespace proleg::firmware
